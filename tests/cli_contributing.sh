# The worked example of CONTRIBUTING.md is a program: it builds as it stands there, and makes a cloud; and git's hook lets
# formatted files through and no others. The page of the C API has every public function, with a text above it.
# $1: programs of a build, $2: source folder.
set -eu
programs=$(cd "$1" && pwd)
build=$(dirname "$programs")
source=$(cd "$2" && pwd)
temporary=$(mktemp -d)
trap 'rm -r "$temporary"' EXIT
cd "$temporary"

fail()
{
    echo "cli_contributing: $*" >&2
    exit 1
}

cached()
{
    sed -n "s/^$1:[A-Z]*=//p" "$build/CMakeCache.txt"
}

awk '/^```c$/ { inside = 1; next } /^```$/ { inside = 0 } inside' "$source/CONTRIBUTING.md" >neph-ring.c
flags="-std=c17 -Wall -Wextra -Wshadow -Werror -fopenmp"
[ "$(cached NEPHELE_SANITIZE)" != ON ] || flags="$flags -fsanitize=address,undefined"
# One word a flag.
# shellcheck disable=SC2046,SC2086
"$(cached CMAKE_C_COMPILER)" $flags -D_XOPEN_SOURCE=700 -I"$source/tools" -I"$source/libshape/include" neph-ring.c -o neph-ring \
    "$build/tools/libnephele_cli.a" "$build/libshape/libshape.a" $(pkg-config --libs popt libmd) -lm ||
    fail "the example of CONTRIBUTING.md does not build (the compiler's message stands above)"
./neph-ring -q --count 20 -o ring.neph
spheres=$("$programs/neph-info" ring.neph --csv | tail -n +2 | wc -l)
[ "$spheres" -eq 20 ] || fail "the example made $spheres spheres, not 20"
./neph-ring --generate man | grep -q '^.SH EXAMPLES' || fail "the example has no manual page"
clang-format-14 --assume-filename="$source/tools/neph-ring.c" <neph-ring.c | cmp -s - neph-ring.c ||
    fail "the example of CONTRIBUTING.md is not formatted as the sources are: $(clang-format-14 \
        --assume-filename="$source/tools/neph-ring.c" <neph-ring.c | diff neph-ring.c - | head -n 6)"

git init -q repository
cp "$source/.clang-format" repository
cd repository
printf 'int main(void)\n{\n    return 0;\n}\n' >good.c
git add .
sh "$source/tools/pre-commit" || fail "the hook refuses a formatted file"
printf 'int  other( void ){return 0 ;}\n' >bad.c
git add .
if sh "$source/tools/pre-commit" 2>message; then
    fail "the hook lets a file through that is not formatted"
fi
grep -qx "bad.c" message || fail "the hook does not name the file: $(cat message)"
if grep -qx "good.c" message; then
    fail "the hook names a file that is formatted"
fi
cd ..

awk -f "$source/docs/api.awk" "$source"/libshape/include/shape/*.h >api.md
cat "$source"/libshape/include/shape/*.h | grep -oE '^[a-z][a-z0-9_ ]*[ *]shape_[a-z0-9_]+\(' |
    grep -oE 'shape_[a-z0-9_]+' | sort -u >functions
[ "$(wc -l <functions)" -gt 100 ] || fail "found only $(wc -l <functions) functions in the headers"
awk '/^```c$/ { inside = 1; next } /^```$/ { inside = 0 } inside' api.md >code
while read -r name; do
    grep -qw "$name" code || fail "the page of the C API lacks $name"
done <functions
for header in "$source"/libshape/include/shape/*.h; do
    grep -A2 "^## shape/$(basename "$header")\$" api.md | tail -n 1 | grep -q '^[A-Z.]' ||
        fail "$(basename "$header") does not begin by saying what it is"
done
echo "$(wc -l <functions) functions"
