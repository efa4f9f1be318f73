#!/bin/sh
# From a fresh Debian 12 machine to a picture of a cloud: installs what is missing (and says what first), builds, makes
# castellanus.neph and castellanus.png in the current folder, and opens the viewer where there is a display.
set -eu
script=examples/quickstart.sh
root=$(CDPATH='' cd -- "$(dirname -- "$0")/.." && pwd)
. "$root/cmake/packages.sh"

usage()
{
    cat <<'END'
Usage: sh examples/quickstart.sh [OPTION]...

Installs what is missing, builds into build/release, and makes a cloud from examples/castellanus.lsys: castellanus.neph
and castellanus.png in the current folder. Opens the viewer where there is a display.

  --yes         do not ask before installing (nor is asked where standard input is no terminal)
  --no-install  install nothing; the build says what it cannot find
  --no-window   do not open the viewer
  --help        this text
END
}

assume_yes=0
install=1
window=1
for option in "$@"; do
    case $option in
    --yes) assume_yes=1 ;;
    --no-install) install=0 ;;
    --no-window) window=0 ;;
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

if [ "$install" = 1 ]; then
    # One word a package.
    # shellcheck disable=SC2086
    packages_install $packages_build
fi

echo "$script: building into $root/build/release"
cmake -S "$root" --preset release -DNEPHELE_TESTS=OFF -DNEPHELE_WERROR=OFF ||
    die "CMake could not set up the build (its last message names what it misses)"
cmake --build "$root/build/release" ||
    die "the build failed (the first error above says where; rm -r build/release and a new start rule out old files)"

bin=$root/build/release/bin
"$bin/neph-lsys" "$root/examples/castellanus.lsys" -o castellanus.neph ||
    die "no cloud was made (may files be written in $PWD?)"
echo "$script: drawing; without a graphics card this takes some seconds"
"$bin/neph-view" castellanus.neph --headless -o castellanus.png ||
    die "no picture was drawn (it needs OpenGL 3.3 through EGL: Mesa's libegl-mesa0 and libgl1-mesa-dri draw without a card)"
echo "$script: castellanus.neph and castellanus.png are in $PWD; the programs are in $bin"

if [ "$window" = 1 ] && [ -n "${DISPLAY:-}${WAYLAND_DISPLAY:-}" ]; then
    echo "$script: opening the viewer; close its window to end"
    "$bin/neph-view" castellanus.neph ||
        die "the viewer's window did not open (the picture is there all the same; --no-window leaves it out)"
fi
