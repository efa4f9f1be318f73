# Volumes as inputs of neph-render, neph-view and neph-vdb: OpenVDB and raw, by name and by pipe, and what is refused.
set -eu
bin=$1
vdb=$2/tests/frozen/vdb
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cd "$dir"

fail() {
    echo "cli_volume: $1" >&2
    exit 1
}
# refused CODE TEXT COMMAND...: ends with that code and one line that holds TEXT.
refused() {
    wanted=$1
    text=$2
    shift 2
    code=0
    "$@" >out 2>err || code=$?
    [ "$code" -eq "$wanted" ] || fail "$* ended with $code, not $wanted"
    [ "$(wc -l <err)" -eq 1 ] || fail "$* gave more than one line: $(cat err)"
    grep -q -e "$text" err || fail "$*: \"$(cat err)\" does not say \"$text\""
}

small="--size 24x16 --method march --steps 20 --light-resolution 8"
"$bin/neph-render" -q "$vdb/levelset.vdb" $small -o a.pfm || fail "a .vdb was not rendered"
"$bin/neph-render" -q - $small -o b.pfm <"$vdb/levelset.vdb" || fail "a .vdb from a pipe was not rendered"
cmp -s a.pfm b.pfm || fail "a pipe makes another picture than a file"
"$bin/neph-render" -q "$vdb/levelset.vdb" $small --density-gain 0.5 -o half.pfm
cmp -s a.pfm half.pfm && fail "--density-gain changes nothing"
"$bin/neph-render" -q "$vdb/levelset.vdb" $small --extinction 1 -o thin.pfm
"$bin/neph-render" --compare half.pfm thin.pfm --tolerance 1e-6 >/dev/null ||
    fail "half the density is not half the extinction"
# Without a sky, which would be most of each picture: the viewer's differs by 0.0005, a picture without the cloud by 0.033.
"$bin/neph-render" -q "$vdb/levelset.vdb" $small --sky none -o black.pfm
"$bin/neph-view" -q "$vdb/levelset.vdb" --headless --samples 2 --light-grid 8 --size 24x16 --sky none -o view.pfm ||
    fail "neph-view shows no .vdb"
"$bin/neph-render" --compare view.pfm black.pfm --tolerance 0.003 >/dev/null || fail "neph-view shows something else"

# A cloud written with either axis up looks the same where it is read with that axis (to float rounding, which moves a voxel's
# edge: 1e-6 here), and lies on its side where it is read with the other (0.03 to 0.05).
"$bin/neph-gauss" -q --count 4 --seed 5 --extinction 1 -o axes.neph
for up in z y; do
    "$bin/neph-vdb" -q axes.neph --resolution 24 --up $up -o $up.vdb
    "$bin/neph-render" -q $up.vdb $small --sky none --up $up -o $up.pfm
done
"$bin/neph-render" -q y.vdb $small --sky none -o side.pfm
"$bin/neph-render" --compare z.pfm y.pfm --tolerance 1e-4 >/dev/null || fail "--up y is another picture than --up z"
"$bin/neph-render" --compare z.pfm side.pfm --tolerance 0.01 >/dev/null 2>&1 && fail "--up changes nothing"

# Colour from a second grid: the mean light of the voxels, which neph-vdb writes, as three channels. Bluish shadows (the sky's
# light) and black where none came make another picture by either method, and nothing becomes brighter by it.
"$bin/neph-vdb" -q axes.neph --resolution 24 --grids light -o lit.vdb
for method in "march --light single --steps 20" "march --steps 20 --light-resolution 8" "reference --spp 4 --max-bounces 1"; do
    for colour in "" "--colour-grid light"; do
        # shellcheck disable=SC2086
        "$bin/neph-render" -q lit.vdb --size 24x16 --sky none --method $method $colour --grid density -o "colour$colour.pfm" \
            --stats >"colour$colour.json" || fail "--method $method $colour failed"
    done
    python3 -c '
import json
grey, coloured = (json.load(open(name))["mean"] for name in ("colour.json", "colour--colour-grid light.json"))
assert all(0 < c < 0.9 * g for c, g in zip(coloured, grey)), (grey, coloured)
assert coloured[0] != coloured[2]' || fail "--method $method: --colour-grid does not colour the cloud"
done
"$bin/neph-render" lit.vdb --size 8x8 --method march --steps 9 --light single --colour-grid light -o x.pfm 2>err
grep -q 'grid "density", coloured by light' err || fail "nothing says where the colour is from: $(cat err)"
rm x.pfm
refused 1 'no grid of vectors called "nope"' "$bin/neph-render" lit.vdb $small --colour-grid nope -o no.png
refused 1 "2 colour grids" "$bin/neph-render" lit.vdb $small --colour-grid light,light -o no.png
refused 2 "harris has no colours" "$bin/neph-render" lit.vdb --size 8x8 --method march --light harris --colour-grid light -o no.png
refused 2 "colour-grid belongs to volumes" "$bin/neph-render" axes.neph --colour-grid light -o no.png

# A raw volume of 2 x 1 x 1 floats, 1 and 0.5.
printf '\002\000\000\000\001\000\000\000\001\000\000\000\000\000\200\077\000\000\000\077' >two.raw
"$bin/neph-render" -q two.raw $small -o raw.pfm || fail "a raw volume was not rendered"
"$bin/neph-render" -q - $small -o pipe.pfm <two.raw || fail "a raw volume from a pipe was not rendered"
cmp -s raw.pfm pipe.pfm || fail "a pipe makes another picture than a file"
head -c 19 two.raw >short.raw
refused 1 "20, not 19\|has 20 bytes" "$bin/neph-render" short.raw $small -o no.png

refused 1 "no grid for --colour-grid" "$bin/neph-render" two.raw $small --colour-grid light -o no.png
refused 1 "choose one with --grid" "$bin/neph-render" "$vdb/several.vdb" $small -o no.png
refused 1 "no scalar grid" "$bin/neph-render" "$vdb/vector.vdb" $small -o no.png
refused 1 "empty" "$bin/neph-render" "$vdb/empty.vdb" $small -o no.png
refused 1 "not finite" "$bin/neph-vdb" "$vdb/nan.vdb" -o no.neph
head -c 5000 "$vdb/fog.vdb" >cut.vdb
refused 1 "cut.vdb" "$bin/neph-render" cut.vdb $small -o no.png
[ ! -e no.png ] && [ ! -e no.neph ] || fail "a refused input left an output"
"$bin/neph-gauss" -q --count 2 -o c.neph
refused 2 "density-gain belongs to volumes" "$bin/neph-render" c.neph --density-gain 2 -o no.png
refused 2 "the suffix is none of" "$bin/neph-vdb" c.neph -o no.neph

# A ball comes back as one sphere of about its size: half of the ramp of three eighths lies outside half the density.
"$bin/neph-vdb" "$vdb/levelset.vdb" --primitives 1 --cells 24 -o ball.neph 2>err || fail "no fit: $(cat err)"
grep -q "RMSE" err || fail "the fit tells no error"
"$bin/neph-vdb" -q "$vdb/levelset.vdb" --primitives 1 --cells 24 -o again.neph
cmp -s ball.neph again.neph || fail "the same fit makes other bytes"
"$bin/neph-info" --csv ball.neph | tail -n 1 | awk -F, '{
    if (!($6 > 0.7 && $6 < 0.95)) exit 1 }' || fail "the ball has another size: $("$bin/neph-info" --csv ball.neph)"
"$bin/neph-info" --json ball.neph | grep -q levelset.vdb || fail "the cloud does not say what it was made from"
