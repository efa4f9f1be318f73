# neph-view of two files: left of the line is the first one's picture, right of it the second one's, to the bit. And
# pictures that are drawn in parts: the same as those drawn at once.
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

# --- in parts of 32 pixels, with something opaque in them
printf 'v -3 0 2\nv 3 0 2\nv 0 6 2\nf 1 2 3\n' >wall.obj
large() { picture a.neph --size 100x70 --mesh wall.obj --ground -1 "$@"; }
large -o once.pfm
large --largest 32 -o parts.pfm
"$bin/neph-render" --compare once.pfm parts.pfm --tolerance 1e-6 >/dev/null || fail "a picture in parts is another one"
picture a.neph --size 100x70 -o bare.pfm
! "$bin/neph-render" --compare once.pfm bare.pfm --tolerance 1e-3 >/dev/null 2>&1 || fail "--mesh and --ground show nothing"

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
refused "largest" a.neph --largest 8 --headless -o x.png
refused "at once" a.neph --largest 64 --bench 2
refused "takes no file" --make gauss a.neph --headless -o x.png
refused "is missing" --headless -o x.png
refused "2018" a.neph --ground 0 --method paper --headless -o x.png
refused "needs --ground" a.neph --ground-colour 1,1,1 --headless -o x.png
refused "one file" a.neph b.neph --frames 0 -o x%d.png
refused "one file" a.neph b.neph --headless --error 0.1 -o x.png
refused "standard input" - - --headless -o x.png
refused "one argument too many\|too many" a.neph b.neph a.neph --headless -o x.png

# --- a scene of both: the second is what it is compared with
picture a.neph b.neph --split 0.3 -o a.pfm --save-scene two.json
"$bin/neph-view" -q two.json --headless -o b.pfm
cmp a.pfm b.pfm || fail "the scene of two files is another picture: $(cat two.json)"

# --- generators: what the window starts with is what their programs make
"$bin/neph-gauss" -q --seed 7 -o gauss.neph
"$bin/neph-mesh" -q wall.obj -o mesh.neph
picture gauss.neph --seed 7 -o a.pfm # the seed is that of the rays, too
picture --make gauss --seed 7 -o b.pfm
cmp a.pfm b.pfm || fail "--make gauss is not the cloud that neph-gauss makes"
picture mesh.neph -o a.pfm
picture wall.obj -o b.pfm
cmp a.pfm b.pfm || fail "a mesh is not shown as the cloud that neph-mesh makes of it"
echo "no mesh" >bad.obj
status=0
"$bin/neph-view" bad.obj -q --headless -o x.png 2>stderr || status=$?
[ "$status" = 1 ] && grep -q "bad.obj" stderr || fail "a wrong mesh ended with $status: $(cat stderr)"
[ -z "$(find . -name 'x*')" ] || fail "a refused command left a file"
