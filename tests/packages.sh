#!/bin/sh
# The Debian packages: built, installed by dpkg into a folder of its own, used there, and removed without a trace.
# Takes a whole build (about two minutes on two cores), so it is no part of the suite: sh tests/packages.sh
#
# dpkg works on a copy of this system's list of installed packages, so the dependencies are really checked, and on a root
# folder of its own, so nothing of this system changes; root's rights are not needed (fakeroot gives their look).
set -eu
script=tests/packages.sh
root=$(CDPATH='' cd -- "$(dirname -- "$0")/.." && pwd)
if [ "$(id -u)" -ne 0 ] && [ -z "${FAKEROOTKEY:-}" ]; then
    command -v fakeroot >/dev/null || {
        echo "$script: fakeroot is missing (apt-get install fakeroot dpkg-dev)" >&2
        exit 1
    }
    exec fakeroot sh "$0"
fi
temporary=$(mktemp -d)
trap 'rm -r "$temporary"' EXIT

fail()
{
    echo "$script: $*" >&2
    exit 1
}

command -v dpkg-shlibdeps >/dev/null || fail "dpkg-shlibdeps is missing (apt-get install dpkg-dev)"
cmake -S "$root" --preset package
cmake --build "$root/build/package"
rm -f "$root"/build/package/*.deb
cmake --build "$root/build/package" --target package
cd "$root/build/package"
set -- libshape1_*.deb libshape-dev_*.deb nephele_*.deb
[ $# -eq 3 ] && [ -f "$1" ] && [ -f "$2" ] && [ -f "$3" ] || fail "not three packages: $*"

# --- what they say
version=$(dpkg-deb -f "$3" Version)
architecture=$(dpkg --print-architecture)
for package in "$@"; do
    [ "$(dpkg-deb -f "$package" Architecture)" = "$architecture" ] || fail "$package is not for $architecture"
    [ "$(dpkg-deb -f "$package" Version)" = "$version" ] || fail "$package has another version than $3"
    dpkg-deb -c "$package" >"$temporary/contents"
    grep -q "/usr/share/doc/${package%%_*}/copyright$" "$temporary/contents" || fail "$package has no copyright file"
done
for package in "$2" "$3"; do
    case $(dpkg-deb -f "$package" Depends) in
    *"libshape1 (= $version)"*) ;;
    *) fail "$package does not depend on this version of libshape1" ;;
    esac
done

# --- installed: a root and a package list of its own. Scripts run outside the root, which has no shell; ldconfig, which
# they call, would renew this system's cache.
mkdir -p "$temporary/root" "$temporary/stub" "$temporary/admin/info" "$temporary/admin/updates" \
    "$temporary/admin/triggers"
cp /var/lib/dpkg/status "$temporary/admin/status"
# dpkg asks for the file lists of what is installed; empty ones will do, since nothing of it is touched.
for list in /var/lib/dpkg/info/*.list; do
    : >"$temporary/admin/info/$(basename "$list")"
done
printf '#!/bin/sh\nexit 0\n' >"$temporary/stub/ldconfig"
chmod +x "$temporary/stub/ldconfig"
run_dpkg()
{
    PATH=$temporary/stub:$PATH dpkg --root="$temporary/root" --admindir="$temporary/admin" \
        --force-script-chrootless --force-not-root --log="$temporary/dpkg.log" "$@"
}
state()
{
    dpkg-query --admindir="$temporary/admin" -W -f '${db:Status-Status}' "$1" 2>/dev/null || echo none
}
if run_dpkg -i "$3" >"$temporary/refused" 2>&1; then
    fail "nephele could be installed without libshape1"
fi
run_dpkg --purge nephele >/dev/null 2>&1 || true
run_dpkg -i "$@"
for package in libshape1 libshape-dev nephele; do
    [ "$(state $package)" = installed ] || fail "$package is $(state $package), not installed"
done

# --- used where they are
usr=$temporary/root/usr
library=$usr/lib/$(dpkg-architecture -qDEB_HOST_MULTIARCH)
export LD_LIBRARY_PATH="$library"
"$usr/bin/neph-lsys" -q "$usr/share/nephele/examples/spiral.lsys" -o "$temporary/spiral.neph"
"$usr/bin/neph-render" -q "$temporary/spiral.neph" --method march --size 32x18 -o "$temporary/spiral.png"
for program in "$usr"/bin/neph-*; do
    ldd "$program" >"$temporary/ldd"
    grep -q "libshape.so.1 => $library/" "$temporary/ldd" || fail "$(basename "$program") does not use libshape1's library"
    if grep -q "not found" "$temporary/ldd"; then
        fail "$(basename "$program") misses libraries: $(grep 'not found' "$temporary/ldd")"
    fi
    gzip -dc "$usr/share/man/man1/$(basename "$program").1.gz" | grep -q '^.SH EXAMPLES' ||
        fail "$(basename "$program") has no manual page"
done
cc -I"$usr/include" "$root/tests/consumer/make_cloud.c" -L"$library" -lshape -o "$temporary/make_cloud"
"$temporary/make_cloud" "$temporary/heap.neph"
"$usr/bin/neph-info" "$temporary/heap.neph"

# --- and removed
run_dpkg --purge nephele libshape-dev libshape1
left=$(find "$temporary/root" ! -type d)
[ -z "$left" ] || fail "removing the packages left these files: $left"
for package in libshape1 libshape-dev nephele; do
    case $(state $package) in
    none | not-installed) ;;
    *) fail "$package is still $(state $package)" ;;
    esac
done
echo "$script: three packages built, installed, used and removed"
