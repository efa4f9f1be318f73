# neph-view's window with several files, as a person uses it: two files side by side, the line dragged, one of them saved; the
# difference from the reference; a generator's option dragged, and the picture made again by the copied commands; a scene
# with a mesh, of which each file is saved, spoilt and mended. Each step is checked by what must have changed.
# $1: programs, $2: source folder. KEEP=folder keeps the pictures.
set -eu
bin=$1
source=$2
test=cli_window_files
# shellcheck source=tests/window.sh
. "$source/tests/window.sh"

small="--samples 1 --light-grid 8"
"$bin/neph-gauss" -q --count 8 --seed 2 -o a.neph
"$bin/neph-gauss" -q --count 8 --seed 5 -o b.neph
"$bin/neph-gauss" -q --count 30 --max-radius 4 --seed 9 -o c.neph
"$bin/neph-gauss" -q --count 30 --max-radius 4 -o large.neph

# --- two files
# shellcheck disable=SC2086
open a.neph a.neph b.neph --size 400x240 $small
left=150x170+20+10 right=150x170+230+10
shot both
[ "$(convert both.png -format '%[fx:p{200,20}.r>0.85]' info:)" = 1 ] || fail "there is no line between two files"
cp c.neph beside && mv beside b.neph
unlike $right saved both
like $left saved both
drag 200 30 100 30
is_moved() { import -window "$window" moved.png && [ "$(convert moved.png -format '%[fx:p{100,20}.r>0.85]' info:)" = 1 ]; }
until_true 20 is_moved || fail "the line does not follow the mouse"
unlike 80x170+110+10 line both
key x
unlike $right first saved # the first file alone
like 60x170+20+10 first both

# --- the difference: mostly black where the sky is, and gone again, also by a turn of the eye
key r
is_black() { import -window "$window" map.png && [ "$(convert map.png -crop 20x20+5+5 -format '%[fx:mean<0.02]' info:)" = 1 ]; }
until_true 60 is_black || fail "R shows no map of the difference"
xdotool click 4 # nearer
is_sky() { import -window "$window" map.png && [ "$(convert map.png -crop 20x20+5+5 -format '%[fx:mean>0.2]' info:)" = 1 ]; }
until_true 60 is_sky || fail "the map stays when the view has changed"
until_true 60 is_black || fail "the map does not come again"
key r
key Home
like $right back first
quit

# --- a generator: an option dragged, undone, dragged again; what the screenshot's commands make is the screenshot
# shellcheck disable=SC2086
open neph-gauss --make gauss --seed 4 --size 640x300 $small
key Tab
seen=290x260+340+20
shot start
drag 60 223 135 223
at 620 280
unlike $seen more start 0.02
grep -q 'read again' viewer.log || fail "nothing is said of the new cloud: $(cat viewer.log)"
key F12
has_picture() { [ -s neph-gauss-0001.png ]; }
until_true 60 has_picture || fail "F12 wrote no picture: $(ls)"
identify -format '%[nephele]' neph-gauss-0001.png >commands.sh
grep -q '^neph-gauss --max-radius [0-9.]* --seed 4 -o cloud.neph' commands.sh || fail "the commands are: $(cat commands.sh)"
PATH=$bin:$PATH sh -e commands.sh 2>commands.log || fail "the screenshot's commands fail: $(cat commands.log)"
[ "$(compare -metric AE neph-gauss-0001.png cloud.png null: 2>&1)" = 0 ] || fail "the commands draw another picture"
key ctrl+z
like $seen undone start
quit
# The picture is a scene, and its generator is in the panel again, a line lower; the radius goes back to the scene's.
# shellcheck disable=SC2086
open neph-gauss-0001 neph-gauss-0001.png --size 640x300 $small
key Tab
shot scene
drag 135 240 60 240
at 620 280
unlike $seen scene-changed scene 0.02
key ctrl+z
like $seen scene-undone scene
quit

# --- a scene: its own file, a cloud's, a mesh's
printf 'v -2 0 0\nv 2 0 0\nv 2 4 0\nv -2 4 0\nf 1 2 3 4\n' >wall.obj
scene()
{
    cat <<END
{"scene": 1, "clouds": [{"file": "a.neph", "translate": [0, 6, -4]}], "meshes": [{"file": "wall.obj"}],
 "sun": {"azimuth": $1, "height": 40}, "camera": {"eye": [3, 5, 26], "target": [0, 5, 0]}}
END
}
scene 20 >s.json
# shellcheck disable=SC2086
open s.json s.json --ground 0 --size 400x240 $small
all=400x200+0+0 notes=390x90+4+146
shot day
scene 160 >s.json
unlike $all evening day 0.02
cp large.neph a.neph
unlike 200x100+100+10 cloud evening 0.015
printf 'v -2 0 0\nv 9 0 0\nv 9 4 0\nv -2 4 0\nf 1 2 3 4\n' >wall.obj
unlike $all wall cloud 0.02
echo '{"scene": 1, "clouds": [}' >s.json
unlike $notes spoilt wall 0.05
like 400x140+0+0 spoilt wall
scene 160 >s.json
like $all mended wall
mv a.neph away.neph
unlike $notes gone wall 0.05
mv away.neph a.neph
like $all again wall
xdotool windowsize "$window" 1 1
sleep 0.5
xdotool windowsize "$window" 400 240
like $all large wall
# The commands hold what is opaque, too.
key F12
has_scene() { [ -s s-0001.png ]; }
until_true 60 has_scene || fail "F12 wrote no picture of the scene: $(ls)"
identify -format '%[nephele]' s-0001.png >commands.sh
PATH=$bin:$PATH sh -e commands.sh 2>commands.log || fail "the scene's commands fail: $(cat commands.log)"
[ "$(compare -metric AE s-0001.png cloud.png null: 2>&1)" = 0 ] || fail "the scene's commands draw another picture"
quit
