# neph-view's window as a person uses it, on a screen of its own (Xvfb): into the cloud and out again, round it, back; the
# panel, a slider, undo; the grammar edited with a mistake and mended, half-written, gone; a screenshot, remade by the
# commands that it holds; a window of one pixel, a window that is put away. Each step is checked by what must have
# changed. $1: programs, $2: source folder. KEEP=folder keeps the pictures.
set -eu
bin=$1
source=$2
test=cli_window
. "$source/tests/window.sh"

# A small heap of spheres, so that each step is quick.
grammar()
{
    cat <<END
axiom X
iterations 6
angle $1
extinction 12
X -> X [ +($1) X ] [ -($1) X ]
END
}
grammar 30 >heap.lsys
cp heap.lsys good.lsys
open heap.lsys heap.lsys --size 560x360 --samples 2 --light-grid 8

# What is under the panel, and what is not: the panel is 318 pixels wide, messages stand below.
cloud=180x260+370+20
panel=300x280+10+30
notes=540x90+6+265
corner=50x30+490+324

# --- the eye
at 460 150
shot first
[ "$(identify -format %k first.png)" -gt 500 ] || fail "the first picture shows next to nothing"
xdotool click --repeat 12 --delay 5 4
unlike $cloud inside first
key Home
like $cloud home first
at 400 100 mousedown 1 mousemove --window "$window" 440 120 mousemove --window "$window" 520 140 mouseup 1
unlike $cloud orbited first
key Home
like $cloud home first

# --- the panel, a slider, undo
key Tab
unlike $panel open first 0.1
like $cloud open first
# The sun's azimuth: the slider's place in the panel, counted from the sections above it. The mouse then goes, and the
# slider's help with it.
drag 135 269 40 269
at 540 340
unlike $cloud turned first
key ctrl+z
like $cloud undone first
key ctrl+shift+z
unlike $cloud redone first
at 120 269 click 3
at 540 340
like $cloud reset first
key Tab
like $panel folded first
key h
unlike 300x200+130+80 help first 0.1
key h
like 300x200+130+80 helped first

# --- the file
mistake()
{
    grammar 30 | sed 's/iterations 6/iterations six/'
}
mistake >heap.lsys
unlike $corner mistake first
like $cloud mistake first # the last good cloud stays
grammar 75 >heap.lsys
unlike $cloud mended first
like $corner mended first # the mistake is no longer shown
grep -q 'heap.lsys: read again, shown after [0-9]* ms' viewer.log || fail "nothing is said of the new cloud: $(cat viewer.log)"
# Half a file is not read, though it would be a grammar of its own, until its writer has closed it.
exec 5>heap.lsys
printf 'axiom X\niterations 0\n' >&5
sleep 1.5
like $cloud half mended
printf 'angle 30\nextinction 12\n' >&5
exec 5>&-
unlike $cloud written mended 0.015
# An editor that writes beside the file and renames.
cp good.lsys beside
mv beside heap.lsys
like $cloud renamed first
mv heap.lsys away.lsys
unlike $notes vanished first 0.02
like $cloud vanished first
mv away.lsys heap.lsys
like $notes back first

# --- split, wires and heat
key x
is_split() { import -window "$window" split.png && [ "$(convert split.png -format '%[fx:p{280,20}.r>0.85]' info:)" = 1 ]; }
until_true 20 is_split || fail "there is no line between two methods"
drag 280 30 420 30
is_moved() { import -window "$window" split.png && [ "$(convert split.png -format '%[fx:p{420,20}.r>0.85]' info:)" = 1 ]; }
until_true 20 is_moved || fail "the line does not follow the mouse"
key x
like $cloud whole first
key b
unlike $cloud boxes first 0.005
key b
key t
unlike $cloud heat first 0.1
key t t t t
like $cloud cold first

# --- a screenshot, and the same picture by the commands that it holds
key F12
has_picture() { [ -s heap-0001.png ]; }
until_true 60 has_picture || fail "F12 wrote no picture"
[ "$(identify -format '%m %wx%h' heap-0001.png)" = "PNG 560x360" ] || fail "the screenshot is $(identify heap-0001.png)"
identify -format '%[nephele]' heap-0001.png >commands.sh
grep -q '^neph-lsys heap.lsys' commands.sh || fail "the screenshot holds no commands: $(cat commands.sh)"
PATH=$bin:$PATH sh -e commands.sh 2>commands.log || fail "the screenshot's commands fail: $(cat commands.log)"
[ "$(compare -metric AE heap-0001.png cloud.png null: 2>&1)" = 0 ] || fail "the commands draw another picture"

# --- the window: one pixel, and put away
xdotool windowsize "$window" 1 1
sleep 0.5
xdotool windowsize "$window" 560 360
like $cloud large first
xdotool windowunmap "$window"
sleep 0.5
xdotool windowmap "$window"
like $cloud mapped first

quit
