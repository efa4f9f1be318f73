# neph-view of two files: left of the line is the first one's picture, right of it the second one's, to the bit.
# $1: programs, $2: source folder.
set -eu
bin=$1
source=$2
temporary=$(mktemp -d)
trap 'rm -r "$temporary"' EXIT
cd "$temporary"

fail()
{
    echo "cli_split: $*" >&2
    exit 1
}

"$bin/neph-gauss" -q --count 6 --seed 2 -o a.neph
"$bin/neph-gauss" -q --count 6 --seed 5 -o b.neph
picture() { "$bin/neph-view" "$@" -q --headless --size 40x24 --samples 1 --light-grid 8 --eye 0,2,20 --target 0,3,0; }
picture a.neph -o a.pfm
picture b.neph -o b.pfm
! cmp -s a.pfm b.pfm || fail "the two clouds look alike, so that nothing can be told"

# columns FILE FROM COUNT: those columns of a 40x24 picture, as text
columns() { tail -c $((40 * 24 * 12)) "$1" | od -An -v -tf4 -w12 | awk -v f="$2" -v n="$3" '{ c = (NR - 1) % 40 } c >= f && c < f + n'; }
# same LINE FILE: FILE is a left of column LINE and b right of it
same()
{
    [ "$(columns "$2" 0 "$1")" = "$(columns a.pfm 0 "$1")" ] || fail "left of column $1, $2 is not the first file"
    [ "$(columns "$2" "$1" 40)" = "$(columns b.pfm "$1" 40)" ] || fail "right of column $1, $2 is not the second file"
}
picture a.neph b.neph -o half.pfm
same 20 half.pfm
picture a.neph b.neph --split 0.3 -o third.pfm
same 12 third.pfm
picture a.neph b.neph --split 0 -o none.pfm
same 0 none.pfm
picture a.neph b.neph --split 1 -o all.pfm
cmp a.pfm all.pfm || fail "--split 1 is not the first file alone"
# A scene and a grammar stand beside a .neph, too.
printf '{"scene": 1, "clouds": [{"file": "b.neph"}]}' >b.json
picture a.neph b.json -o scene.pfm
cmp half.pfm scene.pfm || fail "a scene beside a .neph is not its cloud"
picture "$source/examples/spiral.lsys" b.neph -o grammar.pfm
! cmp -s grammar.pfm half.pfm || fail "a grammar beside a .neph is not shown"

# refused WORDS ARGUMENT...
refused()
{
    words=$1 status=0
    shift
    "$bin/neph-view" "$@" >stdout 2>stderr || status=$?
    [ "$status" = 2 ] || fail "neph-view $* ended with $status, not 2: $(cat stderr)"
    grep -q -- "$words" stderr || fail "neph-view $* does not say \"$words\" but: $(cat stderr)"
}
refused "second file" a.neph --split 0.5 --headless -o x.png
refused "one file" a.neph b.neph --bench 2
refused "one file" a.neph b.neph --frames 0 -o x%d.png
refused "one file" a.neph b.neph --headless --error 0.1 -o x.png
refused "save-scene" a.neph b.neph --headless --save-scene x.json -o x.png
refused "standard input" - - --headless -o x.png
refused "one argument too many\|too many" a.neph b.neph a.neph --headless -o x.png
[ -z "$(find . -name 'x*')" ] || fail "a refused command left a file"
