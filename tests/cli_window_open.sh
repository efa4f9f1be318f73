# Files that come into neph-view's window while it is open: dropped on it, good ones and one with mistakes, a file and one after
# it at once; a screenshot as EXR from the panel, dropped as the scene that it holds. $1: programs, $2: source folder.
# KEEP=folder keeps the pictures.
set -eu
bin=$1
source=$2
test=cli_window_open
# shellcheck source=tests/window.sh
. "$source/tests/window.sh"
cc -std=c17 -D_GNU_SOURCE -O1 -o drop_file "$source/tests/drop_file.c" -lX11 || fail "the sender of drops does not build"

small="--samples 1 --light-grid 6"
"$bin/neph-gauss" -q --count 6 --seed 2 -o a.neph
"$bin/neph-gauss" -q --count 30 --max-radius 4 --seed 5 -o b.neph
echo 'axiom' >wrong.lsys
"$bin/neph-gauss" -q --count 9 --seed 9 -o c.neph
clouds=400x180+350+10

titled() { xdotool getwindowname "$window" | grep -q "^$1 "; }
drop() { timeout 70 ./drop_file "$window" "$1" || fail "nobody takes $1 ($?): $(cat viewer.log)"; }

# shellcheck disable=SC2086
open a.neph a.neph --size 760x400 $small
shot first
drop b.neph
until_true 30 titled "$PWD/b.neph" || fail "a dropped file is not opened: $(xdotool getwindowname "$window")"
unlike $clouds second first 0.01

# --- a mistake: told, and what was there stays
drop wrong.lsys
until_true 30 titled "$PWD/b.neph" || fail "a file with mistakes takes the place of a good one"
shot wrong
unlike 400x60+330+330 wrong second 0.02
like 400x180+350+10 stays second

# --- one after the other at once: the last one counts
drop c.neph
drop a.neph
until_true 30 titled "$PWD/a.neph" || fail "the last of two dropped files is not opened: $(xdotool getwindowname "$window")"

# --- the panel: brighter, then a screenshot as EXR
fold 62 85 108 177 246
key plus plus
press 147 338 # EXR
shot bright
press 72 361 # screenshot
has_picture() { [ -s a-0001.exr ]; }
until_true 60 has_picture || fail "the panel writes no EXR: $(ls; cat viewer.log)"
key Tab
unlike $clouds bright first 0.02

# --- which is a scene: dropped, and opened anew, it looks the same; drawn without a window it is the same
drop b.neph
until_true 30 titled "$PWD/b.neph" || fail "a dropped file is not opened"
shot between
drop a-0001.exr
until_true 30 titled "$PWD/a-0001.exr" || fail "a picture is not opened as a scene: $(cat viewer.log)"
like $clouds scene bright
quit
"$bin/neph-view" -q a-0001.exr --headless -o again.exr || fail "an EXR of the window is no scene"
"$bin/neph-render" -q --compare a-0001.exr again.exr --tolerance 0 >/dev/null || fail "the EXR's scene is another picture"
