#!/bin/sh
# Typical runs of the programs under valgrind's memcheck: no byte read before it is written, none outside a block, no block
# lost. Some minutes: sh tests/valgrind.sh PROGRAMS SOURCE (Debian: valgrind). Slow, so small; one thread.
# The whole test suite, which takes hours: sh tests/valgrind.sh PROGRAMS SOURCE all [TEST]... (valgrind_all.sh says how)
# What the libraries themselves leave, or read ahead, is named in tests/valgrind.supp, each with its reason.
set -eu
[ "${3:-}" != all ] || exec sh "$2/tests/valgrind_all.sh" "$@"
bin=$(cd "$1" && pwd)
source=$(cd "$2" && pwd)
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
cd "$tmp"
export OMP_NUM_THREADS=1
runs=0
failed=0

run() {
    runs=$((runs + 1))
    code=0
    valgrind --quiet --error-exitcode=99 --leak-check=full --errors-for-leak-kinds=definite --show-leak-kinds=definite \
        --suppressions="$source/tests/valgrind.supp" --log-file=log "$@" > out 2> err || code=$?
    if [ "$code" -ne 0 ]; then
        failed=$((failed + 1))
        echo "valgrind.sh: $*: exit code $code" >&2
        head -n 60 log >&2
        tail -n 3 err >&2
    fi
}

run "$bin/neph-gauss" -q --count 20 -o c.neph --save-scene s.json
run "$bin/neph-gauss" -q --count 8 --model uniform --extinction 2 -o u.neph
run "$bin/neph-gauss" -q --field 3 --count 9 -o f.neph
run "$bin/neph-lsys" -q "$source/examples/spiral.lsys" --iterations 3 -o l.neph
run "$bin/neph-lsys" "$source/examples/spiral.lsys" --iterations 2 --print
run "$bin/neph-meta" -q -o m.neph
run "$bin/neph-layer" -q -o y.neph
run "$bin/neph-mesh" -q "$source/examples/meshes/ngon.obj" --faces 40 -o x.neph
run "$bin/neph-mesh" -q "$source/examples/meshes/mirrored.glb" -o g.neph
run "$bin/neph-edit" -q c.neph l.neph --rotate 10,20,30 --scale 2,1,1 --grow --prune -o e.neph
run "$bin/neph-edit" -q l.neph --simplify 0.2 -o d.neph
run "$bin/neph-info" --json s.json
run "$bin/neph-info" --csv e.neph -o e.csv
for file in c u m y; do
    run "$bin/neph-render" -q $file.neph --size 12x8 --spp 2 --denoise -o $file.exr --resume $file.sums
done
run "$bin/neph-render" -q c.neph --size 12x8 --spp 4 -o c.exr --resume c.sums
for light in single octaves "two-pass --light-resolution 6" "grid --light-resolution 6"; do
    # shellcheck disable=SC2086
    run "$bin/neph-render" -q c.neph --size 12x8 --method march --light $light -o march.png
done
run "$bin/neph-render" -q c.neph --size 8x6 --method paper --light-resolution 4 -o p.pfm
run "$bin/neph-render" -q s.json --size 8x6 --spp 1 --mesh "$source/examples/meshes/ngon.obj" -o o.png
run "$bin/neph-render" --compare c.exr u.exr -o h.png
run "$bin/neph-vdb" -q u.neph --resolution 16 -o u.vdb
run "$bin/neph-vdb" -q c.neph --resolution 16 --half -o c.nvdb
run "$bin/neph-vdb" -q c.neph --resolution 12 -o c.raw
run "$bin/neph-render" -q u.vdb --size 8x6 --spp 1 -o v.png
run "$bin/neph-vdb" -q u.vdb --primitives 2 --cells 16 -o w.neph

# What is refused goes other ways.
refuse() {
    code=0
    runs=$((runs + 1))
    valgrind --quiet --error-exitcode=99 --suppressions="$source/tests/valgrind.supp" --log-file=log "$@" > out 2> err ||
        code=$?
    [ "$code" = 1 ] || {
        failed=$((failed + 1))
        echo "valgrind.sh: $*: exit code $code, not 1" >&2
        head -n 60 log >&2
    }
}
head -c 200 c.neph > cut.neph
head -c 300 c.exr > cut.exr
refuse "$bin/neph-info" cut.neph
refuse "$bin/neph-render" --compare cut.exr c.exr
refuse "$bin/neph-lsys" c.neph
refuse "$bin/neph-mesh" "$source/tests/fuzz/corpus/mesh/total-below-header.glb"
echo "valgrind.sh: $runs runs, $failed with findings"
[ "$failed" = 0 ]
