# The add-on examples/blender/nephele_addon.py in Blender, without a display: clouds of a mesh, a grammar and a heap are
# made and made again, their bounds are where neph-info says, Cycles' pictures are bright on the sunny side and as bright
# as ours; what goes wrong is reported, and leaves the scene and the folders as they were. A command of its own, not part
# of CTest: Blender is large. $1: programs, $2: source, $3: folder for the pictures, to look at [none].
# Needs Debian's packages blender and python3.
set -eu
programs=$(cd "$1" && pwd)
source=$(cd "$2" && pwd)
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT

fail() {
    echo "blender_addon: $1" >&2
    exit 1
}
command -v blender > /dev/null || fail "blender is missing (install Debian's package blender)"

mkdir "$tmp/stage" "$tmp/stage/broken" "$tmp/scripts" "$tmp/temporary"
printf '#!/bin/sh\necho "neph-gauss: the disk is full (make room)" >&2\nexit 1\n' > "$tmp/stage/broken/neph-gauss"
printf '#!/bin/sh\nexec sleep 60\n' > "$tmp/stage/broken/neph-mesh"
printf '#!/no/such/interpreter\n' > "$tmp/stage/broken/neph-lsys"
chmod +x "$tmp"/stage/broken/*
BLENDER_USER_SCRIPTS=$tmp/scripts TMPDIR=$tmp/temporary blender -b --factory-startup --python-exit-code 1 \
    --python "$source/tests/blender_addon.py" -- "$programs" "$source" "$tmp/stage" > "$tmp/said" 2>&1 ||
    fail "Blender says: $(grep -v '^Fra:' "$tmp/said" | tail -n 12)"
if [ $# -gt 2 ]; then
    mkdir -p "$3"
    cp "$tmp"/stage/*.png "$3"
fi
grep -q "all is as it should be" "$tmp/said" || fail "it did not come to its end: $(tail -n 5 "$tmp/said")"
grep -q "a temporary folder, emptied when Blender ends" "$tmp/said" || fail "not said: a temporary folder"
grep "sunny half" "$tmp/said"
left=$(find "$tmp/temporary" "$tmp/stage" -name 'nephele-*' -o -name '*.part' -o -name 'cloud.neph')
[ -z "$left" ] || fail "left behind: $left"

# What the cloud adds to the sky's mean, as in blender_vdb.sh: unbiased both, but for Cycles' march, the voxels' edge and
# the noise of so few paths: a tenth.
"$programs/neph-gauss" -q --seed 5 --sigma 4,1,1.5 --model uniform --extinction 1 --albedo 0.8 --g 0.4 -o "$tmp/cloud.neph"
"$programs/neph-render" -q "$tmp/cloud.neph" --eye 0,2,22 --target 0,1,0 --fov 40 --sun 20,40 --size 96x54 \
    --sky 0.1,0.1,0.1 --spp 64 -o "$tmp/ours.exr"
"$programs/neph-render" --compare "$tmp/stage/theirs.exr" "$tmp/ours.exr" > "$tmp/compared.json"
python3 - "$tmp/compared.json" << 'END' || fail "the pictures differ: $(cat "$tmp/compared.json")"
import json, sys
c = json.load(open(sys.argv[1]))
a, b = (sum(c[m]) / 3 - 0.1 for m in ("mean_a", "mean_b"))
assert b > 0.01, "there is no cloud in the picture"
assert abs(a / b - 1) < 0.1, (a, b)
END
echo "blender_addon: clouds are made, made again, and look as they should"
