#!/bin/sh
# All tests, from a fresh Debian 12 machine on: installs what is missing (and says what first), looks at the style,
# builds with clang and with the sanitizers and runs the unit tests with both, then builds with gcc and runs everything.
# Stops at the first failure. CTest's own summary of the last run is the end of the output.
set -eu
script=tests/run.sh
root=$(CDPATH='' cd -- "$(dirname -- "$0")/.." && pwd)
. "$root/cmake/packages.sh"

usage()
{
    cat <<'END'
Usage: sh tests/run.sh [OPTION]...

Installs what the tests need, builds, and runs them all; exits 0 only where every one of them passed.

  --quick       gcc only: no style, no clang, no sanitizers
  --yes         do not ask before installing (nor is asked where standard input is no terminal)
  --no-install  install nothing; the build says what it cannot find
  --help        this text
END
}

assume_yes=0
install=1
quick=0
for option in "$@"; do
    case $option in
    --quick) quick=1 ;;
    --yes) assume_yes=1 ;;
    --no-install) install=0 ;;
    --help)
        usage
        exit 0
        ;;
    *)
        echo "$script: $option: no such option (see --help)" >&2
        exit 2
        ;;
    esac
done

say()
{
    echo
    echo "$script: $*"
}

# build PRESET: configures and builds it, whatever was asked of the same folder before.
build()
{
    cmake -S "$root" --preset "$1" -DNEPHELE_TESTS=ON -DNEPHELE_WERROR=ON -DNEPHELE_VIEWER=ON ||
        die "CMake could not set up build/$1 (its last message names what it misses)"
    cmake --build "$root/build/$1" || die "the $1 build failed (the first error above says where)"
}

# test_in PRESET [OPTION of ctest]...: no test at all is a failure too.
test_in()
{
    folder=$root/build/$1
    shift
    ctest --test-dir "$folder" --no-tests=error --output-on-failure -j "$jobs" "$@"
}

check_style()
{
    command -v clang-format-14 >/dev/null || die "clang-format-14 is missing (install it, or leave out --no-install)"
    list=$root/build/style.txt
    mkdir -p "$root/build"
    (cd "$root" && find libshape tools viewer tests \( -name '*.c' -o -name '*.h' -o -name '*.cpp' \) -print) |
        sort >"$list"
    [ -s "$list" ] || die "found no sources to look at"
    (cd "$root" && clang-format-14 --dry-run --Werror --files="$list") ||
        die "the style differs (clang-format-14 -i on the files named above puts it right)"
}

if [ "$install" = 1 ]; then
    # One word a package.
    # shellcheck disable=SC2086
    packages_install $packages_build $packages_test
fi
jobs=$(nproc 2>/dev/null) || jobs=2
export CC=gcc CXX=g++ # of the presets that name none

if [ "$quick" = 0 ]; then
    say "style of the sources"
    check_style
    say "clang, warnings as errors; unit tests"
    build clang
    test_in clang -R '^test_' || die "unit tests failed in the clang build"
    say "address and undefined-behaviour sanitizers; unit tests"
    build asan-ubsan
    test_in asan-ubsan -R '^test_' || die "unit tests failed under the sanitizers"
fi
say "gcc, warnings as errors; all tests"
build release
test_in release
