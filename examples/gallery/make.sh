#!/bin/sh
# Renders the clouds of examples/gallery/clouds.txt by the reference, and writes the page of them.
#
#     sh examples/gallery/make.sh build/release/bin docs/gallery            # all
#     sh examples/gallery/make.sh build/release/bin docs/gallery tower fog  # some
#     sh examples/gallery/make.sh build/release/bin docs/gallery -          # none: the page only
#
# The pictures go to docs/gallery, what was measured of each to docs/gallery/figures.tsv (name, primitives, bytes,
# seconds of processor time to make the cloud and to render it), and the page to docs/gallery.md.
set -eu

if [ $# -lt 2 ]; then
    echo "usage: sh make.sh FOLDER-OF-PROGRAMS OUTPUT-FOLDER [NAME]..." >&2
    exit 2
fi
[ -x "$1/neph-render" ] || { echo "make.sh: no neph-render in $1 (build it first: sh examples/quickstart.sh)" >&2; exit 2; }
mkdir -p "$2"
PATH=$(cd "$1" && pwd):$PATH
out=$(cd "$2" && pwd)
shift 2
names=" $* "
cd "$(dirname "$0")/../.." # the commands' paths are those from the source's root
clouds=examples/gallery/clouds.txt
figures=$out/figures.tsv
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Processor time of all children so far, in hundredths of a second. In a pipe, times would tell of another shell.
spent() {
    times >"$work/times"
    tail -n 1 "$work/times" | tr 'ms' '  ' | awk '{ print int(100 * (60 * ($1 + $3) + $2 + $4) + 0.5) }'
}

# "name<TAB>command<TAB>view" of each cloud.
table() {
    awk '/^## / { name = $2 } /^\$ / { make = substr($0, 3) }
         /^> / { print name "\t" make "\t" substr($0, 3) }' "$clouds"
}

render() { # name, command, view
    spent >"$work/before"
    sh -ec "$2" >"$work/cloud.neph" 2>"$work/log" </dev/null || return 1
    spent >"$work/made"
    # The view is several words.
    # shellcheck disable=SC2086
    neph-render "$work/cloud.neph" --size 480x300 --denoise $3 -o "$out/$1.png" 2>"$work/log" || return 1
    spent >"$work/after"
}

tab=$(printf '\t')
table >"$work/table"
touch "$figures"
while IFS=$tab read -r name make view; do
    case $names in "  " | *" $name "*) ;; *) continue ;; esac
    render "$name" "$make" "$view" || { echo "make.sh: $name was not made:" >&2; cat "$work/log" >&2; exit 1; }
    primitives=$(neph-info "$work/cloud.neph" --json | awk -F'"primitives": ' 'NF > 1 { sum += $2 } END { print sum }')
    bytes=$(wc -c <"$work/cloud.neph")
    grep -v "^$name$tab" "$figures" >"$work/figures" || true
    paste "$work/before" "$work/made" "$work/after" | awk -v name="$name" -v n="$primitives" -v bytes="$bytes" \
        '{ printf "%s\t%d\t%d\t%.2f\t%.0f\n", name, n, bytes, ($2 - $1) / 100, ($3 - $2) / 100 }' >>"$work/figures"
    cp "$work/figures" "$figures"
    tail -n 1 "$figures"
done <"$work/table"

# The page.
awk -v figures="$figures" -f examples/gallery/page.awk "$clouds" >"$out.md"
