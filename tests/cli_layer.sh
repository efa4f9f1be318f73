#!/bin/sh
# neph-layer: presets, options that reach the file, details as medium options, mistakes. $1: programs, $2: source folder.
set -eu
bin=$1
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT

fail() {
    echo "cli_layer: $1" >&2
    exit 1
}
# says TEXT ARGUMENTS...: the JSON of the layer that neph-layer makes of the arguments holds the text.
says() {
    text=$1
    shift
    "$bin/neph-layer" -q "$@" | "$bin/neph-info" --json - > "$tmp/json" || fail "neph-layer $*: failed"
    grep -Fq -e "$text" "$tmp/json" || fail "neph-layer $*: no $text in $(cat "$tmp/json")"
}
# wrong TEXT ARGUMENTS...: exit 2 with one line that holds the text.
wrong() {
    text=$1
    shift
    code=0
    "$bin/neph-layer" "$@" > "$tmp/out" 2> "$tmp/err" || code=$?
    [ "$code" -eq 2 ] || fail "neph-layer $*: exit $code, not 2"
    [ "$(wc -l < "$tmp/err")" -eq 1 ] || fail "neph-layer $*: not one line of error"
    grep -Fq -e "$text" "$tmp/err" || fail "neph-layer $*: says $(cat "$tmp/err"), not $text"
    [ ! -s "$tmp/out" ] || fail "neph-layer $*: wrote besides failing"
}

# Presets differ, the same command gives the same bytes, a seed another noise.
for preset in stratus stratocumulus fog; do
    "$bin/neph-layer" -q --preset $preset -o "$tmp/$preset.neph"
    "$bin/neph-layer" -q --preset $preset | cmp -s - "$tmp/$preset.neph" || fail "$preset: not the same bytes twice"
    says "\"name\": \"$preset\", \"model\": \"layer\"" --preset $preset
done
! cmp -s "$tmp/stratus.neph" "$tmp/fog.neph" || fail "stratus and fog are the same"
says '"noise_seed": 7' --seed 7
says '"made_by": "neph-layer' --preset fog
says '"coverage": 0.25' --preset fog --coverage 0.25

# Each option reaches the file.
says '"bounds": "box", "noise": "perlin-worley", "worley_octaves": 3'
says '"bounds": [[-10, 0, -10], [10, 6, 10]]'
says '"bounds": "sphere", "noise": "worley"' --bounds sphere --noise worley --extent 4,4,4
says '"bounds": [[-2, 0, -2], [2, 4, 2]]' --bounds sphere --extent 4,4,4
says '"spheres": 1, "ellipsoids": 0' --bounds sphere --extent 4,4,4
says '"bounds": [[-10, 100, -10], [10, 150, 10]]' --altitudes 100,150
says '"planet_radius": 6371125' --bounds altitudes --altitudes 100,150 --planet-radius 6371000
says '"noise_scale": 0.5' --frequency 2
says '"noise_scale": 3' --noise-scale 3
says '"noise": "lattice"' --noise lattice
says '"blend": 0.75' --blend 0.75
says '"gain": 2, "worley_gain": 3, "worley_frequency": 4' --gain 2 --worley-gain 3 --worley-frequency 4
says '"worley_octaves": 5' --worley-octaves 5
says '"stretch": [1, 2, 3], "ramp": [0.25, 0.5]' --stretch 1,2,3 --ramp 0.25,0.5
says '"cut": 0.125' --cut 0.125
says '"falloff": 0.5, "fade_bottom": 0.25, "fade_top": 0.75, "fade_side": 0.125' \
    --falloff 0.5 --fade-bottom 0.25 --fade-top 0.75 --fade-side 0.125
says '"displace": 2, "displace_scale": 3' --displace 2 --displace-scale 3
says '"extinction": 0.5' --preset stratus --extinction 0.5
says '"model": "uniform"' --model uniform

# Details by neph-gauss, neph-edit and in a grammar, and off again: then the file is as it was.
"$bin/neph-gauss" -q -o "$tmp/gauss.neph"
"$bin/neph-gauss" -q --smoothness 0.25 --billow 0.5 --wisp 0.75 | "$bin/neph-info" --json - > "$tmp/json"
grep -Fq '"detail": {"smoothness": 0.25, "displace": 0, "displace_scale": 0, "billow": 0.5, "wisp": 0.75' "$tmp/json" ||
    fail "neph-gauss: the details are not in $(cat "$tmp/json")"
"$bin/neph-edit" -q --smoothness 0.25 "$tmp/gauss.neph" -o "$tmp/smooth.neph"
"$bin/neph-info" "$tmp/smooth.neph" | grep -q '^  details     smoothness 0.25$' || fail "neph-edit: no smoothness"
"$bin/neph-edit" -q --smoothness 0 "$tmp/smooth.neph" | "$bin/neph-info" --json - > "$tmp/json"
grep -Fq '"format": "neph 1.0"' "$tmp/json" || fail "a file without details is not of version 1.0 again"
! grep -q '"detail"' "$tmp/json" || fail "details are left over"
printf 'axiom X X\ndisplace 0.25  billow 0.5\n' | "$bin/neph-lsys" -q - | "$bin/neph-info" --json - > "$tmp/json"
grep -Fq '"displace": 0.25' "$tmp/json" || fail "neph-lsys: displace in a grammar did nothing"
"$bin/neph-gauss" -q --model layer | "$bin/neph-info" --json - | grep -q '"layer": {"bounds": "sphere"' ||
    fail "neph-gauss --model layer: no layer bounded by the spheres"

# Mistakes.
wrong "runs backwards" --ramp 0.6,0.4
wrong "higher one" --altitudes 5,5
wrong "give one of them" --frequency 1 --noise-scale 1
wrong "needs --bounds altitudes" --planet-radius 100
wrong "needs --noise perlin-worley" --noise perlin --blend 0.5
wrong "need --noise worley" --noise lattice --worley-gain 2
wrong "of lattice and Perlin" --noise worley --gain 2
wrong "coverage" --coverage 2
wrong "extent" --extent 0,1,1
wrong "noise" --noise simplex
wrong "preset" --preset cirrus
code=0
"$bin/neph-gauss" -q --model metaball --smoothness 0.5 > "$tmp/out" 2> "$tmp/err" || code=$?
[ "$code" -eq 1 ] && [ ! -s "$tmp/out" ] || fail "smoothness of metaballs: exit $code"
grep -q 'set it to 0' "$tmp/err" || fail "smoothness of metaballs: says $(cat "$tmp/err")"
echo "neph-layer holds"
