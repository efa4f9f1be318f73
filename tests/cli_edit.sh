# neph-edit: combining, moving, reworking, settings, one cloud or all, provenance, mistakes. $1: programs.
set -eu
bin=$1
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
cd "$tmp"

fail() {
    echo "cli_edit: $1" >&2
    exit 1
}

primitives() {
    "$bin/neph-info" --csv "$1" | tail -n +2
}

# expect FILE PYTHON-EXPRESSION over the clouds `c` of neph-info's JSON.
expect() {
    "$bin/neph-info" --json "$1" > info.json
    python3 -c "import json; d = json.load(open('info.json')); c = d['clouds']
def near(a, b): return all(abs(x - y) < 1e-5 for u, v in zip(a, b) for x, y in zip(u, v))
assert $2, c" || fail "$1: not true: $2"
}

refuse() {
    code=$1
    word=$2
    shift 2
    status=0
    "$@" -o refused.neph > out 2> err || status=$?
    [ $status = "$code" ] || fail "$* ended with $status, not $code"
    [ "$(wc -l < err)" = 1 ] || fail "$*: not one line: $(cat err)"
    grep -q -- "$word" err || fail "$*: \"$word\" is not in: $(cat err)"
    [ ! -s out ] && [ ! -e refused.neph ] || fail "$* wrote something"
}

"$bin/neph-gauss" -q -o a.neph
"$bin/neph-gauss" -q --seed 2 --preset humilis -o b.neph
"$bin/neph-gauss" -q --count 1 --sigma 0,0,0 --max-radius 1 --at 10,0,0 -o ball.neph
primitives a.neph > a.csv

# Combining: names, seeds, provenance with every input's digest; the primitives as they were.
"$bin/neph-edit" a.neph b.neph a.neph -o all.neph 2> said
grep -q '3 clouds' said || fail "says: $(cat said)"
expect all.neph "[x['name'] for x in c] == ['cumulus', 'humilis', 'cumulus-3'] and [x['seed'] for x in c] == [1, 2, 1]"
digest=$(sha256sum a.neph | cut -c1-16)
expect all.neph "c[0]['made_by'].startswith('neph-edit ') and c[0]['made_by'].count('a.neph sha256:$digest') == 2"
expect all.neph "' <- neph-gauss ' in c[0]['made_by'] and 'b.neph sha256:' in c[0]['made_by']"
primitives all.neph | sed -n "1,$(wc -l < a.csv)p" | cmp -s - a.csv || fail "combining changed the primitives"
size=$(wc -c < all.neph)
"$bin/neph-edit" -q all.neph all.neph -o twice.neph
[ "$(wc -c < twice.neph)" -gt "$size" ] || fail "nothing was added"
"$bin/neph-edit" -q - b.neph < a.neph > piped.neph
expect piped.neph "[x['name'] for x in c] == ['cumulus', 'humilis']"

# In place, and the same bytes twice.
cp a.neph here.neph
"$bin/neph-edit" -q here.neph --rotate 0,90,0 -o here.neph
"$bin/neph-edit" -q a.neph --rotate 0,90,0 -o one.neph
"$bin/neph-edit" -q a.neph --rotate 0,90,0 -o two.neph
cmp -s one.neph two.neph || fail "the same edit, other bytes"
primitives here.neph | cmp -s - a.csv || fail "turning changed the primitives"

# Moving. The ball stands at 10,0,0 with radius 1.
"$bin/neph-edit" -q ball.neph --translate 1,2,3 --scale 2,2,2 --rotate 0,0,90 -o m.neph
expect m.neph "near(c[0]['bounds'], [[-1, 20, 1], [3, 24, 5]]) and c[0]['spheres'] == 1"
"$bin/neph-edit" -q ball.neph --scale 2,1,0.5 -o m.neph
expect m.neph "near(c[0]['bounds'], [[18, -1, -0.5], [22, 1, 0.5]]) and c[0]['ellipsoids'] == 1 and c[0]['spheres'] == 0"
"$bin/neph-edit" -q ball.neph --scale 3,3,3 --pivot 10,0,0 --keep-depth -o m.neph
expect m.neph "near(c[0]['bounds'], [[7, -3, -3], [13, 3, 3]]) and abs(c[0]['medium']['extinction'] - 2 / 3) < 1e-6"
"$bin/neph-edit" -q ball.neph --mirror x -o m.neph
expect m.neph "near(c[0]['bounds'], [[-11, -1, -1], [-9, 1, 1]])"
"$bin/neph-edit" -q ball.neph --at 0,5,0 -o m.neph
expect m.neph "near(c[0]['bounds'], [[9, 4, -1], [11, 6, 1]])"

# One cloud only.
"$bin/neph-edit" -q all.neph --cloud humilis --translate 0,100,0 --extinction 7 --model uniform -o m.neph
expect m.neph "c[1]['bounds'][0][1] > 90 and c[0]['bounds'][1][1] < 10 and c[2]['bounds'][1][1] < 10"
expect m.neph "[x['medium']['extinction'] for x in c] == [2, 7, 2] and [x['model'] for x in c] == ['spheroid', 'uniform', 'spheroid']"
expect m.neph "c[1]['seed'] == 2"

# Rework.
"$bin/neph-edit" a.neph --thin 10 -o m.neph 2> said
grep -q 'thinning out removed' said || fail "says: $(cat said)"
expect m.neph "c[0]['primitives'] == 10"
primitives m.neph > few.csv
[ "$(grep -cxFf few.csv a.csv)" = 10 ] || fail "thinning out changed what it kept"
"$bin/neph-edit" a.neph --grow --grow-levels 1 --grow-count 5 -o m.neph 2> said
grep -q 'growing added [1-9]' said || fail "says: $(cat said)"
primitives m.neph | sed -n "1,$(wc -l < a.csv)p" | cmp -s - a.csv || fail "growing changed what was there"
"$bin/neph-edit" a.neph --clip -o m.neph 2> said
grep -q 'clipping removed 0 primitives and squashed [1-9]' said || fail "says: $(cat said)"
expect m.neph "abs(c[0]['bounds'][0][1]) < 1e-5 and c[0]['ellipsoids'] > 0"
"$bin/neph-edit" -q a.neph --clip --clip-height 1 --clip-noise 0.5 -o m.neph
expect m.neph "0.499 < c[0]['bounds'][0][1] < 1.001"
"$bin/neph-edit" a.neph a.neph --hollow --prune -o m.neph 2> said
grep -q 'hollowing removed [1-9]' said || fail "says: $(cat said)"
grep -q 'pruning removed' said || fail "says: $(cat said)"
"$bin/neph-gauss" -q --count 500 --sigma 0,0,0 --no-prune -o same.neph
"$bin/neph-edit" same.neph --prune -o m.neph 2> said
grep -q 'pruning removed 499' said || fail "says: $(cat said)"

# Simplifying: the number asked for, no more than the error allowed, one cloud or all, the frame's place without meaning.
"$bin/neph-edit" -q a.neph --grow --grow-levels 1 -o grown.neph
"$bin/neph-edit" grown.neph --primitives 20 -o m.neph 2> said
grep -q 'simplifying kept 20 of [0-9]* primitives; pictures change by 0\.' said || fail "says: $(cat said)"
expect m.neph "c[0]['primitives'] == 20 and '--primitives 20' in c[0]['made_by']"
"$bin/neph-edit" grown.neph --simplify 0.05 -o fine.neph 2> said
python3 - "$(sed -n 's/.*change by //p' said)" <<'END' || fail "says: $(cat said)"
import sys
assert 0 <= float(sys.argv[1]) <= 0.05
END
"$bin/neph-edit" -q grown.neph --simplify 0.4 -o coarse.neph
[ "$(primitives coarse.neph | wc -l)" -lt "$(primitives fine.neph | wc -l)" ] || fail "a larger error kept as much"
"$bin/neph-edit" -q grown.neph --translate 1e6,0,0 --simplify 0.05 -o far.neph
primitives fine.neph > fine.csv
primitives far.neph | cmp -s - fine.csv || fail "the place changed the simplification"
"$bin/neph-edit" -q a.neph a.neph --cloud cumulus-2 --primitives 4 -o m.neph
expect m.neph "c[1]['primitives'] == 4 and c[0]['primitives'] > 4"
"$bin/neph-edit" -q same.neph --simplify 0 -o m.neph
expect m.neph "c[0]['primitives'] < 500"
refuse 2 'simplify' "$bin/neph-edit" a.neph --simplify 1.5
refuse 2 'primitives' "$bin/neph-edit" a.neph --primitives 0

# Mistakes.
refuse 2 'FILE' "$bin/neph-edit"
refuse 1 'missing.neph' "$bin/neph-edit" missing.neph
refuse 1 'no cloud "x"' "$bin/neph-edit" a.neph --cloud x
refuse 2 'scale' "$bin/neph-edit" a.neph --scale 0,1,1
refuse 2 'mirror' "$bin/neph-edit" a.neph --mirror up
refuse 2 'rotate' "$bin/neph-edit" a.neph --rotate 1,2
refuse 2 'give --grow too' "$bin/neph-edit" a.neph --grow-count 3
refuse 2 'give --clip too' "$bin/neph-edit" a.neph --clip-height 3
refuse 2 'scale' "$bin/neph-edit" a.neph --keep-depth
refuse 2 'once' "$bin/neph-edit" - -
refuse 1 '1000000' "$bin/neph-edit" a.neph --grow --grow-count 1000 --grow-levels 8
refuse 2 'clip-normal' "$bin/neph-edit" a.neph --clip --clip-normal 0,0,0
head -c 100 a.neph > cut.neph
refuse 1 'cut.neph' "$bin/neph-edit" cut.neph
echo "cli_edit: done"
