#!/bin/sh
# Makes the pictures of docs/gallery.md by the commands of the table below, and prints for each its name, the
# primitives and bytes of its .neph, and the seconds that making and drawing it took, with tabs between.
#
#     sh examples/gallery/make.sh build/release/bin docs/gallery            # all
#     sh examples/gallery/make.sh build/release/bin docs/gallery tower fog  # some
#
# Only pictures go to the output folder; the clouds are made in a temporary one.
set -eu

if [ $# -lt 2 ]; then
    echo "usage: sh make.sh FOLDER-OF-PROGRAMS OUTPUT-FOLDER [NAME]..." >&2
    exit 2
fi
[ -x "$1/neph-view" ] || { echo "make.sh: no neph-view in $1 (build it first: sh examples/quickstart.sh)" >&2; exit 2; }
mkdir -p "$2"
PATH=$(cd "$1" && pwd):$PATH
out=$(cd "$2" && pwd)
shift 2
names=" $* "
cd "$(dirname "$0")/../.." # the table's paths are those from the source's root
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# One picture a line: name | commands that write the cloud to standard output | options of neph-view.
table() {
    cat <<'END'
castellanus  | neph-lsys examples/castellanus.lsys | --sun 50,35
jet-stream   | neph-lsys examples/jet-stream.lsys | --sun 60,35 --eye 0,-14,34
spiral       | neph-lsys examples/spiral.lsys --seed 1 | --sun 60,40
tower        | neph-lsys examples/tower.lsys | --sun 70,35
anvil        | neph-lsys examples/anvil.lsys | --sun 60,30
cirrus-wisps | neph-lsys examples/cirrus-wisps.lsys | --sun 60,35
tree-of-puffs | neph-lsys examples/tree-of-puffs.lsys | --sun 70,35
scattered    | neph-lsys examples/scattered.lsys | --sun 60,35
humilis      | neph-gauss --preset humilis --extinction 10 | --sun 60,40
mediocris    | neph-gauss --preset mediocris --extinction 10 | --sun 70,35
congestus    | neph-gauss --preset congestus --extinction 12 --seed 2 | --sun 70,35
text         | neph-mesh --fit --size 10 --extinction 25 examples/meshes/text.glb | --sun 60,35
stratocumulus | neph-layer --preset stratocumulus | --sun 60,35
grown        | neph-gauss --preset congestus --extinction 12 --seed 5 \| neph-edit - --grow --prune | --sun 70,35
clipped      | neph-lsys examples/tower.lsys --seed 4 \| neph-edit - --grow --clip --clip-height 1 --clip-noise 0.6 --prune | --sun 70,35
END
}

table | sed 's/\\|/\a/g' | while IFS='|' read -r name make view; do
    name=$(echo "$name" | tr -d ' ')
    case $names in "  " | *" $name "*) ;; *) continue ;; esac
    make=$(echo "$make" | tr '\a' '|')
    begin=$(date +%s%N)
    if ! { sh -ec "$make" >"$work/cloud.neph" 2>"$work/log" &&
        # Several words.
        # shellcheck disable=SC2086
        neph-view "$work/cloud.neph" --headless --size 480x270 $view -o "$out/$name.png" 2>>"$work/log"; } </dev/null; then
        echo "make.sh: $name was not made:" >&2
        cat "$work/log" >&2
        exit 1
    fi
    end=$(date +%s%N)
    primitives=$(neph-info "$work/cloud.neph" --json | sed -n 's/.*"primitives": *\([0-9][0-9]*\).*/\1/p' | head -n 1)
    bytes=$(wc -c <"$work/cloud.neph")
    tenths=$(((end - begin + 50000000) / 100000000))
    printf '%s\t%s\t%s\t%s.%s\n' "$name" "$primitives" "$bytes" $((tenths / 10)) $((tenths % 10))
done
