# neph-view's sequences: frame N is the same picture whoever draws it, what is there is left alone, what is not whole is
# drawn anew; and each way of moving moves. $1: programs, $2: source folder.
set -eu
bin=$1
source=$2
temporary=$(mktemp -d)
trap 'rm -r "$temporary"' EXIT
cd "$temporary"

fail()
{
    echo "cli_frames: $*" >&2
    exit 1
}

"$bin/neph-gauss" -q --count 8 -o cloud.neph
# picture ARGUMENT...: draws a small picture of the cloud; frames: pictures of it, two a second
picture() { "$bin/neph-view" cloud.neph -q --size 32x18 --samples 1 --light-grid 8 "$@"; }
frames() { picture --fps 2 "$@"; }
moving="--wind 1,0,0 --shear 0.1 --drift 0,0.5,0 --life 6 --turntable 20 --day 9"

# --- frames are independent: drawn in a row, alone and backwards, each is the same picture
mkdir row alone
# shellcheck disable=SC2086
frames $moving --frames 0..4 -o row/f.%04d.pfm
for i in 4 2 0; do
    # shellcheck disable=SC2086
    frames $moving --frames $i -o alone/f.%04d.pfm
    cmp row/f.000$i.pfm alone/f.000$i.pfm || fail "frame $i alone is not frame $i of a row"
done
[ "$(ls row | tr '\n' ' ')" = "f.0000.pfm f.0001.pfm f.0002.pfm f.0003.pfm f.0004.pfm " ] || fail "made $(ls row)"
cmp -s row/f.0000.pfm row/f.0003.pfm && fail "nothing moves"
# A single picture of the same moment is the same picture.
# shellcheck disable=SC2086
picture $moving --headless --time 1.5 -o row/one.pfm
cmp row/one.pfm row/f.0003.pfm || fail "--time 1.5 is not frame 3 at two frames a second"

# --- restart: whole frames are left alone, half ones and missing ones are drawn
cp row/f.0001.pfm good.pfm
head -c 100 good.pfm >row/f.0001.pfm
rm row/f.0002.pfm
touch -d 2001-01-01 row/f.0000.pfm row/f.0001.pfm
# shellcheck disable=SC2086
frames $moving --frames 0..4 -o row/f.%04d.pfm
cmp good.pfm row/f.0001.pfm || fail "a half frame was left as it was"
[ -s row/f.0002.pfm ] || fail "a missing frame was not drawn"
[ "$(find row -name 'f.*' ! -newermt 2002-01-01)" = row/f.0000.pfm ] || fail "a whole frame was drawn again"
# shellcheck disable=SC2086
frames $moving --frames 0 --overwrite -o row/f.%04d.pfm
[ -z "$(find row ! -newermt 2002-01-01)" ] || fail "--overwrite did not draw the frame again"

# --- each way of moving makes another picture of 3 s, and the same of 0 s
frames --frames 0 -o still.%d.pfm
still=still.0.pfm
for way in "--wind 0.5,0,0" "--shear 0.3" "--drift 0,1,0" "--life 7" "--grow 8" "--decay 1..9" "--turntable 9" \
    "--day 10" "--morph other.neph"; do
    "$bin/neph-gauss" -q --count 5 --seed 9 -o other.neph
    # shellcheck disable=SC2086
    frames $way --frames 6 -o way.%d.pfm --overwrite
    ! cmp -s $still way.6.pfm || fail "$way moves nothing"
done
for way in "--wind 0.5,0,0" "--shear 0.3" "--drift 0,1,0" "--decay 1..9" "--turntable 9"; do
    # shellcheck disable=SC2086
    frames $way --frames 0 -o way.%d.pfm --overwrite
    cmp $still way.0.pfm || fail "$way has moved something before time began"
done

# --- a grammar is drawn as neph-lsys makes it
"$bin/neph-lsys" -q "$source/examples/spiral.lsys" --seed 3 -o spiral.neph
small="-q --headless --size 32x18 --samples 1 --light-grid 8 --seed 3"
# shellcheck disable=SC2086
"$bin/neph-view" spiral.neph $small -o a.pfm
# shellcheck disable=SC2086
"$bin/neph-view" "$source/examples/spiral.lsys" $small -o b.pfm
cmp a.pfm b.pfm || fail "a grammar is not shown as the cloud that neph-lsys makes of it"
# shellcheck disable=SC2086
"$bin/neph-view" - $small -o b.pfm <"$source/examples/spiral.lsys"
cmp a.pfm b.pfm || fail "a grammar from standard input is not shown as the cloud that neph-lsys makes of it"

# --- alpha: clear where there is sky, what is seen is the same; the corner of a picture that frames a cloud is sky
picture --headless --alpha -o alpha.png
[ "$(identify -format '%[channels]' alpha.png)" = srgba ] || fail "--alpha wrote a picture without alpha"
[ "$(convert alpha.png -format '%[fx:p{0,0}.a]' info:)" = 0 ] || fail "the sky is not clear in an alpha picture"
awk "BEGIN { exit !($(convert alpha.png -alpha extract -format '%[fx:maxima]' info:) > 0.5) }" || fail "all is clear"

# --- mistakes
# refused CODE WORDS ARGUMENT...
refused()
{
    code=$1 words=$2 status=0
    shift 2
    picture "$@" >stdout 2>stderr || status=$?
    [ "$status" = "$code" ] || fail "neph-view $* ended with $status, not $code: $(cat stderr)"
    [ "$(wc -l <stderr)" = 1 ] || fail "neph-view $* wrote more or less than one line: $(cat stderr)"
    grep -q -- "$words" stderr || fail "neph-view $* does not say \"$words\" but: $(cat stderr)"
}
refused 2 "%04d" --frames 0..1 -o x.png
refused 2 "%04d" --frames 0..1 -o x%s.png
refused 2 "%04d" --frames 0..1 -o x%d%d.png
refused 2 "%04d" --frames 0..1 -o x%99d.png
refused 2 "%04d" --frames 0..1
refused 2 jpg --frames 0..1 -o x%d.jpg
refused 2 whole --frames 0.5 -o x%d.png
refused 2 backwards --frames 3..1 -o x%d.png
refused 2 "fps" --frames 0..1 --fps 0 -o x%d.png
refused 2 "overwrite" --headless --overwrite -o x.png
refused 2 "decay" --headless --decay 3 -o x.png
refused 2 alpha --headless --alpha -o x.pfm
refused 1 no-such --headless --morph no-such.neph -o x.png
"$bin/neph-meta" -q -o meta.neph
refused 1 models --headless --morph meta.neph -o x.png
printf 'axiom X\nX -> X ]\niterations five\n' >bad.lsys
status=0
"$bin/neph-view" bad.lsys -q --headless --size 8x8 -o x.png 2>stderr || status=$?
[ "$status" = 1 ] || fail "a wrong grammar ended with $status"
[ "$(grep -c '^neph-view: bad.lsys:[23]:[0-9]*: ' stderr)" = 2 ] || fail "two mistakes, but: $(cat stderr)"
[ -z "$(find . -name 'x*')" ] || fail "a failed command left a picture"
