# Options without a meaning where they stand are refused, not ignored; and what --save-scene writes is what was shown.
# $1: programs, $2: source folder.
set -eu
bin=$(cd "$1" && pwd)
source=$(cd "$2" && pwd)
temporary=$(mktemp -d)
trap 'rm -r "$temporary"' EXIT
cd "$temporary"

fail()
{
    echo "cli_refused: $*" >&2
    exit 1
}

# refused CODE TEXT COMMAND...: ends with that code and one line that holds the text.
refused()
{
    wanted=$1 text=$2
    shift 2
    code=0
    "$@" >out 2>err || code=$?
    [ "$code" -eq "$wanted" ] || fail "$* ended with $code, not $wanted: $(cat err)"
    [ "$(wc -l <err)" -eq 1 ] || fail "$* gave more than one line: $(cat err)"
    grep -q -e "$text" err || fail "$*: \"$(cat err)\" does not say \"$text\""
}

vdb=$source/tests/frozen/vdb/fog.vdb
small="--size 16x9"
"$bin/neph-gauss" -q --count 4 -o c.neph
"$bin/neph-render" -q c.neph $small --spp 1 -o a.pfm
for options in "--spp 3" "--size 4x4" "--stats" "--rule simpson" "--density-gain 2" "--save-scene z.json" "--mesh a.obj"; do
    # Word by word.
    # shellcheck disable=SC2086
    refused 2 "no meaning with --compare" "$bin/neph-render" --compare a.pfm a.pfm $options
done
[ ! -e z.json ] || fail "--compare --save-scene wrote a scene"
refused 2 "there is no lamp" "$bin/neph-render" c.neph $small --lamp-intensity 1,1,1 -o x.pfm
for light in grid two-pass "single --shadow grid"; do
    # shellcheck disable=SC2086
    refused 2 "made for the sun alone" "$bin/neph-render" c.neph $small --method march --light $light --lamp 0,9,0 -o x.pfm
done
refused 2 "know the sun alone" "$bin/neph-render" c.neph $small --method paper --lamp 0,9,0 -o x.pfm
for options in "--paper-lod" "--fps 3" "--day-speed 2" "--latitude 3" "--declination 3" "--morph-time 2"; do
    # shellcheck disable=SC2086
    refused 2 "belongs\|needs" "$bin/neph-view" c.neph $small --headless --samples 1 $options -o x.pfm
done
refused 2 "bench" "$bin/neph-view" c.neph $small --bench 1 --samples 3
refused 2 "needs --bench" "$bin/neph-view" c.neph $small --headless --bench-frames x.csv -o x.pfm
refused 2 "holds no alpha" "$bin/neph-view" c.neph $small --frames 0..1 --alpha -o f.%d.pfm
refused 2 "a .neph or a grammar" "$bin/neph-view" c.neph $small --headless --morph "$vdb" -o x.pfm
[ -z "$(find . -name 'f.*')" ] || fail "a frame was written before the mistake was told"
for options in "--sun 3,4" "--sky none" "--sun-irradiance 1,1,1" "--grids sdf" "--half" "--resolution 9"; do
    # shellcheck disable=SC2086
    refused 2 "volumes that are written" "$bin/neph-vdb" "$vdb" $options -o x.neph
done
refused 2 "volumes that are read" "$bin/neph-vdb" c.neph --cells 30 -o x.vdb
refused 2 "of a volume a .neph is made" "$bin/neph-vdb" "$vdb" -o x.VDB

# A voxel grid is no heap of primitives.
for method in paper paper-ndt; do
    refused 1 "not voxel grids" "$bin/neph-render" -q "$vdb" $small --method $method -o x.pfm
done
for options in "--drift 1,0,0" "--life 2" "--grow 4" "--decay 0..2"; do
    # shellcheck disable=SC2086
    refused 1 "voxel grid" "$bin/neph-view" -q "$vdb" $small --headless --samples 1 --time 1 $options -o x.pfm
done
[ ! -e x.pfm ] && [ ! -e x.neph ] && [ ! -e x.vdb ] && [ ! -e x.VDB ] || fail "a refused command wrote a file"
"$bin/neph-view" -q "$vdb" $small --headless --samples 1 --light-grid 4 --time 1 --wind 1,0,0 -o wind.pfm ||
    fail "the wind does not carry a volume"

# The scene that is saved has the sun and the eye of the moment that was drawn: drawn again by it, the same picture.
view="--headless --samples 2 --light-grid 8 --size 32x18"
# shellcheck disable=SC2086
"$bin/neph-view" -q c.neph $view --day 17 --turntable 8 --time 1 -o day.pfm --save-scene day.json
"$bin/neph-view" -q day.json --headless --samples 2 --light-grid 8 -o again.pfm
# The sun's place goes through degrees and back.
"$bin/neph-render" --compare day.pfm again.pfm --tolerance 1e-9 >/dev/null || fail "the saved scene has another sun or eye"
# shellcheck disable=SC2086
"$bin/neph-view" -q c.neph $view -o noon.pfm
! "$bin/neph-render" --compare day.pfm noon.pfm --tolerance 1e-3 >/dev/null || fail "the day and the turntable change nothing"
"$bin/neph-view" -q c.neph --bench 3 --light-grid 4 $small --eye 0,1,20 --save-scene bench.json >/dev/null
grep -q '"eye": \[0, 1, 20\]' bench.json || fail "--bench saved the eye that it had moved: $(grep -A4 eye bench.json)"

# One line a mistake, whatever an argument or a file's name holds; no terminal obeys it.
broken=$(printf 'a\nb\033[2J')
refused 2 'a?b?\[2J' "$bin/neph-gauss" "$broken"
refused 2 'a?b?\[2J' "$bin/neph-gauss" --count "$broken"
refused 1 'a?b?\[2J' "$bin/neph-info" "$broken"
