# Memory that runs out, program by program: the n-th allocation of a typical run fails, whoever asks for it, libraries too.
# The program ends with exit code 0 (it could do without) or 1 and says so; no crash, no hang, no part of a file, nothing
# left. $1: programs, $2: source folder, $3: how many n a program are tried, spread evenly (12); "all": every one;
# $4: only the run of that name (such as "fit"), $5: from that n on.
set -eu
bin=$(cd "$1" && pwd)
source=$(cd "$2" && pwd)
tries=${3:-12}
only=${4:-}
from=${5:-0}
most=
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
cd "$tmp"
export OMP_NUM_THREADS=1

fail() {
    echo "cli_memory: $1" >&2
    [ ! -s err ] || head -n 5 err | sed 's/^/    /' >&2
    exit 1
}
cc -shared -fPIC -O1 -o failing.so "$source/tests/failing_malloc.c" -ldl || fail "the preloaded library does not build"
# Sanitizers have an allocator of their own, below which none can be put.
if grep -q __asan_init "$bin/neph-gauss"; then
    echo "cli_memory: left out, the programs have a sanitizer's allocator"
    exit 0
fi
# gcov's own end of a program takes memory, and does not look whether there was any.
if grep -q __gcov_dump "$bin/neph-gauss"; then
    echo "cli_memory: left out, the programs are counted by gcov"
    exit 0
fi

ran=
mkdir in
"$bin/neph-gauss" -q --count 6 -o in/c.neph
"$bin/neph-render" -q in/c.neph --size 8x6 --spp 2 -o in/a.exr
"$bin/neph-render" -q in/c.neph --size 8x6 --spp 2 -o in/a.png
"$bin/neph-vdb" -q in/c.neph --resolution 16 -o in/c.vdb
"$bin/neph-gauss" -q --count 6 -o in/d.neph --save-scene in/s.json
printf 'axiom X\niterations 3\nX -> X + Y\nY -> X & Y\n' > in/g.lsys

# check NAME: how a run ended, by $code, out/ and err.
check() {
    case $code in
    0) ;;
    1)
        [ -s err ] || fail "$1: ended with 1 and without a word"
        # What is written before the last file may be there, whole.
        left=$(ls out | grep -Evx 'first[.].*|sums' || true)
        [ -z "$left" ] || fail "$1: failed, and left $left"
        ;;
    127) # glibc's loader, which brings OpenVDB late, ends a program so and cannot be asked not to
        grep -qxE 'out of memory|cannot allocate memory for thread-local data: ABORT' err || fail "$1: exit code 127"
        [ -z "$(ls out | grep -Evx 'first[.].*|sums')" ] || fail "$1: the loader failed, and a file was left"
        ;;
    *) fail "$1: exit code $code" ;;
    esac
}

# each NAME COMMAND...: the command, which writes into out/, with each allocation failing once.
each() {
    name=$1
    shift
    [ "$only" = "" ] || [ "$only" = "$name" ] || return 0
    ran=1
    rm -rf out
    mkdir out
    code=0
    NEPHELE_COUNT=$tmp/count LD_PRELOAD=$tmp/failing.so "$@" > /dev/null 2> err || code=$?
    [ "$code" = 0 ] || fail "$name: fails with all memory there"
    count=$(cat count)
    [ "$count" -ge 10 ] || fail "$name: asks for memory $count times only"
    many=$tries
    [ "$tries" != all ] || many=$count
    [ -z "$most" ] || [ "$many" -le "$most" ] || many=$most
    step=$(((count + many - 1) / many))
    n=$from
    failures=0
    while [ "$n" -lt "$count" ]; do
        rm -rf out
        mkdir out
        code=0
        NEPHELE_FAIL=$n LD_PRELOAD=$tmp/failing.so timeout 60 "$@" > /dev/null 2> err || code=$?
        check "$name, allocation $n of $count"
        failures=$((failures + (code > 0)))
        n=$((n + step))
    done
    [ "$failures" -gt 0 ] || fail "$name: no allocation of $count made it fail"
    echo "$name: $count allocations, every $step from $from on tried, $failures made it end with 1"
}

each gauss "$bin/neph-gauss" --count 6 -o out/first.neph --save-scene out/s.json
each lsys "$bin/neph-lsys" in/g.lsys -o out/x.neph
each meta "$bin/neph-meta" -o out/x.neph
each layer "$bin/neph-layer" -o out/x.neph
each edit "$bin/neph-edit" in/c.neph --scale 2,2,2 --prune -o out/x.neph
each info "$bin/neph-info" --json in/c.neph -o out/x.json
each mesh "$bin/neph-mesh" "$source/examples/meshes/ngon.obj" --faces 20 -o out/x.neph
each gltf "$bin/neph-mesh" "$source/examples/meshes/ngon.gltf" -o out/x.neph
each scene "$bin/neph-info" in/s.json -o out/x.txt
each reference "$bin/neph-render" in/c.neph --size 8x6 --spp 2 --denoise -o out/x.exr --resume out/sums
each march "$bin/neph-render" in/c.neph --size 8x6 --method march --light-resolution 4 -o out/x.png
each compare "$bin/neph-render" --compare in/a.exr in/a.png -o out/first.pfm
each volume "$bin/neph-render" in/c.vdb --size 8x6 --spp 1 -o out/x.png
each vdb "$bin/neph-vdb" in/c.neph --resolution 16 -o out/x.vdb
each fit "$bin/neph-vdb" in/c.vdb --primitives 2 --cells 16 -o out/first.neph

# What only the program's own code asks for, where a graphics driver asks too; of all of it, 400 each: a run takes a second.
export NEPHELE_OWN=1
most=400
"$bin/neph-gauss" -q --count 12 --sigma 6,0.1,0.1 --max-radius 0.5 --no-hollow --no-prune -o in/thin.neph
each view "$bin/neph-view" in/c.neph --headless --size 16x9 --samples 1 --light-grid 4 -o out/x.png
each chart "$bin/neph-chart" --quick --size 16x9 --runs 1 --reference-noise 2 in/thin.neph -o out/first.chart
[ -n "$ran" ] || fail "no run is named $only"
