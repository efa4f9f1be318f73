# What neph-vdb writes, in Blender, without a display: the grid is found, its bounds are where neph-info says, upright,
# and Cycles' picture has our picture's brightness from the same camera and sun. A command of its own, not part of CTest:
# Blender is large. $1: programs, $2: source. Needs Debian's packages blender and python3.
set -eu
programs=$(cd "$1" && pwd)
script=$(cd "$2/examples/blender" && pwd)/import_vdb.py
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT

fail() {
    echo "blender_vdb: $1" >&2
    exit 1
}
command -v blender > /dev/null || fail "blender is missing (install Debian's package blender)"
in_blender() {
    blender -b --factory-startup --python-exit-code 1 --python "$script" -- "$@"
}

# Far broader along x than along z, and off the origin: a turned or mirrored volume is noticed.
"$programs/neph-gauss" --seed 5 --sigma 4,1,1.5 --at 3,20,-8 --model uniform --extinction 1 --albedo 0.984375 --g 0.5 -q -o "$tmp/cloud.neph"
"$programs/neph-info" --json "$tmp/cloud.neph" > "$tmp/info.json"
for options in "" "--half" "--grids profile,light"; do
    # Word by word.
    # shellcheck disable=SC2086
    "$programs/neph-vdb" -q "$tmp/cloud.neph" --resolution 96 $options -o "$tmp/cloud.vdb"
    in_blender "$tmp/cloud.vdb" --check > "$tmp/said" 2>&1 || fail "Blender failed: $(tail -n 5 "$tmp/said")"
    grep '^{' "$tmp/said" > "$tmp/found.json" || fail "nothing found: $(tail -n 5 "$tmp/said")"
    python3 - "$tmp" << 'END' || fail "grids or bounds are wrong ($options): $(cat "$tmp/found.json")"
import json, sys
info, found = (json.load(open(f"{sys.argv[1]}/{name}.json")) for name in ("info", "found"))
low, high = info["clouds"][0]["bounds"]
voxel = max(b - a for a, b in zip(low, high)) / 96
assert ["density", "FLOAT"] in found["grids"]
assert (found["extinction"], found["albedo"], found["g"]) == (1, 0.984375, 0.5), found
for is_, wanted in zip(found["min"], (low[0], -high[2], low[1])):
    assert abs(is_ - wanted) < 1.5 * voxel, (is_, wanted)
# Blender's box is that of the leaves, of eight voxels each.
for is_, wanted in zip(found["max"], (high[0], -low[2], high[1])):
    assert -1.5 * voxel < is_ - wanted < 8.5 * voxel, (is_, wanted)
END
done

view="--eye 3,22,14 --target 3,21,-8 --fov 40 --sun 20,40 --size 96x54"
# shellcheck disable=SC2086
in_blender "$tmp/cloud.vdb" $view --sky 0.1,0.1,0.1 --samples 32 --render "$tmp/theirs.exr" \
    > "$tmp/said" 2>&1 || fail "Cycles failed: $(tail -n 5 "$tmp/said")"
# shellcheck disable=SC2086
"$programs/neph-render" -q "$tmp/cloud.neph" $view --sky 0.1,0.1,0.1 --spp 64 -o "$tmp/ours.exr"
"$programs/neph-render" --compare "$tmp/theirs.exr" "$tmp/ours.exr" > "$tmp/compared.json"
# Both are unbiased but for Cycles' march and the voxels' edge. What the cloud adds to the sky's mean is compared, so the
# noise of so few paths counts: a tenth of it.
python3 - "$tmp/compared.json" << 'END' || fail "the pictures differ: $(cat "$tmp/compared.json")"
import json, sys
c = json.load(open(sys.argv[1]))
sky = 0.1
a, b = (sum(c[m]) / 3 - sky for m in ("mean_a", "mean_b"))
assert b > 0.01, "there is no cloud in the picture"
assert abs(a / b - 1) < 0.1, (a, b)
END
echo "blender_vdb: Blender finds the grid where it should be, and Cycles' picture agrees"
