#!/bin/sh
# Line and branch coverage of libshape by the whole test suite (gcov): sh tests/coverage.sh [ctest options]
# Prints a table by file, the least covered first, and the sum; uncovered lines stand in build/coverage/uncovered.txt.
set -eu
cd "$(dirname "$0")/.."
build=build/coverage
CC=gcc CXX=g++ cmake --preset coverage > /dev/null
cmake --build "$build" > "$build/build.log" 2>&1 || {
    tail -n 40 "$build/build.log" >&2
    exit 1
}
find "$build" -name '*.gcda' -delete
ctest --test-dir "$build" -j2 "$@" > "$build/ctest.log" 2>&1 || echo "coverage.sh: tests failed (see $build/ctest.log)" >&2
grep "tests passed" "$build/ctest.log" || true
python3 tests/coverage.py "$build"
