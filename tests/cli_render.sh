# neph-render: pictures in three formats, the same for the same seed, statistics, comparison, wrong commands.
set -eu
bin=$1
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cd "$dir"

fail() {
    echo "cli_render: $1" >&2
    exit 1
}
# wrong TEXT COMMAND...: exits 2 with one line that holds TEXT.
wrong() {
    text=$1
    shift
    code=0
    "$@" >out 2>err || code=$?
    [ "$code" -eq 2 ] || fail "$* ended with $code, not 2"
    [ "$(wc -l <err)" -eq 1 ] || fail "$* gave more than one line"
    grep -q -e "$text" err || fail "$*: \"$(cat err)\" does not say \"$text\""
}

"$bin/neph-gauss" -q --count 6 --extinction 8 -o c.neph
small="--size 32x18 --spp 8"
"$bin/neph-render" -q c.neph $small -o a.exr --stats >stats.json || fail "rendering to EXR failed"
grep -q '"method": "reference"' stats.json || fail "--stats gives no method"
grep -q '"spp": 8' stats.json || fail "--stats gives no spp"
grep -q '"rel_error": [0-9]' stats.json || fail "--stats gives no rel_error"
OMP_NUM_THREADS=1 "$bin/neph-render" -q c.neph $small -o b.exr
cmp -s a.exr b.exr || fail "one thread makes another picture than many"
"$bin/neph-render" -q c.neph $small --seed 2 -o other.exr
cmp -s a.exr other.exr && fail "another seed makes the same picture"
"$bin/neph-render" -q - $small <c.neph >c.png || fail "rendering from and to a pipe failed"
[ "$(head -c 4 c.png | tail -c 3)" = PNG ] || fail "standard output got no PNG"
"$bin/neph-render" -q c.neph $small -o c.pfm
[ "$(head -c 2 c.pfm)" = PF ] || fail "c.pfm is no PFM"

# The same radiance in both formats; another seed differs by noise, another sun by more.
"$bin/neph-render" --compare a.exr c.pfm --tolerance 0 >same.json || fail "EXR and PFM differ"
grep -q '^  "relmse": 0\.0,$' same.json || fail "equal pictures have an error"
"$bin/neph-render" --compare a.exr other.exr --tolerance 1e-9 -o heat.png >/dev/null 2>err && fail "--tolerance does not bite"
grep -q tolerance err || fail "--tolerance says nothing"
[ -s heat.png ] || fail "no heat map"
"$bin/neph-render" -q c.neph $small --sky none --sun-irradiance 0,0,0 -o dark.pfm
"$bin/neph-render" -q c.neph $small --sky 1,1,1 --sun-irradiance 0,0,0 -o white.pfm --stats >white.json
[ "$(sed -n '/"mean"/,/]/p' white.json | tr -d '\n ')" = '"mean":[1.0,1.0,1.0],' ] || fail "a white furnace is not white"
"$bin/neph-render" --compare dark.pfm white.pfm >dark.json
grep -q '^  "rmse": 1\.0,$' dark.json || fail "darkness and a white furnace are not 1 apart"
# --noise stops early, and goes on when it is asked for less.
"$bin/neph-render" -q c.neph --size 16x9 --spp 4096 --noise 0.3 -o n.exr --stats >rough.json
"$bin/neph-render" -q c.neph --size 16x9 --spp 4096 --error 0.05 -o n.exr --stats >fine.json
spp() { sed -n 's/.*"spp": \([0-9]*\).*/\1/p' "$1"; }
[ "$(spp rough.json)" -lt "$(spp fine.json)" ] || fail "less noise does not take more paths"
# --denoise comes nearer to many paths (of 480x300 pixels by two thirds; the smaller, the less), and leaves a clear sky.
"$bin/neph-gauss" -q --count 6 --extinction 4 --g 0 -o even.neph
view="--size 160x90 --seed 3"
"$bin/neph-render" -q even.neph $view --spp 16 -o grain.pfm
"$bin/neph-render" -q even.neph $view --spp 16 --denoise -o smooth.pfm
"$bin/neph-render" -q even.neph $view --seed 4 --spp 128 -o many.pfm
relmse() { "$bin/neph-render" --compare "$1" many.pfm | sed -n 's/.*"relmse": \([0-9.e-]*\).*/\1/p'; }
awk "BEGIN { exit !($(relmse smooth.pfm) < 0.75 * $(relmse grain.pfm)) }" || fail "--denoise does not take a quarter of the error away"
"$bin/neph-render" -q c.neph $view --spp 8 --eye 0,0,50 --target 0,0,99 -o sky.pfm
"$bin/neph-render" -q c.neph $view --spp 8 --eye 0,0,50 --target 0,0,99 --denoise -o sky2.pfm
"$bin/neph-render" --compare sky.pfm sky2.pfm --tolerance 1e-4 >/dev/null || fail "--denoise changes a clear sky"

wrong "expected none, clear" "$bin/neph-render" c.neph -o a.png --sky blue
wrong "height" "$bin/neph-render" c.neph -o a.png --sun 0,91
wrong "same point" "$bin/neph-render" c.neph -o a.png --eye 1,1,1 --target 1,1,1
wrong "suffix\|\.png" "$bin/neph-render" c.neph -o a.jpg
wrong "WIDTHxHEIGHT" "$bin/neph-render" c.neph -o a.png --size 12
wrong "belongs to --method reference" "$bin/neph-render" c.neph --method march --denoise -o a.png
wrong "name the picture" "$bin/neph-render" c.neph --stats
wrong "two pictures" "$bin/neph-render" --compare a.exr
wrong "belongs to --compare" "$bin/neph-render" c.neph -o a.png --tolerance 1
code=0
"$bin/neph-render" c.png -o a.png 2>err || code=$?
[ "$code" -eq 1 ] || fail "a PNG as input ended with $code, not 1"

# Marching: every rule and light, the same for any number of threads; options of the other method are refused.
for rule in riemann-left riemann-right trapezoid simpson simpson38 exponential; do
    "$bin/neph-render" -q c.neph --size 32x18 --method march --rule $rule --steps 300 --light single -o $rule.exr ||
        fail "--rule $rule failed"
done
for rule in riemann-left riemann-right trapezoid simpson simpson38; do
    "$bin/neph-render" --compare $rule.exr exponential.exr --tolerance 0.003 >/dev/null || fail "--rule $rule is far off"
    cmp -s $rule.exr exponential.exr && fail "--rule $rule makes the exponential rule's very picture"
done
march="--size 32x18 --method march"
# differs NAME OPTION...: a picture of these options, another one than plain.exr; the same with one thread.
differs() {
    name=$1
    shift
    # shellcheck disable=SC2086
    "$bin/neph-render" -q c.neph $march "$@" -o "$name.exr" || fail "$* failed"
    # shellcheck disable=SC2086
    OMP_NUM_THREADS=1 "$bin/neph-render" -q c.neph $march "$@" -o one.exr
    cmp -s "$name.exr" one.exr || fail "$*: one thread makes another picture than many"
    cmp -s "$name.exr" plain.exr && fail "$* changes nothing"
    return 0
}
"$bin/neph-render" -q c.neph $march --light single -o plain.exr
for light in powder powder-angle beer-max harris two-pass octaves grid; do
    differs $light --light $light
done
for shadow in cone grid; do
    differs shadow-$shadow --light single --shadow $shadow
done
for jitter in hash blue; do
    differs jitter-$jitter --light single --jitter $jitter
done
differs geometric --light single --step geometric --growth 1.05
differs exponential --light single --step exponential --step-pixels 2
differs shade --light single --shade 0.5
differs powder5 --light powder --powder 5
cmp -s powder.exr powder5.exr && fail "--powder changes nothing"
differs forward --light harris --forward 0.9
cmp -s harris.exr forward.exr && fail "--forward changes nothing"
differs octaves2 --light octaves --light-octaves 2
cmp -s octaves.exr octaves2.exr && fail "--light-octaves changes nothing"
differs ambient --light single --ambient 0.1,0,0
differs emission --light single --emission 0.1,0,0
differs silver --light single --silver
differs lock --light single --lock 3
differs power --light single --alpha-power 3
differs peel --light single --alpha-peel 0.9
differs cutoff --light single --cutoff 0.09

# The methods of 2018.
for method in paper paper-ndt; do
    "$bin/neph-render" -q c.neph --size 32x18 --method $method -o $method.exr --stats >paper.json || fail "$method failed"
    grep -q "\"method\": \"$method\"" paper.json || fail "--stats gives another method than $method"
done
cmp -s paper.exr paper-ndt.exr && fail "paper and paper-ndt are one picture"
"$bin/neph-render" -q c.neph --size 32x18 --method paper --paper-lod --light-resolution 10 -o lod.exr
cmp -s paper.exr lod.exr && fail "--paper-lod changes nothing"

# Opaque things: in front of the cloud they hide it, behind it they change nothing but what shines through.
printf 'v -99 -99 %s\nv 99 -99 %s\nv 99 99 %s\nv -99 99 %s\nf 1 2 3 4\n' 11 11 11 11 >wall.obj
printf 'OFF\n3 1 0\n-1 -1 -2\n1 -1 -2\n0 1 -2\n3 0 1 2\n' >floor.off
look="--size 32x18 --eye 0,1,12 --target 0,1,0 --sun 0,45 --sky none"
for method in "march --light single" "reference --spp 4"; do
    # shellcheck disable=SC2086
    "$bin/neph-render" -q c.neph $look --method $method --mesh wall.obj --mesh-colour 0.5,0.25,0 -o wall.exr --stats \
        >wall.json || fail "--mesh failed"
    # A matt wall in the sun at 45 degrees: 0.5 / pi * pi * cos 45.
    sed -n '/"mean"/,/]/p' wall.json | tr -d '\n ' | grep -q '\[0.3535[0-9]*,0.1767[0-9]*,0.0\]' ||
        fail "$method: a wall in the sun has another radiance: $(cat wall.json)"
done
"$bin/neph-render" -q c.neph $look --method march --mesh floor.off -o floor.exr || fail "an OFF mesh failed"
wrong "more colours than meshes" "$bin/neph-render" c.neph -o a.png --mesh-colour 1,1,1
wrong "from 0 to 1" "$bin/neph-render" c.neph -o a.png --mesh wall.obj --mesh-colour 2,1,1
wrong "no opaque things" "$bin/neph-render" c.neph -o a.png --method paper --mesh wall.obj
wrong "without --mesh" "$bin/neph-render" c.neph -o a.png --method march --step-end adapt
code=0
"$bin/neph-render" c.neph -o a.png --mesh c.pfm 2>err || code=$?
[ "$code" -eq 1 ] || fail "a picture as a mesh ended with $code, not 1"
grep -q "c.pfm: not a mesh" err || fail "a picture as a mesh: $(cat err)"

# The light grid has all scatterings; the reference's mean, at 64 paths a pixel, is within a tenth (of single scattering it
# is a fifth off). Pixel by pixel most of the 0.021 is the reference's noise; single scattering has 0.10.
"$bin/neph-render" -q c.neph --size 32x18 --spp 64 -o truth.exr
"$bin/neph-render" --compare grid.exr truth.exr --tolerance 0.023 >means.json || fail "--light grid is far from the reference"
python3 -c '
import json
m = json.load(open("means.json"))
assert all(abs(a - b) < 0.1 * b for a, b in zip(m["mean_a"], m["mean_b"])), m' ||
    fail "--light grid has another mean than the reference"
wrong "belong to --method march" "$bin/neph-render" c.neph -o a.png --steps 10
wrong "belong to --method reference" "$bin/neph-render" c.neph -o a.png --method march --noise 0.1
wrong "goes with --step geometric" "$bin/neph-render" c.neph -o a.png --method march --growth 1.1
wrong "goes with --light harris" "$bin/neph-render" c.neph -o a.png --method march --forward 0.1
wrong "phase function of their own" "$bin/neph-render" c.neph -o a.png --method march --silver
wrong "belongs to --method paper" "$bin/neph-render" c.neph -o a.png --paper-lod
