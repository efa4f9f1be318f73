# neph-view's window and what it keeps, as a person uses it: a scene saved and opened again, pictures that are scenes, a large
# picture broken off; an OpenGL context that is lost, a GPU that cannot draw into float textures, letters of twice the size.
# Each step is checked by what must have changed. $1: programs, $2: source folder. KEEP=folder keeps the pictures.
set -eu
bin=$1
source=$2
test=cli_window_scene
screen_options=-noreset # what xprop says of the screen stays when a viewer has gone
# shellcheck source=tests/window.sh
. "$source/tests/window.sh"
cc -shared -fPIC -O1 -o failing.so "$source/tests/failing_gl.c" -lepoxy || fail "the preloaded library does not build"

small="--samples 1 --light-grid 8"
all=400x200+0+0
"$bin/neph-gauss" -q --count 6 --seed 2 -o a.neph

# --- nearer, brighter, in the rain of shaded primitives: saved, seen again
LD_PRELOAD=$temporary/failing.so
export LD_PRELOAD
# shellcheck disable=SC2086
open a.neph a.neph --size 400x240 --ground -6 $small
unset LD_PRELOAD
shot first
xdotool click --repeat 3 --delay 50 4
key plus plus plus
unlike $all nearer first
key F12
has_picture() { [ -s a-0001.png ]; }
until_true 60 has_picture || fail "F12 wrote no picture"
key p p
unlike $all shaded nearer 0.02
key ctrl+s
has_scene() { [ -s a-0001.json ]; }
until_true 20 has_scene || fail "Ctrl+S wrote no scene: $(cat viewer.log)"
for word in '"primitives": "shaded"' '"exposure": 1.25' '"ground": {"height": -6'; do
    grep -q "$word" a-0001.json || fail "the scene does not hold $word: $(cat a-0001.json)"
done

# --- the context is lost: another window shows the same
touch lose-context
old=$window
is_new() { grep -q "context was lost" viewer.log && find_window && [ "$window" != "$old" ]; }
until_true 60 is_new || fail "nothing is said of the lost context: $(cat viewer.log)"
unlike $all found nearer 0.02 # the primitives are still shaded
key p
like $all found nearer
quit
grep -q 'frames of the window, the longest took' viewer.log || fail "the frames' times are not said: $(cat viewer.log)"

# --- the scene, and the picture as one
open a-0001.json a-0001.json
unlike $all opened nearer 0.02
key p
like $all opened nearer
quit
"$bin/neph-view" -q a-0001.png --headless -o again.png || fail "a picture of the window is no scene"
[ "$(compare -metric AE a-0001.png again.png null: 2>&1)" = 0 ] || fail "the picture's scene is another picture"
"$bin/neph-render" -q a-0001.png --method march --light single -o marched.png || fail "neph-render does not read a picture's scene"

# --- no float textures: said in a line, without a window and in it
touch no-floats
status=0
# shellcheck disable=SC2086
LD_PRELOAD=$temporary/failing.so "$bin/neph-view" a.neph --headless --size 32x18 $small -o x.png 2>said || status=$?
[ "$status" = 1 ] && grep -q "cannot draw into 32-bit float textures" said || fail "without float textures it ends with $status: $(cat said)"
[ ! -e x.png ] || fail "a picture was written without float textures"
LD_PRELOAD=$temporary/failing.so
export LD_PRELOAD
# shellcheck disable=SC2086
open a.neph a.neph --size 400x240 $small
unset LD_PRELOAD
shot refused
[ "$(convert refused.png -crop 390x120+4+110 -format '%k' info:)" -gt 2 ] || fail "the window says nothing of missing float textures"
quit
rm no-floats

# --- a picture that would take hours: it has a bar, Esc breaks it off, and the next one ends the viewer; no file is left
open a.neph a.neph --size 400x240 --samples 65536 --light-grid 8
sleep 1
key F12
has_bar() { import -window "$window" bar.png && [ "$(convert bar.png -crop 100x20+150+135 -format '%[fx:mean<0.4]' info:)" = 1 ]; }
until_true 60 has_bar || fail "a long picture has no bar"
key Escape
is_broken_off() { grep -q "broken off: picture file" viewer.log; }
until_true 20 is_broken_off || fail "Esc does not break a picture off: $(cat viewer.log)"
quit
[ ! -e a-0002.png ] || fail "a picture that was broken off left a file"

# --- a screen of high density: the panel is twice as wide
xprop -root -f RESOURCE_MANAGER 8s -set RESOURCE_MANAGER "Xft.dpi: 192"
# shellcheck disable=SC2086
open a.neph a.neph --size 760x480 $small
shot dense
key Tab
unlike 100x300+480+60 folded dense 0.1
quit
