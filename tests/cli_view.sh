# neph-view: pictures without a window, the bench's JSON, mistakes; then its window on a screen of its own (Xvfb): into
# the cloud and out again, round it, back by Home, Esc. $1: programs, $2: source folder.
set -eu
bin=$1
source=$2
temporary=$(mktemp -d)
screen=
viewer=
finish()
{
    status=$?
    trap - EXIT
    [ -z "$viewer" ] || kill "$viewer" 2>/dev/null || true
    [ -z "$screen" ] || kill "$screen" 2>/dev/null || true
    if [ "$status" -ne 0 ] && [ -n "${KEEP:-}" ]; then
        cp "$temporary"/*.png "$KEEP" 2>/dev/null || true
    fi
    rm -r "$temporary"
    exit "$status"
}
trap finish EXIT
cd "$temporary"

fail()
{
    echo "cli_view: $*" >&2
    exit 1
}

for tool in Xvfb xdotool import compare identify; do
    command -v $tool >/dev/null || fail "$tool is missing (tests/run.sh installs what the tests need)"
done

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
for method in exact paper paper-ndt; do
    # shellcheck disable=SC2086
    "$bin/neph-view" spiral.neph $small --method $method -o $method.pfm || fail "--method $method failed"
    ! cmp -s spiral.pfm $method.pfm || fail "--method $method drew what the default draws"
done

# --- an empty cloud is sky and no error
"$bin/neph-view" "$source/tests/fuzz/corpus/neph/empty" -q --headless --size 32x18 --samples 1 --sky 0.25,0.5,0.75 \
    -o sky.pfm ||
    fail "an empty cloud is no error"
values=$(tail -c $((32 * 18 * 12)) sky.pfm | od -An -v -tfF -w12 | sort -u | tr -s ' ')
[ "$values" = " 0.25 0.5 0.75" ] || fail "the sky behind an empty cloud is: $values"

# --- bench: every key of the contract, numbers in their order
"$bin/neph-view" spiral.neph -q --bench 3 --size 32x18 --light-grid 8 -o last.png >bench.json || fail "--bench failed"
[ -s last.png ] || fail "--bench with -o wrote no last frame"
for key in method size frames load_ms light_ms bake_ms first_picture_ms frame_ms min median p95 primitives \
    steps_per_pixel fetches_per_pixel; do
    grep -q "\"$key\":" bench.json || fail "the bench's JSON lacks $key"
done
grep -q '"frames": 3' bench.json && grep -q '"primitives": 128' bench.json || fail "the bench miscounts: $(cat bench.json)"
[ "$(tr -d ' \n' <bench.json | sed 's/.*"size":\[\([^]]*\)\].*/\1/')" = 32,18 ] || fail "the bench's size is wrong"
number() { sed -n "s/.*\"$1\": *\([0-9.e+-]*\).*/\1/p" bench.json; }
awk "BEGIN { exit !($(number min) > 0 && $(number min) <= $(number median) && $(number median) <= $(number p95) && \
    $(number steps_per_pixel) > 0 && $(number first_picture_ms) >= $(number light_ms)) }" ||
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
[ ! -e x.jpg ] || fail "a refused picture is there all the same"
refused 2 method spiral.neph --headless --method fast -o x.png
refused 2 size spiral.neph --headless --size 0x8 -o x.png
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

# --- the window
Xvfb -displayfd 3 -screen 0 640x480x24 -nolisten tcp 3>display 2>xvfb.log &
screen=$!
for _ in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do
    [ ! -s display ] || break
    sleep 0.2
done
[ -s display ] || fail "Xvfb did not start: $(cat xvfb.log)"
DISPLAY=:$(cat display)
export DISPLAY
unset WAYLAND_DISPLAY
"$bin/neph-gauss" -q -o cumulus.neph
"$bin/neph-view" cumulus.neph -q --size 320x180 --samples 4 --light-grid 12 2>viewer.log &
viewer=$!
window=$(timeout 20 xdotool search --sync --onlyvisible --pid $viewer 2>/dev/null | head -n 1) || true
[ -n "$window" ] || window=$(timeout 10 xdotool search --sync --onlyvisible --name cumulus | head -n 1)
[ -n "$window" ] || fail "no window came up: $(cat viewer.log)"

# distance A B: root mean square difference, of 1
distance() { compare -metric RMSE "$1" "$2" null: 2>&1 | sed 's/.*(\(.*\)).*/\1/'; }
# still NAME: a screenshot of a picture that rests: two in a row that agree and hold something
still()
{
    rm -f before.png
    for _ in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26 27 28 29 30; do
        sleep 0.25
        import -window "$window" "$1.png"
        if [ -e before.png ] && [ "$(identify -format %k "$1.png")" -gt 100 ] && cmp -s before.png "$1.png"; then
            return
        fi
        kill -0 "$viewer" 2>/dev/null || fail "the viewer ended: $(cat viewer.log)"
        mv "$1.png" before.png
    done
    fail "the picture \"$1\" did not come to rest"
}
# like A B, unlike A B
like() { awk "BEGIN { exit !($(distance "$1.png" "$2.png") < 0.01) }" || fail "$2 should look like $1"; }
unlike() { awk "BEGIN { exit !($(distance "$1.png" "$2.png") > 0.05) }" || fail "$2 should not look like $1"; }
# wheel BUTTON TIMES
wheel() { xdotool mousemove --window "$window" 160 90 click --repeat "$2" --delay 5 "$1"; }

xdotool mousemove --window "$window" 160 90
still first
wheel 4 18
still inside
unlike first inside
wheel 5 18
still outside
unlike inside outside
xdotool key --window "$window" Home
still home
like first home
xdotool mousemove --window "$window" 100 60 mousedown 1 mousemove --window "$window" 160 90 \
    mousemove --window "$window" 250 100 mouseup 1
still turned
unlike first turned
xdotool key --window "$window" Home
still home
like first home
# The window is gone before the key is let go, which xdotool takes amiss.
xdotool key --window "$window" Escape 2>/dev/null || true
status=0
wait "$viewer" || status=$?
viewer=
[ "$status" = 0 ] || fail "Esc ended the viewer with $status: $(cat viewer.log)"
[ -z "${KEEP:-}" ] || cp ./*.png "$KEEP"
