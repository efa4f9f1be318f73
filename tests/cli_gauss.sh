# neph-gauss and neph-meta: options, presets, fields, what they say, what they refuse. $1: programs.
set -eu
bin=$1
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
cd "$tmp"

fail() {
    echo "cli_gauss: $1" >&2
    exit 1
}

# primitives FILE: one row each, without the header.
primitives() {
    "$bin/neph-info" --csv "$1" | tail -n +2
}

# expect FILE PYTHON-EXPRESSION over the JSON `d` of neph-info.
expect() {
    "$bin/neph-info" --json "$1" > info.json
    python3 -c "import json; d = json.load(open('info.json')); c = d['clouds']; assert $2, c" ||
        fail "$1: not true: $2"
}

# refuse CODE WORD COMMAND...: exit code, one line on standard error that has the word, nothing written.
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

# The default: 35 drawn, reported, the same from run to run and through a pipe, another seed another cloud.
"$bin/neph-gauss" -o a.neph 2> said
grep -q 'spheres of 35 drawn; hollowing removed [0-9]* (.* %), pruning [0-9]*' said || fail "says: $(cat said)"
"$bin/neph-gauss" -q 2> said > b.neph
[ ! -s said ] || fail "-q says something"
cmp -s a.neph b.neph || fail "the same command, other bytes"
"$bin/neph-gauss" -q --seed 2 -o c.neph
! cmp -s a.neph c.neph || fail "seed 2 gives the cloud of seed 1"
expect a.neph "len(c) == 1 and c[0]['name'] == 'cumulus' and c[0]['model'] == 'spheroid' and c[0]['seed'] == 1"
expect a.neph "c[0]['made_by'].startswith('neph-gauss ') and 20 < c[0]['primitives'] <= 35"

# Left whole, all 35 are there; sigma 0 with one sphere is a ball of the largest radius in its place.
"$bin/neph-gauss" -q --no-hollow --no-prune -o whole.neph
expect whole.neph "c[0]['primitives'] == 35 and c[0]['made_by'].endswith('--no-hollow --no-prune')"
"$bin/neph-gauss" -q --count 1 --sigma 0,0,0 --max-radius 1 --model uniform --at 10,20,30 -o ball.neph
expect ball.neph "c[0]['bounds'] == [[9, 19, 29], [11, 21, 31]] and c[0]['model'] == 'uniform'"
[ "$(primitives ball.neph | cut -d, -f2-6)" = "sphere,0,0,0,1" ] || fail "ball: $(primitives ball.neph)"

# A moved cloud keeps its shape: --at leaves the primitives as they are, --mean moves them all.
"$bin/neph-gauss" -q --at 500,0,-7 -o moved.neph
primitives a.neph > rows
primitives moved.neph | cmp -s - rows || fail "--at changed the primitives"
"$bin/neph-gauss" -q --mean 64,0,0 -o mean.neph
primitives mean.neph | cut -d, -f6 > radii
cut -d, -f6 rows | cmp -s - radii || fail "--mean changed the radii"

# A preset gives way to what is given.
for species in humilis mediocris congestus; do
    "$bin/neph-gauss" -q --preset $species -o $species.neph
    expect $species.neph "c[0]['name'] == '$species'"
done
"$bin/neph-gauss" -q --preset humilis --count 3 --max-radius 1 --no-hollow -o few.neph
expect few.neph "c[0]['primitives'] == 3 and c[0]['bounds'][1][1] < 0.9 + 1"

# A field: names, frames at one height, seeds, distances; each cloud is what its own seed makes.
"$bin/neph-gauss" --field 30 --area 400,200 --at 0,1000,0 --seed 5 -o field.neph 2> said
grep -q '30 clouds on 400 by 200 m, no two centres nearer than' said || fail "says: $(cat said)"
expect field.neph "len({x['name'] for x in c}) == 30 and len({x['seed'] for x in c}) == 30 and c[0]['seed'] == 5"
cat > check.py <<'END'
import json, math
clouds = json.load(open('info.json'))['clouds']
places = []
for cloud in clouds:
    f = cloud['frame']
    rows = f if isinstance(f[0], list) else [f[i:i + 4] for i in (0, 4, 8)]
    x, y, z = (r[3] for r in rows)
    assert y == 1000 and abs(x) <= 200 and abs(z) <= 100, cloud
    assert abs(cloud['bounds'][0][1] - (1000 - 2.75)) < 0.35, cloud
    places.append((x, z))
nearest = min(math.dist(a, b) for i, a in enumerate(places) for b in places[:i])
assert nearest > 35, nearest # 1.7 of 30 pi s^2 / area (see test_gaussian.c) is 37.9 m
END
python3 check.py || fail "the field is not as it should be"
seed=$(python3 -c "import json; print(json.load(open('info.json'))['clouds'][7]['seed'])")
"$bin/neph-gauss" -q --seed "$seed" -o alone.neph
name=$(python3 -c "import json; print(json.load(open('info.json'))['clouds'][7]['name'])")
primitives field.neph | grep "^$name," | cut -d, -f2- > in_field
primitives alone.neph | cut -d, -f2- | cmp -s - in_field || fail "cloud $name alone is another one"

# Metaballs.
"$bin/neph-meta" -o meta.neph 2> said
grep -q '6 balls' said || fail "neph-meta says: $(cat said)"
expect meta.neph "c[0]['model'] == 'metaball' and c[0]['spheres'] == 6 and c[0]['name'] == 'metaballs'"
"$bin/neph-meta" -q --count 40 --max-radius 3 --min-radius 3 --model uniform -o meta.neph
expect meta.neph "c[0]['model'] == 'uniform' and c[0]['spheres'] == 40"
[ "$(primitives meta.neph | cut -d, -f6 | sort -u)" = 3 ] || fail "--min-radius is not kept"
"$bin/neph-meta" --help | grep -q -- '--model.*\[metaball\]\|density model \[metaball\]' || fail "help: default model"

# Mistakes.
refuse 2 'count' "$bin/neph-gauss" --count 0
refuse 2 'count' "$bin/neph-gauss" --count 12x
refuse 2 'sigma' "$bin/neph-gauss" --sigma 1,2
refuse 2 'sigma' "$bin/neph-gauss" --sigma 1,-2,3
refuse 2 'clamp' "$bin/neph-gauss" --clamp nan
refuse 2 'edge|reject' "$bin/neph-gauss" --clamp-mode soft
refuse 2 'humilis' "$bin/neph-gauss" --preset stratus
refuse 2 'area' "$bin/neph-gauss" --area 10,10
refuse 2 'max-radius' "$bin/neph-gauss" --max-radius 0
refuse 2 '100000000' "$bin/neph-gauss" --field 1000 --count 1000000
refuse 2 'min-radius' "$bin/neph-meta" --min-radius 3
refuse 2 'count' "$bin/neph-meta" --count -1
echo "cli_gauss: done"
