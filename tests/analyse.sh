#!/bin/sh
# Static analysis: clang-tidy by .clang-tidy and cppcheck by tests/cppcheck.txt, over libshape, tools and viewer, one file at
# a time (a quarter of an hour and more). Ends with exit code 1 where either finds something.
#   sh tests/analyse.sh [FILE]...        all, or those named
# Debian: clang-tidy-14 (or another clang-tidy in CLANG_TIDY), cppcheck.
set -eu
cd "$(dirname "$0")/.."
tidy=${CLANG_TIDY:-clang-tidy-14}
build=build/analyse
for program in "$tidy" cppcheck; do
    command -v "$program" > /dev/null || {
        echo "analyse.sh: $program is missing (apt install clang-tidy-14 cppcheck)" >&2
        exit 2
    }
done
CC=clang CXX=clang++ cmake -S . -B "$build" -G Ninja -DCMAKE_EXPORT_COMPILE_COMMANDS=ON -DNEPHELE_TESTS=OFF > /dev/null
[ $# -gt 0 ] || set -- $(find libshape tools viewer -name '*.c' -o -name '*.cpp' | sort)
failed=0
for file in "$@"; do
    case $file in *.c | *.cpp) ;; *) continue ;; esac
    "$tidy" --quiet -p "$build" "$file" > "$build/tidy.txt" 2> "$build/tidy.err" || {
        failed=$((failed + 1))
        cat "$build/tidy.txt"
        grep -v "warnings generated\|^Suppressed\|^Use -header" "$build/tidy.err" || true
    }
done
echo "analyse.sh: clang-tidy: $# files, $failed with findings"
c=$(printf '%s\n' "$@" | grep '\.c$' || true)
bad=0
# shellcheck disable=SC2086
[ -z "$c" ] || cppcheck --quiet --std=c11 --enable=warning,performance,portability --inline-suppr --error-exitcode=1 \
    --suppressions-list=tests/cppcheck.txt -I libshape/include -I libshape -I tools -I viewer -I viewer/gl \
    --template='{file}:{line}: {severity}: {message} [{id}]' $c || bad=1
echo "analyse.sh: cppcheck: $([ $bad = 0 ] && echo clean || echo findings)"
[ "$failed" = 0 ] && [ "$bad" = 0 ]
