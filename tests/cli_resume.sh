# neph-render --resume: a picture that was interrupted, by less --spp or by kill -9, and gone on with, with other threads
# too, is bit for bit the one that was not. What is of another picture, damaged, or further than asked for is refused, and
# stays as it was. $1: programs, $2: source folder.
set -eu
bin=$(cd "$1" && pwd)
source=$(cd "$2" && pwd)
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cd "$dir"

fail() {
    echo "cli_resume: $1" >&2
    [ ! -s err ] || sed 's/^/    /' err >&2
    exit 1
}
# refused CODE TEXT COMMAND...: that exit code and one line that holds TEXT.
refused() {
    wanted=$1
    text=$2
    shift 2
    code=0
    "$@" > out 2> err || code=$?
    [ "$code" = "$wanted" ] || fail "$*: exit code $code, not $wanted"
    [ "$(wc -l < err)" = 1 ] || fail "$*: not one line"
    grep -q -e "$text" err || fail "$*: does not say \"$text\""
}
render() { "$bin/neph-render" c.neph --size 64x36 "$@" 2> err || fail "neph-render $* failed"; }

"$bin/neph-gauss" -q --count 8 --extinction 6 -o c.neph
render -q --spp 50 -o whole.exr

# In pieces that are no whole passes, and by other numbers of threads.
OMP_NUM_THREADS=1 render -q --spp 7 -o part.exr --resume s
cmp -s part.exr whole.exr && fail "7 paths make the picture of 50"
OMP_NUM_THREADS=3 render --spp 29 -o part.exr --resume s
grep -q "s: goes on from 7 paths" err || fail "29 paths began anew"
render -q --spp 50 -o pieces.exr --resume s
cmp -s whole.exr pieces.exr || fail "a picture in pieces is another one"
rm pieces.exr
render -q --spp 50 -o pieces.exr --resume s --sun 60,40 # what is done already, with a default written out
cmp -s whole.exr pieces.exr || fail "a picture taken from the sums alone is another one"

# Stopping by noise, from a state between two looks at it.
render -q --noise 0.2 -o noise.exr --stats > noise.json
render -q --spp 5 -o part.exr --resume n
render -q --noise 0.2 -o again.exr --stats --resume n > again.json
cmp -s noise.exr again.exr || fail "--noise stops elsewhere: $(grep spp noise.json again.json)"
render -q --noise 0.2 -o again.exr --resume n
cmp -s noise.exr again.exr || fail "--noise goes on where it had stopped"

# Killed ever later, until a run ends before it is; every pass is kept.
rounds=0
while :; do
    rounds=$((rounds + 1))
    [ $rounds -lt 100 ] || fail "100 kills, and no end"
    "$bin/neph-render" c.neph --size 64x36 --spp 300 -o killed.exr --resume k --resume-every 0 2>> said &
    process=$!
    sleep "$((rounds / 5)).$((rounds % 5 * 2))"
    kill -9 $process 2> /dev/null || true
    wait $process 2> /dev/null && break
    [ ! -e killed.exr ] || fail "a killed program left a picture"
done
grep -q "goes on from" said || fail "no kill came between two passes"
render -q --spp 300 -o whole300.exr
cmp -s whole300.exr killed.exr || fail "a killed picture, gone on with, is another one"

# Other pictures, damage, too few paths: refused, and the file stays.
cp s before
refused 1 "of another picture" "$bin/neph-render" -q c.neph --size 64x36 --spp 60 --seed 2 -o x.exr --resume s
refused 1 "of another picture" "$bin/neph-render" -q c.neph --size 64x35 --spp 60 -o x.exr --resume s
refused 1 "of another picture" "$bin/neph-render" -q c.neph --size 64x36 --spp 60 --sun-angle 2 -o x.exr --resume s
refused 1 "of another picture" "$bin/neph-render" -q c.neph --size 64x36 --spp 60 --sky none -o x.exr --resume s
refused 1 "of another picture" "$bin/neph-render" -q c.neph --size 64x36 --spp 60 -o x.exr --resume s \
    --mesh "$source/examples/meshes/suzanne.ply"
"$bin/neph-edit" -q c.neph --translate 0,0,1e-3 -o moved.neph
refused 1 "of another picture" "$bin/neph-render" -q moved.neph --size 64x36 --spp 60 -o x.exr --resume s
refused 1 "has 50 paths a pixel" "$bin/neph-render" -q c.neph --size 64x36 --spp 49 -o x.exr --resume s
cmp -s before s || fail "a refused command changed the file"
head -c 5000 before > cut
refused 1 "damaged" "$bin/neph-render" -q c.neph --size 64x36 --spp 60 -o x.exr --resume cut
{ head -c 4000 before; printf '\377'; tail -c +4002 before; } > flipped
refused 1 "damaged" "$bin/neph-render" -q c.neph --size 64x36 --spp 60 -o x.exr --resume flipped
refused 1 "not what --resume keeps" "$bin/neph-render" -q c.neph --size 64x36 -o x.exr --resume c.neph
refused 1 "cannot" "$bin/neph-render" -q c.neph --size 64x36 -o x.exr --resume absent/s
refused 2 "belongs to --method reference" "$bin/neph-render" -q c.neph --method march -o x.exr --resume s
refused 2 "needs --resume" "$bin/neph-render" -q c.neph -o x.exr --resume-every 3
[ ! -e x.exr ] || fail "a refused command left a picture"

# Volumes and meshes are told apart, too.
fog=$source/tests/frozen/vdb/fog.vdb
volume="--size 32x18 --extinction 1"
"$bin/neph-render" -q "$fog" $volume --spp 20 -o fog.exr
"$bin/neph-render" -q "$fog" $volume --spp 9 -o part.exr --resume v
refused 1 "of another picture" "$bin/neph-render" -q "$fog" $volume --spp 20 --density-gain 2 -o x.exr --resume v
"$bin/neph-render" -q "$fog" $volume --spp 20 -o again.exr --resume v
cmp -s fog.exr again.exr || fail "a volume in pieces is another picture"
mesh="--mesh $source/examples/meshes/suzanne.ply"
render -q $mesh --spp 4 -o part.exr --resume m
refused 1 "of another picture" "$bin/neph-render" -q c.neph --size 64x36 $mesh --mesh-colour 0.1,0.5,0.5 --spp 8 -o x.exr --resume m
