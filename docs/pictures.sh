#!/bin/sh
# Makes the pictures of the documents anew, but for those whose command stands beside them in a page. What they show is
# taken from the pages, where they have it.
#
#     sh docs/pictures.sh build/release/bin                   # all but those marked; some seconds each
#     sh docs/pictures.sh build/release/bin grammar/tree      # some, by name
#     sh docs/pictures.sh --list                              # each picture and its command
#
# Pictures marked "!" are made only when they are named: they need Blender, another build, or many minutes. Contact
# sheets are put together by ImageMagick (Debian: imagemagick).
set -eu

# Picture | command. $out is the picture; the functions are below.
table() {
    cat <<'END'
castellanus | neph-lsys -q examples/castellanus.lsys --g 0.5 | neph-render -q - --size 800x400 --spp 96 --denoise --eye -1,-1.5,47 --target -1,3.3,0 --fov 22 --sun 90,40 --exposure 0.1 -o "$out"
grammar/levels | sheet grammar paper.lsys "--iterations 2" "--iterations 4" "--iterations 7"
grammar/angle | sheet grammar paper.lsys "--angle 10" "--angle 40" "--angle 50..100"
grammar/radius | sheet grammar paper.lsys "--iterations 5" "--iterations 5 --radius 0.4..1.6" "--iterations 5 --length 1.9"
grammar/model | cloud=1 sheet grammar heap.lsys "--model uniform" "--model spheroid" "--model metaball"
grammar/kappa | cloud=1 sheet grammar heap.lsys "--kappa 0" "--kappa 0.5" "--kappa 1"
grammar/noise | cloud=1 sheet grammar heap.lsys "--noise-scale 0.15" "--noise-scale 0.4" "--noise-scale 1"
grammar/detail | cloud=1 sheet grammar heap.lsys "--model uniform --displace 0.5" "--model uniform --billow 0.8" "--model uniform --wisp 0.8"
grammar/steps | sheet grammar steps.lsys ""
grammar/turns | one grammar turns.lsys a.png; turn="0,-70,0" one grammar pitch.lsys b.png; turn="50,0,0" one grammar roll.lsys c.png; join
grammar/state | one grammar brackets.lsys a.png; one grammar factor.lsys b.png; one grammar stretch.lsys c.png; join
grammar/tree | for n in 2 3 4; do edit="s/A(1, 4)/A(1, $n)/" one grammar tree.lsys $n.png; done; join
grammar/chance | sheet grammar chance.lsys "--seed 1" "--seed 2" "--seed 3"
grammar/shrink | sheet grammar shrink.lsys "--shrink 1" "" "--shrink 0.7..1.1"
grammar/expressions | one grammar wave.lsys a.png; one grammar ragged.lsys b.png; join
grammar/refine | sheet grammar refine.lsys "--iterations 2" "--iterations 3" "--iterations 4"
tutorial/1 | step 1
tutorial/2 | step 2
tutorial/3 | step 3
tutorial/4 | step 4
tutorial/5 | step 5
tutorial/6 | step 6
tutorial/7 | step 7
! tutorial/blender | blend castle "--eye 0,0,60 --target 0,2.4,0 --fov 16 --sun 55,40 --sky 0.1,0.2,0.4 --size 320x160 --samples 96"
! viewer-methods | methods cumulus mesh
viewer-models | models "--light grid" "--light octaves" "--light single --exposure 1.5" "--light powder --powder 1 --exposure 1.5" "--light single --ambient 0.1,0.13,0.2" "--sun 100,6 --sun-irradiance 0.5,0.25,0.15 --sky 0.03,0.045,0.09 --emission 0.7,0.22,0.05"
! chart | neph-chart -q --size 320x180 --runs 3 examples/scenes/bench/cumulus.json -o "$work/chart" && cp "$work/chart/chart.png" "$out"
! series | neph-chart -q --appendix --size 160x90 --runs 3 examples/scenes/bench/cumulus.json -o "$work/series" && cp "$work/series/series.png" "$out"
! growth | sh tests/bench/run.sh build/bench/bin "$work/growth" && cp "$work/growth/growth.png" "$out"
! convergence | build/bench/tests/bench/bench_convergence >"$work/convergence.csv" && gnuplot -c docs/convergence.gp "$work/convergence.csv" "$out"
! vdb-cycles | cycles
END
    awk '/^## / { print "! gallery/" $2 " | sh examples/gallery/make.sh \"$bin\" docs/gallery " $2 }' "$root/examples/gallery/clouds.txt"
}

# One picture, FILE, of the COUNTth block of a page by that name. Set before it: cloud=1, as the grammar has it (else its
# puffs are plain balls); turn=X,Y,Z, degrees; edit, for sed; count; size; view, options of neph-render.
one() { # page, block, FILE, [options of neph-lsys]
    awk -v name="$2" -v count="${count:-1}" -f "$root/docs/block.awk" "$root/docs/$1.md" | sed "${edit:-}" >"$work/$2"
    look="--model uniform --extinction 20 --g 0"
    [ -z "${cloud:-}" ] || look=""
    # The options are several words.
    # shellcheck disable=SC2086
    neph-lsys -q "$work/$2" $look ${4:-} | neph-edit -q - --rotate "${turn:-0,0,0}" -o "$work/one.neph" || exit 1
    # shellcheck disable=SC2046,SC2086
    neph-render -q "$work/one.neph" --size "${size:-160x120}" --spp 32 --denoise ${view:-$(in_front "$work/one.neph")} \
        --sun 55,40 --exposure 0.1 -o "$work/$3" || exit 1
}

# An eye on +z that has all of a cloud in a picture of 4 to 3 with a vertical field of view of 20 degrees.
in_front() {
    neph-info --json "$1" | tr -d '[]"' | awk -F '[:,]' '$1 ~ /bounds/ {
        for (i = 2; i <= 7; i++) b[i] = $i
        wide = (b[5] - b[2]) * 3 / 4; high = b[6] - b[3]; side = wide > high ? wide : high
        x = (b[2] + b[5]) / 2; y = (b[3] + b[6]) / 2
        printf "--fov 20 --eye %f,%f,%f --target %f,%f,%f", x, y - side / 4, b[7] + 1.15 * side / 2 / 0.1763, x, y, (b[4] + b[7]) / 2 }'
}

# The picture of a step of the tutorial: the same view for all that are castles.
step() {
    export cloud=1 count="$1" size=320x160
    [ "$1" = 1 ] || export view="--eye 0,0,60 --target 0,2.4,0 --fov 16"
    one tutorial castle.lsys one.png "--seed 2"
    cp "$work/one.png" "$out"
}

# The castle of the tutorial in Blender, as its page has it.
blend() { # name, options of import_vdb.py
    awk -v name="$1.lsys" -v count=7 -f docs/block.awk docs/tutorial.md >"$work/$1.lsys"
    neph-lsys -q "$work/$1.lsys" --seed 2 | neph-vdb -q - -o "$work/$1.vdb" || exit 1
    # shellcheck disable=SC2086
    blender -b --python-exit-code 1 --python examples/blender/import_vdb.py -- "$work/$1.vdb" $2 --render "$out"
}

# Scenes of the yardstick, a row each: the viewer's methods and the reference (docs/benchmarks.md).
methods() {
    for scene in "$@"; do
        for method in paper exact default; do
            neph-view "examples/scenes/bench/$scene.json" --headless --size 400x225 --samples 16 --method "$method" \
                -o "$work/$method.png" || exit 1
        done
        neph-render -q "examples/scenes/bench/$scene.json" --size 400x225 --spp 64 --denoise -o "$work/reference.png" || exit 1
        convert "$work/paper.png" "$work/exact.png" "$work/default.png" "$work/reference.png" +append "png:$work/$scene.row"
    done
    # shellcheck disable=SC2046
    (cd "$work" && convert $(printf 'png:%s.row ' "$@") -append -define png:exclude-chunks=date,time "$out")
}

# A congestus by what neph-view can light it with, side by side.
models() { # options of neph-view, a picture each
    neph-gauss -q --preset congestus --seed 2 --extinction 8 --g 0.2 -o "$work/congestus.neph" || exit 1
    row=""
    for options in "$@"; do
        picture="$work/model$(printf '%s' "$options" | tr -c 'a-z' _).png"
        # shellcheck disable=SC2086
        neph-view -q "$work/congestus.neph" --headless --size 200x240 --samples 8 --eye 0,0.1,55.2 --target 0,7.8,0.3 --fov 24 \
            --sun 60,35 $options -o "$picture" || exit 1
        row="$row $picture"
    done
    # shellcheck disable=SC2086
    convert $row +append -define png:exclude-chunks=date,time "$out"
}

# Cycles beside our reference, by the commands of docs/vdb.md.
cycles() {
    view="--eye 0,2,24 --target -0.5,0.8,0 --fov 38 --sun 60,40 --sky 0.2,0.3,0.5 --size 320x180"
    neph-gauss -q --g 0.3 -o "$work/cumulus.neph"
    neph-vdb -q "$work/cumulus.neph" --resolution 256 -o "$work/cumulus.vdb" || exit 1
    # shellcheck disable=SC2086
    blender -b --python-exit-code 1 --python examples/blender/import_vdb.py -- "$work/cumulus.vdb" $view --samples 128 \
        --render "$work/cycles.exr" || exit 1
    # shellcheck disable=SC2086
    neph-render -q "$work/cumulus.neph" $view --spp 128 -o "$work/ours.pfm" || exit 1
    blender -b --python-exit-code 1 --python examples/blender/side_by_side.py -- "$out" "$work/cycles.exr" "$work/ours.pfm"
}

# A row of pictures of one block, by other options each.
sheet() { # page, block, options...
    page=$1 block=$2 number=0
    shift 2
    for options in "$@"; do
        number=$((number + 1))
        one "$page" "$block" "$number.png" "$options"
    done
    join
}

# The pictures made so far, beside one another.
join() {
    convert "$work"/*.png -bordercolor white -border 1 +append -define png:exclude-chunks=date,time "$out"
}

root=$(CDPATH='' cd -- "$(dirname -- "$0")/.." && pwd)
if [ "${1:-}" = --list ]; then
    table | sed 's|^!* *\([^ ]*\) [|] |docs/\1.png\t|'
    exit 0
fi
if [ $# -lt 1 ] || [ ! -x "$1/neph-render" ]; then
    echo "usage: sh docs/pictures.sh FOLDER-OF-PROGRAMS [NAME]... | --list" >&2
    exit 2
fi
bin=$(cd "$1" && pwd)
PATH=$bin:$PATH
shift
names=" $* "
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$root"
table >"$work/table"
while read -r line; do
    name=${line#! }
    name=${name%% | *}
    case $names in
    "  ") [ "${line#!}" = "$line" ] || continue ;;
    *" $name "*) ;;
    *) continue ;;
    esac
    out=$root/docs/$name.png
    mkdir -p "$(dirname "$out")"
    rm -f "$work"/*.png
    (eval "${line#* | }") </dev/null || { echo "pictures.sh: docs/$name.png was not made" >&2; exit 1; }
    echo "docs/$name.png"
done <"$work/table"
