# neph-view, neph-render and neph-mesh load OpenVDB with the first .vdb and not before: it takes longer to load than all else
# that they need. $1: programs.
set -eu
bin=$1
temporary=$(mktemp -d)
trap 'rm -r "$temporary"' EXIT
cd "$temporary"

fail()
{
    echo "cli_late: $*" >&2
    exit 1
}

for program in neph-view neph-render neph-mesh; do
    if [ -x "$bin/$program" ] && ldd "$bin/$program" | grep -q openvdb; then
        fail "$program is linked to OpenVDB"
    fi
done
[ -x "$bin/neph-view" ] || exit 0
"$bin/neph-gauss" -q --count 3 -o three.neph
"$bin/neph-vdb" -q three.neph --resolution 24 -o three.vdb
"$bin/neph-view" -q three.vdb --headless --size 32x18 --samples 1 --light-grid 8 -o three.pfm || fail "no picture of a .vdb"
[ -s three.pfm ] || fail "the picture of a .vdb is empty"

# --- where the module is not there, that is said, and a .neph is shown as ever
cp "$bin/neph-view" .
./neph-view -q three.neph --headless --size 32x18 --samples 1 --light-grid 8 -o other.pfm || fail "no picture of a .neph"
code=0
./neph-view -q three.vdb --headless --size 32x18 -o none.pfm 2>error || code=$?
[ $code = 1 ] || fail "a .vdb without the module: exit $code, not 1"
[ "$(wc -l <error)" = 1 ] || fail "not one line: $(cat error)"
grep -q "OpenVDB is not there" error || fail "it does not say what is missing: $(cat error)"
[ ! -e none.pfm ] || fail "a picture of what was not read"
