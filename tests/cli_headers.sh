# Each public header compiles alone, twice in a row, as C17 and as C++17, with gcc and with clang, without a warning;
# and what it declares has C names in C++.
set -eu
source=$2
temporary=$(mktemp -d)
trap 'rm -r "$temporary"' EXIT
warnings="-Wall -Wextra -Wpedantic -Wshadow -Wundef -Werror"

fail()
{
    echo "cli_headers: $*" >&2
    exit 1
}

# compile COMPILER LANGUAGE STANDARD FILE
compile()
{
    # shellcheck disable=SC2086
    "$1" -fsyntax-only -x "$2" -std="$3" $warnings -I"$source/libshape/include" "$4" ||
        fail "$(basename "$4" ".$2") does not compile alone as $3 by $1 (its message stands above)"
}

count=0
for header in "$source"/libshape/include/shape/*.h; do
    name=$(basename "$header")
    # A prototype of libshape begins a line; inline functions and macros do not need C names.
    if grep -Eq '^[a-z][a-z0-9_ ]*[ *]shape_[a-z0-9_]+\(.*[;,]$' "$header" &&
        ! grep -Eq '^extern "C" \{$' "$header"; then
        fail "$name declares functions without extern \"C\" (add the usual lines around them)"
    fi
    printf '#include "shape/%s"\n#include "shape/%s"\n' "$name" "$name" >"$temporary/$name.c"
    cp "$temporary/$name.c" "$temporary/$name.c++"
    for compiler in gcc clang; do
        command -v "$compiler" >/dev/null || fail "$compiler is missing (tests/run.sh installs it)"
        compile "$compiler" c c17 "$temporary/$name.c"
    done
    for compiler in g++ clang++; do
        command -v "$compiler" >/dev/null || fail "$compiler is missing (tests/run.sh installs it)"
        compile "$compiler" c++ c++17 "$temporary/$name.c++"
    done
    count=$((count + 1))
done
[ "$count" -ge 6 ] || fail "found only $count headers in $source/libshape/include/shape"
echo "$count headers, four compilers"
