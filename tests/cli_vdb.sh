# neph-vdb, writing: formats, options, sizes, refusals: one clear line, exit 1, no output file. $1: programs, $2: source.
# vdb_print and nanovdb_validate (Debian: libopenvdb-tools, libnanovdb-tools) are readers that are not ours.
set -eu
programs=$(cd "$1" && pwd)
vdb=$programs/neph-vdb
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT

fail() {
    echo "cli_vdb: $1" >&2
    exit 1
}
# make ARGUMENTS: writes $tmp/out.vdb, the summary in $tmp/said
make() {
    "$vdb" "$@" -o "$tmp/out.vdb" 2> "$tmp/said" || fail "failed: $* ($(cat "$tmp/said"))"
}
# prints PATTERN: vdb_print -l of out.vdb has it
prints() {
    vdb_print -l "$tmp/out.vdb" > "$tmp/printed" || fail "vdb_print cannot read it"
    grep -q -- "$1" "$tmp/printed" || fail "vdb_print lacks \"$1\": $(cat "$tmp/printed")"
}
# refused EXIT PATTERN ARGUMENTS: that exit, one line with the pattern, nothing on standard output, no file
refused() {
    wanted=$1
    pattern=$2
    shift 2
    status=0
    "$vdb" "$@" > "$tmp/stdout" 2> "$tmp/said" || status=$?
    [ "$status" = "$wanted" ] || fail "exit $status instead of $wanted: $* ($(cat "$tmp/said"))"
    [ "$(wc -l < "$tmp/said")" = 1 ] || fail "not one line: $* ($(cat "$tmp/said"))"
    grep -q -- "^neph-vdb: .*$pattern" "$tmp/said" || fail "expected \"$pattern\": $(cat "$tmp/said")"
    [ ! -s "$tmp/stdout" ] || fail "something on standard output: $*"
    [ -z "$(find "$tmp" -name 'none*')" ] || fail "an output is left: $*"
}

command -v nanovdb_validate > /dev/null || fail "nanovdb_validate is missing (install libnanovdb-tools)"
command -v vdb_print > /dev/null || fail "vdb_print is missing (install libopenvdb-tools)"
# A ball of 1 m, 10 m up: as a grammar of one puff.
printf 'axiom X\niterations 0\nradius 1\nlength 10\nX -> X\n' > "$tmp/one.lsys"
"$programs/neph-lsys" "$tmp/one.lsys" --model uniform --extinction 3 --at 5,10,-7 -q -o "$tmp/one.neph"
"$programs/neph-gauss" --seed 3 -q -o "$tmp/cloud.neph"

# --- one ball: bounds, axes, transform, medium
make "$tmp/one.neph" --resolution 20
prints "Name: density"
prints "class: fog volume"
prints "Tree_float_5_4_3"
prints "voxel size: 0.1$"
prints "Dimensions of active voxels:   20 x 20 x 20"
prints "neph_extinction: 3"
prints "neph_up: z"
prints "neph_cloud_1: .*neph-lsys"
prints "is_saved_as_half_float: false"
# world x, -z, y: the ball's middle is 5, 7, 10 (and the puff stands at the turtle's start)
"$programs/neph-info" --json "$tmp/one.neph" | tr -d ' \n' | grep -q '"bounds":\[\[4,9,-8\],\[6,11,-6\]\]' ||
    fail "the ball is not where this test thinks"
prints '\[4.05, 6.05, 9.05, 1\]'
make "$tmp/one.neph" --resolution 20 --up y --half
prints '\[4.05, 9.05, -7.95, 1\]'
prints "is_saved_as_half_float: true"
make "$tmp/one.neph" --voxel-size 0.05
prints "voxel size: 0.05$"
make "$tmp/one.neph" --resolution 20 --values extinction
prints "Max value: 3"
prints "neph_extinction: 1"
make "$tmp/one.neph" --resolution 20 --ramp 3
prints "Min value: 0\.0"

# --- the same command gives the same bytes, to a pipe too; -q is quiet
"$vdb" -q "$tmp/cloud.neph" --resolution 40 -o "$tmp/a.vdb" 2> "$tmp/said"
[ ! -s "$tmp/said" ] || fail "-q is not quiet"
"$vdb" -q - --resolution 40 < "$tmp/cloud.neph" > "$tmp/b.vdb"
"$vdb" -q "$tmp/cloud.neph" --resolution 40 > "$tmp/c.vdb"
cmp -s "$tmp/a.vdb" "$tmp/c.vdb" || fail "a pipe gives other bytes"
vdb_print "$tmp/b.vdb" | grep -q density || fail "vdb_print does not read what came through a pipe"

# --- other grids
make "$tmp/cloud.neph" --resolution 40 --grids light,sdf,profile,detail_type,density_scale
vdb_print "$tmp/out.vdb" > "$tmp/printed"
for name in density light sdf profile detail_type density_scale; do
    grep -q "^$name " "$tmp/printed" || fail "no grid $name: $(cat "$tmp/printed")"
done
grep -q "^light *vec3s" "$tmp/printed" || fail "light is not vec3s"
prints "class: level set"
"$programs/neph-edit" "$tmp/one.neph" "$tmp/cloud.neph" -q -o "$tmp/two.neph"
make "$tmp/two.neph" --resolution 40 --each
[ "$(vdb_print "$tmp/out.vdb" | grep -c '^density_')" = 2 ] || fail "--each: not two grids"
make "$tmp/two.neph" --resolution 40
[ "$(vdb_print "$tmp/out.vdb" | grep -c '^density')" = 1 ] || fail "not one grid of two clouds"

# --- an allowed error chooses the voxels
make "$tmp/cloud.neph" --error 0.2
grep -q "voxels of .* keep the error at 0\.[01].*, within 0\.2" "$tmp/said" || fail "--error: $(cat "$tmp/said")"

# --- NanoVDB and raw
"$vdb" -q "$tmp/cloud.neph" --resolution 40 -o "$tmp/a.nvdb"
[ "$(head -c 7 "$tmp/a.nvdb")" = NanoVDB ] || fail "no NanoVDB file"
"$vdb" -q "$tmp/cloud.neph" --resolution 40 --half -o "$tmp/b.nvdb"
[ "$(wc -c < "$tmp/b.nvdb")" -lt "$(wc -c < "$tmp/a.nvdb")" ] || fail "--half does not make a NanoVDB file smaller"
"$vdb" -q "$tmp/cloud.neph" --resolution 40 --grids light,sdf -o "$tmp/c.nvdb"
nanovdb_validate "$tmp/a.nvdb" "$tmp/b.nvdb" "$tmp/c.nvdb" || fail "NanoVDB's own check refuses a file"
# the same number of voxels as OpenVDB counts
voxels=$(vdb_print -l "$tmp/a.vdb" | sed -n 's/.*Number of active voxels: *//p' | tr -d ,)
nanovdb_print "$tmp/a.nvdb" | grep -q "float *FOG .* $voxels " || fail "not $voxels voxels: $(nanovdb_print "$tmp/a.nvdb")"
"$vdb" -q "$tmp/one.neph" --resolution 20 -o "$tmp/a.raw"
[ "$(wc -c < "$tmp/a.raw")" = 32000 ] || fail "a.raw is not 20^3 floats"
"$vdb" -q "$tmp/one.neph" --resolution 20 --half -o "$tmp/b.raw"
"$vdb" -q "$tmp/one.neph" --resolution 20 --header -o "$tmp/c.raw"
python3 - "$tmp" << 'END' || fail "raw: $tmp"
import json, struct, sys
t = sys.argv[1] + "/"
a, b, c = (open(t + n + ".raw", "rb").read() for n in "abc")
side = json.load(open(t + "a.json"))
assert side["size"] == [20, 20, 20] and side["type"] == "float32" and side["offset"] == 0, side
assert abs(side["voxel_size"] - 0.1) < 1e-9 and side["medium"]["extinction"] == 3, side
assert all(abs(x - y) < 1e-6 for x, y in zip(side["origin"], [4.05, 6.05, 9.05])), side
assert struct.unpack("<3i", c[:12]) == (20, 20, 20) and c[12:] == a
floats, halves = struct.unpack("<8000f", a), struct.unpack("<8000e", b)
assert floats == halves
inside = 0
for k in range(20):
    for j in range(20):
        for i in range(20):
            d2 = sum((0.1 * n - 0.95) ** 2 for n in (i, j, k))
            if abs(d2 - 1) > 1e-4:
                assert floats[(k * 20 + j) * 20 + i] == (d2 < 1), (i, j, k)
            inside += d2 < 1
assert inside > 4000
END

# --- refusals
refused 1 "need more than --max-memory 4294967296 bytes (take --voxel-size" "$tmp/cloud.neph" --voxel-size 1e-7 -o "$tmp/none.vdb"
refused 1 "need more than --max-memory 1048576 bytes" "$tmp/cloud.neph" --max-memory 1048576 -o "$tmp/none.vdb"
fit=$(sed 's/.*--voxel-size \([^,]*\),.*/\1/' "$tmp/said")
make "$tmp/cloud.neph" --max-memory 1048576 --voxel-size "$fit"
refused 1 "uniform clouds" "$tmp/cloud.neph" --ramp 3 -o "$tmp/none.vdb"
refused 1 "none.neph: cannot" "$tmp/none.neph" -o "$tmp/none.vdb"
refused 2 "of a volume a .neph is made" "$tmp/a.vdb" -o "$tmp/none.vdb"
refused 2 "belongs to volumes that are written" "$tmp/a.vdb" --ramp 3 -o "$tmp/none.neph"
refused 2 "belongs to volumes that are read" "$tmp/cloud.neph" --primitives 3 -o "$tmp/none.vdb"

# --- there and back: a uniform cloud's volume becomes as few primitives again that fill the same space, upright, and the
# volume as it is looks like the cloud
"$programs/neph-gauss" -q --model uniform --extinction 1 -o "$tmp/uniform.neph"
"$programs/neph-vdb" -q "$tmp/uniform.neph" --resolution 96 -o "$tmp/uniform.vdb"
"$programs/neph-vdb" "$tmp/uniform.vdb" --primitives 30 -o "$tmp/back.neph" 2>"$tmp/said"
overlap=$(sed -n 's/.*overlap of the solid part \([0-9.]*\) .*/\1/p' "$tmp/said")
awk "BEGIN { exit !($overlap >= 0.95) }" || fail "there and back the solid part overlaps by $overlap, not 0.95"
small="-q --size 48x27 --eye 0,3,40 --target 0,1,0 --fov 25 --method march --steps 150 --light-resolution 16 --sky none"
"$programs/neph-render" "$tmp/uniform.neph" $small -o "$tmp/uniform.neph.pfm"
"$programs/neph-render" "$tmp/uniform.vdb" $small --extinction 1 -o "$tmp/uniform.vdb.pfm"
"$programs/neph-render" "$tmp/back.neph" $small -o "$tmp/back.neph.pfm"
# looks_like TOLERANCE NAME: relative MSE, without a sky. A voxel is a pixel here, and edges are a third of so small a
# cloud: the volume is 0.0007 off, what was fitted to it 0.0175; a volume upside down would be 0.066, of wrong axes 0.092.
looks_like() {
    "$programs/neph-render" --compare "$tmp/uniform.neph.pfm" "$tmp/$2.pfm" --tolerance "$1" >"$tmp/said" ||
        fail "$2 does not look like the cloud: $(cat "$tmp/said")"
}
looks_like 0.003 uniform.vdb
looks_like 0.03 back.neph
head -c 100 "$tmp/cloud.neph" > "$tmp/cut.neph"
refused 1 "cut.neph: " "$tmp/cut.neph" -o "$tmp/none.vdb"
"$programs/neph-edit" -q "$tmp/cloud.neph" --clip --clip-height 1000 -o "$tmp/empty.neph"
refused 1 "no cloud in it has a primitive" "$tmp/empty.neph" -o "$tmp/none.vdb"
refused 1 "nothing is in the grid" "$tmp/cloud.neph" --voxel-size 1e6 -o "$tmp/none.vdb"
refused 2 "suffix" "$tmp/cloud.neph" -o "$tmp/none.png"
refused 2 "give one of them" "$tmp/cloud.neph" --resolution 20 --voxel-size 1 -o "$tmp/none.vdb"
refused 2 "expected light" "$tmp/cloud.neph" --grids lights -o "$tmp/none.vdb"
refused 2 "without --grids light" "$tmp/cloud.neph" --sky none -o "$tmp/none.vdb"
refused 2 "one grid" "$tmp/cloud.neph" --grids sdf -o "$tmp/none.raw"
refused 2 "sidecar" "$tmp/cloud.neph" --format raw
