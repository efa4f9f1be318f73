#!/bin/sh
# neph-info: table, JSON and CSV of the frozen file, letter by letter; its errors. $1: programs, $2: source folder.
set -eu
info=$1/neph-info
frozen=$2/tests/frozen/v1.0-two-clouds.neph
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT

fail() {
    echo "cli_info: $1" >&2
    exit 1
}
# same NAME: $tmp/NAME.is is $tmp/NAME.want
same() {
    diff "$tmp/$1.want" "$tmp/$1.is" >&2 || fail "$1 is not what it was"
}

# --- JSON: what sample_two_clouds() in neph_sample.h puts in; 18446744073709551615 is 2^64 - 1
cat > "$tmp/json.want" <<'END'
{"format": "neph 1.0", "bytes": 800, "clouds": [
    {"name": "puff, \"small\"", "model": "spheroid", "primitives": 3, "spheres": 2, "ellipsoids": 1,
     "bounds": [[-1.5, -4, -2.6334009170532227], [4.967470645904541, 2.5, 3.1334009170532227]],
     "frame": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]],
     "medium": {"phase": "two-lobe", "extinction": 2, "albedo": 1, "g": 0.85, "g2": -0.3, "lobe_mix": 0.3, "droplet": 10, "kappa": 0.5, "noise_scale": 0.2, "edge": 4.2, "octaves": 5, "noise_seed": 7},
     "seed": 18446744073709551615, "made_by": "neph-test 0.1.0 --count 3 café.lsys"},
    {"name": "puff, \"small\"-2", "model": "metaball", "primitives": 3, "spheres": 2, "ellipsoids": 1,
     "bounds": [[199994.80784778975, -0.48839378356933594, -11.053203582763672], [200011.3554175415, 19.488393783569336, 7.071152210235596]],
     "frame": [[2, 0, 0, 200000.004], [0, 0, -2, 10], [0, 2, 0, -0.125]],
     "medium": {"phase": "two-lobe", "extinction": 2, "albedo": 1, "g": 0.85, "g2": -0.3, "lobe_mix": 0.3, "droplet": 10, "kappa": 0.5, "noise_scale": 0.2, "edge": 4.2, "octaves": 5, "noise_seed": 7},
     "seed": 18446744073709551615, "made_by": "neph-test 0.1.0 --count 3 café.lsys"}]}
END
"$info" --json "$frozen" > "$tmp/json.is"
same json
# from a pipe, into a file, in a country of decimal commas: the same
"$info" --json - -o "$tmp/json.is" < "$frozen"
same json
LC_ALL=de_DE.UTF-8 LC_NUMERIC=de_DE.UTF-8 "$info" --json "$frozen" > "$tmp/json.is"
same json
if command -v python3 > /dev/null; then
    python3 -c 'import json, sys
d = json.load(open(sys.argv[1]))
assert sorted(d) == ["bytes", "clouds", "format"], d.keys()
keys = "bounds ellipsoids frame made_by medium model name primitives seed spheres".split()
assert all(sorted(c) == keys for c in d["clouds"])
assert d["clouds"][1]["frame"][0][3] == 200000.004 and d["clouds"][0]["seed"] == 2**64 - 1' "$tmp/json.is" ||
        fail "the JSON is not what the contract says"
fi

# --- CSV: nine digits, names quoted
cat > "$tmp/csv.want" <<'END'
cloud,kind,x,y,z,a,b,c,qx,qy,qz,qw
"puff, ""small""",sphere,0,1,0,1.5,1.5,1.5,0,0,0,1
"puff, ""small""",sphere,-1.25,0.5,2,0.100000001,0.100000001,0.100000001,0,0,0,1
"puff, ""small""",ellipsoid,4,-2,0.25,3,2,0.5,0,0.600000024,0,0.800000012
"puff, ""small""-2",sphere,0,1,0,1.5,1.5,1.5,0,0,0,1
"puff, ""small""-2",sphere,-1.25,0.5,2,0.100000001,0.100000001,0.100000001,0,0,0,1
"puff, ""small""-2",ellipsoid,4,-2,0.25,3,2,0.5,0,0.600000024,0,0.800000012
END
"$info" --csv "$frozen" > "$tmp/csv.is"
same csv
"$info" --csv "$frozen" -o "$tmp/csv.is"
same csv

# --- the table: every fact has its place
"$info" "$frozen" > "$tmp/table"
for words in "neph 1.0, 800 bytes, 2 clouds, 6 primitives" "cloud 1: puff, \"small\"" "model       spheroid" \
    "3: 2 spheres, 1 ellipsoid" "(those of cloud 1)" "size 6.46747 x 6.5 x 5.7668 m" "origin 200000.004, 10, -0.125 m" \
    "extinction 2 /m, albedo 1, phase two-lobe, g 0.85" "5 octaves, scale 0.2 m, seed 7, kappa 0.5" \
    "seed        18446744073709551615" "made by     neph-test 0.1.0 --count 3 café.lsys" "note, 4 bytes"; do
    grep -qF "$words" "$tmp/table" || fail "the table does not say: $words"
done

# --- errors: one line on standard error, nothing on standard output, the exit code
# refused CODE WORDS ARGUMENT...
refused() {
    code=$1 words=$2 status=0
    shift 2
    "$info" "$@" > "$tmp/out" 2> "$tmp/err" || status=$?
    [ "$status" = "$code" ] || fail "$* ended with $status, not $code"
    [ ! -s "$tmp/out" ] || fail "$* wrote to standard output"
    [ "$(wc -l < "$tmp/err")" = 1 ] || fail "$* wrote more or less than one line of error"
    grep -qF "$words" "$tmp/err" || fail "$* does not say: $words"
}
head -c 500 "$frozen" > "$tmp/cut.neph"
echo "axiom X" > "$tmp/text.neph"
: > "$tmp/empty.neph"
refused 1 "neph-info: $tmp/cut.neph: truncated at byte 500 of 800 (copy the file again)" "$tmp/cut.neph"
refused 1 "not a .neph file" "$tmp/text.neph"
refused 1 "the file is empty" "$tmp/empty.neph"
refused 1 "$tmp/none.neph: cannot open" "$tmp/none.neph"
refused 1 "cannot write" "$frozen" -o "$tmp/no/such/folder"
refused 2 "FILE is missing"
refused 2 "exclude each other" --json --csv "$frozen"
refused 2 "one argument too many" "$frozen" "$frozen"
refused 2 "unknown option" --jason "$frozen"
if [ -w /dev/full ]; then
    status=0
    "$info" "$frozen" > /dev/full 2> "$tmp/err" || status=$?
    [ "$status" = 1 ] || fail "a full disk ended with $status, not 1"
fi
