#!/bin/sh
# The same bytes on another processor: builds neph-gauss, -lsys, -meta, -layer and -edit for arm64 with a cross compiler,
# runs them under qemu and compares what they make with what the programs of this machine make. Installs nothing; the
# arm64 libraries (popt, libmd, jansson) are taken from the Debian mirror into a temporary folder.
#   apt install gcc-aarch64-linux-gnu libc6-dev-arm64-cross qemu-user-static
#   sh tests/arm64.sh build/release/bin .
set -eu
bin=$(cd "$1" && pwd)
source=$(cd "$2" && pwd)
cross=aarch64-linux-gnu-gcc
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
for tool in $cross qemu-aarch64-static apt-get dpkg-deb; do
    command -v $tool > /dev/null || {
        echo "arm64: $tool is missing (the first lines of this script say what to install)" >&2
        exit 1
    }
done

fail() {
    echo "arm64: $1" >&2
    exit 1
}

# --- three libraries for arm64, beside the system's own package lists
ln -s "$source" "$tmp/source"
mkdir -p "$tmp/lists/partial" "$tmp/packages" "$tmp/root"
foreign="-o APT::Architectures::=amd64 -o APT::Architectures::=arm64 -o Dir::State::lists=$tmp/lists
    -o Dir::Cache::pkgcache= -o Dir::Cache::srcpkgcache= -o APT::Sandbox::User=root"
# shellcheck disable=SC2086
apt-get $foreign update > "$tmp/log" 2>&1 || fail "apt-get update failed: $(tail -n 1 "$tmp/log")"
# shellcheck disable=SC2086
(cd "$tmp/packages" && apt-get $foreign download libpopt-dev:arm64 libmd-dev:arm64 libjansson-dev:arm64) \
    > "$tmp/log" 2>&1 || fail "apt-get download failed: $(tail -n 1 "$tmp/log")"
for package in "$tmp"/packages/*.deb; do
    dpkg-deb -x "$package" "$tmp/root"
done

# --- the programs, as cli_same_bytes.sh builds them
version=$("$bin/neph-lsys" --version | sed 's/.* //')
flags="-std=c17 -w -ffp-contract=off -D_XOPEN_SOURCE=700 -DNEPHELE_VERSION=\"$version\" -I$tmp/root/usr/include
    -I$tmp/root/usr/include/aarch64-linux-gnu -I$tmp/source/libshape/include -I$tmp/source/libshape -I$tmp/source/tools"
libraries="-L$tmp/root/usr/lib/aarch64-linux-gnu -lpopt -lmd -ljansson -lm"
build() { # build FOLDER LEVEL
    mkdir -p "$1"
    for room in base primitive generate field file light budget tools; do
        folder=$tmp/source/libshape/$room
        files='*.c'
        case $room in
        file) files='neph_*.c scene*.c atomic.c' ;;
        tools)
            folder=$tmp/source/tools
            files='cli*.c'
            ;;
        esac
        mkdir -p "$1/$room"
        # shellcheck disable=SC2086
        (cd "$folder" && ls $files | grep -v -e '^mesh' -e '^cli_mesh.c$') > "$1/$room/list"
        # shellcheck disable=SC2046,SC2086
        (cd "$1/$room" && $cross $flags $2 -c $(sed "s|^|$folder/|" list)) || fail "$room does not build"
    done
    # Members of the same name in two rooms stay apart.
    ar qcs "$1/shape.a" "$1"/*/*.o
    for name in gauss lsys meta layer edit; do
        # shellcheck disable=SC2086
        $cross $flags $2 -static "$tmp/source/tools/neph-$name.c" "$1/shape.a" $libraries -o "$1/neph-$name" ||
            fail "neph-$name does not build"
    done
}

run() { # run HOW FOLDER: every command's result
    mkdir -p "$2"
    for grammar in "$tmp/source"/examples/*.lsys; do
        $1/neph-lsys -q "$grammar" --seed 7 -o "$2/$(basename "$grammar" .lsys).neph"
    done
    $1/neph-gauss -q -o "$2/gauss.neph"
    $1/neph-gauss -q --preset congestus --seed 5 -o "$2/congestus.neph"
    $1/neph-gauss -q --radius-law inverse --clamp-mode reject --no-prune -o "$2/inverse.neph"
    $1/neph-gauss -q --field 9 --seed 3 -o "$2/field.neph"
    $1/neph-meta -q --count 20 --seed 9 -o "$2/meta.neph"
    for preset in stratus stratocumulus fog; do
        $1/neph-layer -q --preset $preset --seed 3 -o "$2/$preset.neph"
    done
    $1/neph-edit -q "$2/castellanus.neph" "$2/anvil.neph" --scale 2,1,1.5 --rotate 10,20,30 --translate 1,2,3 \
        -o "$2/moved.neph"
    $1/neph-edit -q "$2/castellanus.neph" --grow --clip --hollow --thin 150 --prune --seed 4 -o "$2/reworked.neph"
}

run "$bin" "$tmp/here"
count=0
for level in -O0 -O3; do
    build "$tmp/arm64$level" $level
    run "qemu-aarch64-static $tmp/arm64$level" "$tmp/of$level"
    for file in "$tmp"/here/*.neph; do
        cmp -s "$file" "$tmp/of$level/$(basename "$file")" || fail "$(basename "$file") differs on arm64 $level"
        count=$((count + 1))
    done
done
file=$(head -c 20 "$tmp/arm64-O3/neph-gauss" | od -An -tx1 -j18 -N1 | tr -d ' ')
[ "$file" = b7 ] || fail "what was built is not for arm64"
echo "arm64: $count files equal"
