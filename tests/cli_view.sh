# neph-view without its window: pictures, the bench's JSON, mistakes, shaders. $1: programs, $2: source folder.
set -eu
bin=$1
source=$2
temporary=$(mktemp -d)
trap 'rm -r "$temporary"' EXIT
cd "$temporary"

fail()
{
    echo "cli_view: $*" >&2
    exit 1
}

command -v identify >/dev/null || fail "identify is missing (tests/run.sh installs what the tests need)"

# --- a grammar becomes a picture, in a pipe, of every format
"$bin/neph-lsys" -q "$source/examples/spiral.lsys" | "$bin/neph-view" - -q --headless --size 64x36 --samples 1 -o spiral.png ||
    fail "a pipe from neph-lsys gave no picture"
"$bin/neph-lsys" -q "$source/examples/spiral.lsys" -o spiral.neph
small="-q --headless --size 32x18 --samples 1 --light-grid 8"
[ "$(identify -format '%m %wx%h' spiral.png)" = "PNG 64x36" ] || fail "spiral.png is no PNG of 64x36"
[ "$(identify -format '%k' spiral.png)" -gt 200 ] || fail "spiral.png shows next to nothing"
# shellcheck disable=SC2086
"$bin/neph-view" spiral.neph $small -o spiral.pfm
[ "$(head -c 13 spiral.pfm | head -n 2 | tr '\n' ' ')" = "PF 32 18 " ] || fail "spiral.pfm does not begin as a PFM does"
[ "$(wc -c <spiral.pfm)" -ge $((32 * 18 * 12)) ] || fail "spiral.pfm is too short"
# shellcheck disable=SC2086
"$bin/neph-view" spiral.neph $small -o spiral.exr
[ "$(head -c 4 spiral.exr | od -An -tx1 | tr -d ' ')" = 762f3101 ] || fail "spiral.exr is no EXR file"
# shellcheck disable=SC2086
"$bin/neph-view" spiral.neph $small >out.png
[ "$(identify -format '%m %wx%h' out.png)" = "PNG 32x18" ] || fail "standard output was no PNG"
# The same command, the same picture.
# shellcheck disable=SC2086
"$bin/neph-view" spiral.neph $small -o again.pfm
cmp spiral.pfm again.pfm || fail "the same command drew two pictures"
# The seed is that of the rays' starts: 1 is the default, another one is another picture.
# shellcheck disable=SC2086
"$bin/neph-view" spiral.neph $small --seed 1 -o again.pfm
cmp spiral.pfm again.pfm || fail "--seed 1 is not the default"
# shellcheck disable=SC2086
"$bin/neph-view" spiral.neph $small --seed 2 -o again.pfm
! cmp -s spiral.pfm again.pfm || fail "--seed 2 drew what seed 1 draws"
# --error draws as fine as it needs: a tighter one finer, nearer to the finest, and what cannot be kept is said.
# Without a sky, which would be most of the picture: 0.3 is 0.0005 off, a cloud upside down would be 0.062.
view="--headless --size 48x27 --sky none"
for error in 0.3 0.02 0.0001; do
    # shellcheck disable=SC2086
    "$bin/neph-view" spiral.neph $view --error $error -o "error$error.pfm" 2>"said$error" || fail "--error $error failed"
done
cells() { sed -n 's/.*light grid of \([0-9]*\) cells.*/\1/p' "$1"; }
[ "$(cells said0.3)" -lt "$(cells said0.0001)" ] || fail "--error 0.3 is drawn as finely as 0.0001"
grep -q "more than --error" said0.0001 || fail "an error that is not kept is not said"
! grep -q "more than --error" said0.3 || fail "--error 0.3 is not kept"
"$bin/neph-render" --compare error0.3.pfm error0.0001.pfm --tolerance 0.005 >/dev/null || fail "--error 0.3 is off by more"
# Far off, too, it has the cells that it says: more than without --error, where they are as few as the cloud has pixels. Were they
# the same, the picture would be, to the bit.
far="--headless --size 48x27 --sky none --eye 0,4,150 --fov 30"
# shellcheck disable=SC2086
"$bin/neph-view" spiral.neph $far --error 0.3 -o far.pfm 2>said || fail "--error failed far off"
# shellcheck disable=SC2086
"$bin/neph-view" spiral.neph -q $far --light-grid "$(cells said)" --samples 8 -o pixels.pfm
! cmp -s far.pfm pixels.pfm || fail "far off, --error has no more cells than pixels need"
code=0
"$bin/neph-view" spiral.neph --headless --error 0.1 --samples 3 -o x.png 2>/dev/null || code=$?
[ "$code" -eq 2 ] || fail "--error --samples ended with $code, not 2"
for method in exact paper paper-ndt; do
    # shellcheck disable=SC2086
    "$bin/neph-view" spiral.neph $small --method $method -o $method.pfm || fail "--method $method failed"
    ! cmp -s spiral.pfm $method.pfm || fail "--method $method drew what the default draws"
done

# --- by what the clouds are lit: each term changes the picture, what a scene keeps of it draws the same, and each stands in the
# picture that neph-render makes with the same words
lit="--light octaves --light-octaves 2 --ambient 0.1,0.2,0.3 --emission 0.3,0.1,0"
for term in "--light powder" "--light powder --powder 0.5" "--light octaves" "--light octaves --light-octaves 2" \
    "--ambient 0.1,0.2,0.3" "--emission 0.3,0.1,0"; do
    # shellcheck disable=SC2086
    "$bin/neph-view" spiral.neph $small $term -o lit.pfm || fail "$term failed"
    for other in spiral lit-*; do
        ! cmp -s lit.pfm "${other%.pfm}.pfm" || fail "$term drew what $other is"
    done
    cp lit.pfm "lit-$(echo "$term" | tr -d ' ').pfm"
done
# shellcheck disable=SC2086
"$bin/neph-view" spiral.neph $small $lit -o lit.pfm --save-scene lit.json || fail "$lit failed"
# shellcheck disable=SC2086
"$bin/neph-view" lit.json $small -o again.pfm || fail "a scene with its light failed"
cmp lit.pfm again.pfm || fail "a scene does not keep by what its clouds are lit: $(cat lit.json)"
# shellcheck disable=SC2086
"$bin/neph-view" lit.json $small --light grid --ambient 0,0,0 --emission 0,0,0 -o again.pfm
cmp spiral.pfm again.pfm || fail "the command line does not go before a scene's light"
"$bin/neph-view" spiral.neph -q --headless --size 96x54 --samples 4 $lit -o lit.pfm
"$bin/neph-render" spiral.neph -q --size 96x54 --method march $lit -o marched.pfm
"$bin/neph-render" --compare lit.pfm marched.pfm --tolerance 0.004 >/dev/null || fail "$lit is not neph-render's"

# --- an empty cloud is sky and no error
"$bin/neph-view" "$source/tests/fuzz/corpus/neph/empty" -q --headless --size 32x18 --samples 1 --sky 0.25,0.5,0.75 \
    -o sky.pfm ||
    fail "an empty cloud is no error"
values=$(tail -c $((32 * 18 * 12)) sky.pfm | od -An -v -tfF -w12 | sort -u | tr -s ' ')
[ "$values" = " 0.25 0.5 0.75" ] || fail "the sky behind an empty cloud is: $values"

# --- a flight in and out of the cloud: every value a number, and it moves on; only as a bench
"$bin/neph-view" spiral.neph -q --bench 6 --flight --size 32x18 --light-grid 8 --bench-frames flight.csv >flight.json ||
    fail "--flight failed"
grep -q '"wrong_values": 0' flight.json || fail "a flight's picture holds no number: $(cat flight.json)"
grep -q '"largest_jump": 0.0,*$' flight.json && fail "the flight stands still"
# a row a frame, of which the largest jump is the report's, and the clouds that came into use are all of them
[ "$(wc -l <flight.csv)" -eq 7 ] || fail "--bench-frames: not 6 rows below their names: $(cat flight.csv)"
awk -F, -v json="$(sed -n 's/.*"\(largest_jump\|clouds_lit\)": *\([0-9.e+-]*\).*/\2/p' flight.json | tr '\n' ' ')" '
    NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i }
    NR > 1 { jump = $at["jump"] > jump ? $at["jump"] : jump; lit += $at["clouds_lit"] }
    END { split(json, said, " "); exit !(lit == said[1] && jump > said[2] - 1e-5 && jump < said[2] + 1e-5) }' flight.csv ||
    fail "--bench-frames does not agree with the report: $(cat flight.csv flight.json)"

# --- bench: every key of the contract, numbers in their order
"$bin/neph-view" spiral.neph -q --bench 3 --size 32x18 --light-grid 8 -o last.png >bench.json || fail "--bench failed"
[ -s last.png ] || fail "--bench with -o wrote no last frame"
for key in method size frames load_ms light_ms bake_ms first_picture_ms libraries_ms context_ms first_frame_ms frame_ms min median p95 processor_ms_min processor_ms_median primitives \
    steps_per_pixel fetches_per_pixel cpu_ms memory_bytes light_bytes baked_bytes; do
    grep -q "\"$key\":" bench.json || fail "the bench's JSON lacks $key"
done
grep -q '"frames": 3' bench.json && grep -q '"primitives": 128' bench.json || fail "the bench miscounts: $(cat bench.json)"
[ "$(tr -d ' \n' <bench.json | sed 's/.*"size":\[\([^]]*\)\].*/\1/')" = 32,18 ] || fail "the bench's size is wrong"
number() { sed -n "s/.*\"$1\": *\([0-9.e+-]*\).*/\1/p" bench.json; }
awk "BEGIN { exit !($(number min) > 0 && $(number min) <= $(number median) && $(number median) <= $(number p95) && \
    $(number steps_per_pixel) > 0 && $(number memory_bytes) > 1000000 && $(number cpu_ms) > 0 && $(number baked_bytes) > 0 && $(number first_picture_ms) >= $(number light_ms)) }" ||
    fail "the bench's numbers do not agree: $(cat bench.json)"

# --- mistakes: exit code, one line, no output
# refused CODE WORDS ARGUMENT...
refused()
{
    code=$1 words=$2 status=0
    shift 2
    "$bin/neph-view" "$@" >stdout 2>stderr || status=$?
    [ "$status" = "$code" ] || fail "neph-view $* ended with $status, not $code: $(cat stderr)"
    [ ! -s stdout ] || fail "neph-view $* wrote to standard output"
    [ "$(wc -l <stderr)" = 1 ] || fail "neph-view $* wrote more or less than one line: $(cat stderr)"
    grep -qi -- "$words" stderr || fail "neph-view $* does not say \"$words\" but: $(cat stderr)"
}
refused 2 jpg spiral.neph --headless --size 8x8 -o x.jpg
refused 2 jpg spiral.neph --bench 1 --size 8x8 -o x.jpg
refused 2 flight spiral.neph --headless --flight -o x.png
[ ! -e x.jpg ] || fail "a refused picture is there all the same"
refused 2 method spiral.neph --headless --method fast -o x.png
refused 2 size spiral.neph --headless --size 0x8 -o x.png
refused 2 "light powder" spiral.neph --headless --powder 3 -o x.png
refused 2 "light octaves" spiral.neph --headless --light powder --light-octaves 3 -o x.png
refused 2 "2018" spiral.neph --headless --method paper --ambient 1,1,1 -o x.png
refused 2 "same point" spiral.neph --headless --eye 1,2,3 --target 1,2,3 -o x.png
refused 2 headless spiral.neph -o x.png
refused 1 "no-such" no-such.neph --headless -o x.png
cp "$source/examples/spiral.lsys" text.neph
refused 1 neph text.neph --headless -o x.png
refused 1 "no-such-folder/view" spiral.neph --headless --size 8x8 --shaders no-such-folder -o x.png
refused 1 folder spiral.neph --headless --size 8x8 --samples 1 -o no-such-folder/x.png
[ ! -e x.png ] || fail "a failed command left a picture"
env -u DISPLAY -u WAYLAND_DISPLAY "$bin/neph-view" spiral.neph 2>stderr && fail "a window without a display"
grep -q -- --headless stderr || fail "without a display --headless should be named: $(cat stderr)"

# --- shaders from a folder: the shipped ones give the same picture, changed ones another, broken ones an error
# shellcheck disable=SC2086
"$bin/neph-view" spiral.neph $small --shaders "$source/shaders" -o again.pfm
cmp spiral.pfm again.pfm || fail "--shaders with the shipped shaders draws another picture"
cp -r "$source/shaders" own
echo "syntax error" >>own/view/camera.glsl
refused 1 shader spiral.neph --headless --size 8x8 --shaders own -o x.png
