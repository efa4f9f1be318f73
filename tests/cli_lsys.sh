# neph-lsys: counts, the string, streams, overrides, mistakes and limits. $1: programs, $2: source folder.
set -eu
lsys=$1/neph-lsys
info=$1/neph-info
examples=$2/examples
slow=${NEPHELE_SLOW:-1} # so many times slower than usual may the programs be (valgrind, sanitizers)
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT

fail() {
    echo "cli_lsys: $1" >&2
    exit 1
}
# expect WHAT WANT IS
expect() {
    [ "$2" = "$3" ] || fail "$1: expected \"$2\", got \"$3\""
}
# exits CODE COMMAND...: standard error goes to $tmp/err
exits() {
    want=$1
    shift
    code=0
    "$@" > "$tmp/out" 2> "$tmp/err" || code=$?
    [ "$code" = "$want" ] || fail "$* exits with $code, expected $want: $(cat "$tmp/err")"
}
says() {
    grep -qF -- "$1" "$tmp/err" || fail "standard error does not say \"$1\": $(cat "$tmp/err")"
}

# The paper's grammar (Eq. 18): 2^7 spheres, one turn between any two.
paper='axiom X
iterations 7
X -> X + Y
Y -> X & Y'
echo "$paper" > "$tmp/paper.lsys"
expect count '{"symbols": 255, "primitives": 128}' "$("$lsys" "$tmp/paper.lsys" --count)"
expect "the spiral" '{"symbols": 255, "primitives": 128}' "$("$lsys" "$examples/spiral.lsys" --count)"
expect print 'X+Y+X&Y' "$("$lsys" "$tmp/paper.lsys" --iterations 2 --print)"
expect "standard input" 'X+Y' "$(echo "$paper" | "$lsys" - --iterations 1 --print)"
"$lsys" "$tmp/paper.lsys" -o "$tmp/paper.neph" 2> "$tmp/err"
says "neph-lsys: paper: 128 spheres"
"$lsys" "$tmp/paper.lsys" -q 2> "$tmp/err" > "$tmp/piped.neph"
[ ! -s "$tmp/err" ] || fail "-q is not quiet"
cmp "$tmp/paper.neph" "$tmp/piped.neph" || fail "-o and standard output differ"
"$lsys" "$tmp/paper.lsys" -q --print -o "$tmp/both.neph" > "$tmp/out"
cmp "$tmp/paper.neph" "$tmp/both.neph" || fail "--print changes the cloud"
expect "print with -o" 255 "$(tr -d '\n' < "$tmp/out" | wc -c | tr -d ' ')"

# What the file says, and the command line over it.
cat > "$tmp/set.lsys" <<'END'
axiom F+F
extinction 3  kappa 0.25  g 0.5  octaves 4  noise-scale 0.75
radius 2  angle 90
END
"$lsys" -q "$tmp/set.lsys" --at 10,20,30 --g 0.75 --radius 0.5 --length 4 --seed 18446744073709551615 \
    -o "$tmp/set.neph"
"$info" --json "$tmp/set.neph" > "$tmp/set.json"
for part in '"name": "set"' '"extinction": 3' '"kappa": 0.25' '"octaves": 4' '"noise_scale": 0.75' '"g": 0.75' \
    '"seed": 18446744073709551615' '--radius 0.5 --length 4' 'set.lsys sha256:' '[9.5, 19.5, 29.5], [10.5, 24.5, 30.5]'; do
    grep -qF -- "$part" "$tmp/set.json" || fail "neph-info does not show $part: $(cat "$tmp/set.json")"
done
"$lsys" -q "$tmp/set.lsys" --angle 0..360 --shrink 0.5..1 --iterations 0 -o "$tmp/set.neph"

# Every mistake in one run, each with its place.
printf 'axiom X\nangel 3\nX -> [F(r)\nY ->\n' > "$tmp/bad.lsys"
exits 1 "$lsys" "$tmp/bad.lsys" -o "$tmp/bad.neph"
says "neph-lsys: $tmp/bad.lsys:2:1: angel is not a setting (did you mean angle?)"
says "neph-lsys: $tmp/bad.lsys:3:6: '[' is not closed"
says "neph-lsys: $tmp/bad.lsys:3:9: r is not a parameter"
says "neph-lsys: $tmp/bad.lsys:4:3: nothing behind the arrow"
expect "lines of mistakes" 4 "$(wc -l < "$tmp/err" | tr -d ' ')"
[ ! -e "$tmp/bad.neph" ] || fail "a file was written in spite of mistakes"
exits 1 "$lsys" - < "$tmp/bad.lsys"
says "neph-lsys: standard input:2:1:"
printf 'axiom x' > "$tmp/none.lsys"
exits 1 "$lsys" "$tmp/none.lsys"
says "sets no puff"
expect "no puff, counted" '{"symbols": 1, "primitives": 0}' "$("$lsys" "$tmp/none.lsys" --count)"
exits 1 "$lsys" "$tmp/nowhere.lsys"
says "nowhere.lsys"
exits 2 "$lsys"
exits 2 "$lsys" a b
exits 2 "$lsys" "$tmp/paper.lsys" --iterations 1.5
exits 2 "$lsys" "$tmp/paper.lsys" --angle 3..x
exits 2 "$lsys" "$tmp/paper.lsys" --angle 30..10
exits 2 "$lsys" "$tmp/paper.lsys" --radius 0
exits 2 "$lsys" "$tmp/paper.lsys" --print --count

# Runaway grammars end, with primitives and without.
printf 'axiom X\niterations 100000\nX -> X X' > "$tmp/run.lsys"
exits 1 timeout $((5 * slow)) "$lsys" "$tmp/run.lsys"
says "more than 1000000 primitives"
exits 1 timeout $((5 * slow)) "$lsys" "$tmp/run.lsys" --max-primitives 1000 --count
says "run.lsys:3:6: more than 1000 primitives"
printf 'axiom x\niterations 100000\nx -> [x] x' > "$tmp/run.lsys"
exits 1 timeout $((10 * slow)) "$lsys" "$tmp/run.lsys" --print
says "symbols"
expect "exactly the limit" '{"symbols": 255, "primitives": 128}' \
    "$("$lsys" "$tmp/paper.lsys" --count --max-primitives 128)"
exits 1 "$lsys" "$tmp/paper.lsys" --max-primitives 127

# The string streams: a reader that leaves early ends it (nine million symbols would take far longer to read).
printf 'axiom x\niterations 23\nx -> x x' > "$tmp/long.lsys"
expect "the beginning" xxxxxxxxxx "$(timeout $((10 * slow)) "$lsys" "$tmp/long.lsys" --print 2> /dev/null | head -c 10)"

# The examples all give clouds; the castle is long, and lower than long.
for grammar in "$examples"/*.lsys; do
    "$lsys" -q "$grammar" -o "$tmp/example.neph" || fail "$grammar gives no cloud"
done
"$lsys" "$examples/castellanus.lsys" -o "$tmp/castle.neph" 2> "$tmp/err"
awk '{ for (i = 1; i < NF; i++) if ($(i + 1) == "x" && $(i + 3) == "x") { ok = $i > 2 * $(i + 2) && $(i + 2) > $(i + 4) } }
    END { exit !ok }' "$tmp/err" || fail "castellanus is not long, or not higher than wide: $(cat "$tmp/err")"
