# Scenes: what --save-scene writes makes the same again, generators give the bytes of their programs, copies, overrides,
# and mistakes of one line with their place.
set -eu
bin=$(cd "$1" && pwd)
source=$(cd "$2" && pwd)
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cd "$dir"

fail() {
    echo "cli_scene: $1" >&2
    exit 1
}
# refused TEXT COMMAND...: exits 1 with one line that holds TEXT.
refused() {
    text=$1
    shift
    code=0
    "$@" >out 2>err || code=$?
    [ "$code" -eq 1 ] || fail "$* ended with $code, not 1: $(cat err)"
    [ "$(wc -l <err)" -eq 1 ] || fail "$* gave more than one line"
    grep -q -F -e "$text" err || fail "$*: \"$(cat err)\" does not say \"$text\""
}
wrong() {
    text=$1
    shift
    code=0
    "$@" >out 2>err || code=$?
    [ "$code" -eq 2 ] || fail "$* ended with $code, not 2"
    grep -q -F -e "$text" err || fail "$*: \"$(cat err)\" does not say \"$text\""
}
# clouds FILE: what neph-info tells of the clouds, the file's own line left out.
clouds() { "$bin/neph-info" --json "$1" | sed 1d; }

# Every generator: the scene that it saves tells of the same clouds, provenance and bounds included, and holds the same
# primitives to the last bit (nine digits tell any two floats apart).
mkdir in
cp "$source/examples/castellanus.lsys" "$source/examples/meshes/suzanne.obj" in/
generators="gauss meta layer lsys mesh"
"$bin/neph-gauss" -q --count 40 --seed 3 --sigma 3.80,1.7,3e0 --field 3 --no-prune -o gauss.neph --save-scene gauss.json
"$bin/neph-meta" -q --count 9 --kappa .25 --at 1,2,3 -o meta.neph --save-scene meta.json
"$bin/neph-layer" -q --preset fog --seed 18446744073709551615 -o layer.neph --save-scene layer.json
"$bin/neph-lsys" -q in/castellanus.lsys --angle 20..40 --max-primitives 2000000 -o lsys.neph --save-scene lsys.json
"$bin/neph-mesh" -q in/suzanne.obj --faces 100 --fit --seed 9 -o mesh.neph --save-scene mesh.json
grep -q '"max-primitives": 2000000' lsys.json || fail "a scene drops the limit that its grammar needs"
for name in $generators; do
    clouds $name.neph >a
    clouds $name.json >b
    cmp -s a b || fail "neph-$name --save-scene: the scene makes other clouds: $(diff a b | head -n 4)"
    "$bin/neph-info" --csv $name.neph >a
    "$bin/neph-info" --csv $name.json >b
    cmp -s a b || fail "neph-$name --save-scene: the scene makes other primitives"
done
# Pictures: a file and a scene, seen by both programs, give the same bytes when their saved scene is shown.
small="--size 32x18"
"$bin/neph-render" -q gauss.neph $small --spp 4 --sun 100,20.5 --sky 0.1,0.2,0.3 -o a.exr --save-scene in/shown.json 2>err
"$bin/neph-render" -q in/shown.json --allow-outside --spp 4 -o b.exr
cmp -s a.exr b.exr || fail "neph-render --save-scene: the scene gives another picture"
"$bin/neph-render" -q gauss.neph $small --spp 4 --visibility 30 --air-height 12.5 -o air.exr --save-scene in/air.json
grep -q '"air": {"visibility": 30, "height": 12.5}' in/air.json || fail "--save-scene drops the air"
"$bin/neph-render" -q in/air.json --allow-outside --spp 4 -o air2.exr
cmp -s air.exr air2.exr || fail "a scene's air gives another picture"
"$bin/neph-render" -q gauss.neph $small --spp 4 -o clear.exr
cmp -s air.exr clear.exr && fail "--visibility changes nothing"
"$bin/neph-render" -q in/air.json --allow-outside --spp 4 --visibility 0 -o clear2.exr
cmp -s clear.exr clear2.exr || fail "--visibility 0 does not take a scene's air away"
"$bin/neph-render" in/air.json --allow-outside --method paper -o paper.png 2>err
grep -q "does not show the scene's air" err || fail "--method paper drops the air and says nothing"
wrong "have no air" "$bin/neph-render" gauss.neph --method paper --visibility 30 -o paper.png
wrong "there is no air" "$bin/neph-render" gauss.neph --air-height 30 -o x.png
wrong "visibility and height" "$bin/neph-render" gauss.neph --visibility 1e-6 -o x.png
printf '{"scene": 1, "clouds": [], "air": {"height": 3}}' >in/bad.json
refused "air: has no visibility" "$bin/neph-render" in/bad.json -o x.png
"$bin/neph-render" -q in/shown.json --allow-outside --spp 4 --sun 10,60 -o c.exr --save-scene moved.json
cmp -s a.exr c.exr && fail "--sun does not override the scene's"
"$bin/neph-render" -q moved.json --spp 4 -o d.exr
cmp -s c.exr d.exr || fail "a scene saved from a scene gives another picture"
"$bin/neph-view" -q gauss.json $small --headless --light-grid 8 --samples 1 --exposure 1 -o a.png --save-scene view.json
"$bin/neph-view" -q view.json --headless --light-grid 8 --samples 1 -o b.png
cmp -s a.png b.png || fail "neph-view --save-scene: the scene gives another picture"
# Meshes: --mesh becomes a mesh of the saved scene, beside those that it has, and gives the same bytes by either method;
# neph-view shows and keeps them, and all that do not show them say so.
printf 'OFF\n3 1 0\n-30 -30 -2\n30 -30 -2\n0 40 -2\n3 0 1 2\n' >in/floor.off
printf 'v -3 -1 6\nv 3 -1 6\nv 0 5 6\nf 1 2 3\n' >wall.obj
small="$small --eye 2,6,40 --target 0,1,0"
for method in "march --light single" "reference --spp 2"; do
    # shellcheck disable=SC2086
    "$bin/neph-render" -q gauss.json $small --method $method --mesh in/floor.off --mesh-colour 0.1,0.7,0.3 -o a.exr \
        --save-scene in/floor.json 2>/dev/null
    # shellcheck disable=SC2086
    "$bin/neph-render" -q in/floor.json --allow-outside --method $method --mesh wall.obj -o b.exr --save-scene both.json
    # shellcheck disable=SC2086
    "$bin/neph-render" -q in/floor.json --allow-outside --method $method -o c.exr
    # shellcheck disable=SC2086
    "$bin/neph-render" -q both.json --method $method -o d.exr
    # shellcheck disable=SC2086
    "$bin/neph-render" -q gauss.json $small --method $method -o e.exr
    cmp -s a.exr c.exr || fail "--mesh --save-scene, $method: the scene gives another picture"
    cmp -s b.exr d.exr || fail "--mesh beside a scene's, $method: the saved scene gives another picture"
    cmp -s a.exr e.exr && fail "$method: the scene's mesh is not in the picture"
    cmp -s a.exr b.exr && fail "$method: --mesh is not in the picture of a scene with meshes"
done
"$bin/neph-info" --json both.json | grep -q '"meshes": \[{"file": "in/floor.off"}, {"file": "wall.obj"}\]' ||
    fail "neph-info does not name the meshes: $("$bin/neph-info" --json both.json)"
# Placed: the wall of the file, turned, moved and in centimetres, is the wall that stands there.
printf 'v 500 -100 -300\nv 500 -100 300\nv 500 500 0\nf 1 2 3\n' >turned.obj
sed 's|"file": "wall.obj"|"file": "turned.obj", "unit": 0.01, "rotate": [0, -90, 0], "translate": [0, 0, 1], "albedo": 0.5|' both.json \
    >placed.json
"$bin/neph-render" -q placed.json --method march --light single -o a.exr
"$bin/neph-render" -q both.json --method march --light single -o b.exr
"$bin/neph-render" --compare a.exr b.exr --tolerance 1e-6 >/dev/null || fail "a mesh does not stand where its place says"
note="note: meshes of the scene are"
"$bin/neph-view" both.json --headless --light-grid 8 --samples 1 -o a.png --save-scene view.json 2>err
! grep -q "$note" err || fail "neph-view draws meshes and says that it does not"
"$bin/neph-view" gauss.json --headless --light-grid 8 --samples 1 -o b.png 2>err
! cmp -s a.png b.png || fail "neph-view does not show the scene's meshes"
grep -q '"file": "in/floor.off"' view.json || fail "neph-view --save-scene loses the meshes"
"$bin/neph-vdb" both.json --resolution 16 -o x.vdb 2>err
grep -q "$note left out" err || fail "neph-vdb says nothing of meshes"
"$bin/neph-edit" both.json -o x.neph 2>err
grep -q "$note left out" err || fail "neph-edit says nothing of meshes"
"$bin/neph-render" both.json --method paper -o x.exr 2>err
grep -q "$note not shown" err || fail "--method paper says nothing of meshes"
rm x.vdb x.neph x.exr
refused "leaves the scene's folder" "$bin/neph-render" -q in/shown.json -o x.exr
"$bin/neph-render" -q - --size 8x8 --spp 1 -o x.exr <gauss.json || fail "a scene is not read from standard input"
rm x.exr
"$bin/neph-edit" -q gauss.json --translate 5,0,0 -o edited.neph --save-scene edited.json
clouds edited.neph >a
clouds edited.json >b
cmp -s a b || fail "neph-edit --save-scene names something else than it wrote"

# Copies stand where they should: a sphere of radius 1, moved, scaled, then moved with its entry.
"$bin/neph-gauss" -q --count 1 --sigma 0,0,0 --max-radius 1 --no-hollow --model uniform -o ball.neph
cat >copies.json <<'END'
{"scene": 1, "clouds": [
  {"file": "ball.neph", "name": "ball", "translate": [100, 0, 0], "medium": {"extinction": 3},
   "copies": [{}, {"translate": [10, 0, 0], "scale": 2}, {"scale": [1, 4, 1], "translate": [0, 50, 0]},
              {"scale": 2, "keep-depth": true, "rotate": [0, 90, 0], "translate": [0, 0, 7]}]}],
 "medium": {"extinction": 9, "albedo": 0.5}}
END
"$bin/neph-info" --json copies.json | tr -d '\n' | sed 's/{"name"/\n&/g' >told
sed -n 2p told | grep -q '"bounds": \[\[99, -1, -1\], \[101, 1, 1\]\]' || fail "copy 0: $(sed -n 2p told)"
sed -n 3p told | grep -q '"bounds": \[\[108, -2, -2\], \[112, 2, 2\]\]' || fail "copy 1: $(sed -n 3p told)"
sed -n 4p told | grep -q '"bounds": \[\[99, 46, -1\], \[101, 54, 1\]\]' || fail "copy 2: $(sed -n 4p told)"
sed -n 4p told | grep -q '"ellipsoids": 1' || fail "unequal scaling left a sphere"
sed -n 5p told | grep -q '"bounds": \[\[98, -2, 5\], \[102, 2, 9\]\]' || fail "copy 3: $(sed -n 5p told)"
sed -n 5p told | grep -q '"extinction": 1.5' || fail "keep-depth does not halve the extinction"
sed -n 2p told | grep -q '"extinction": 3, "albedo": 0.5' || fail "the entry's medium does not stand over the scene's"
grep -q '"ball-2"' told && grep -q '"ball-4"' told || fail "copies have no names of their own"

# Edits change single clouds after all are made, about their own origins, and hide them; a mistake names its place. They may
# be left to a program that shows them.
cat >edits.json <<'END'
{"scene": 1, "clouds": [{"file": "ball.neph", "name": "ball", "copies": [{}, {"translate": [10, 0, 0]}, {"translate": [20, 0, 0]}]}],
 "edits": [{"cloud": "ball-2", "scale": 2, "translate": [0, 3, 0], "medium": {"extinction": 7}}, {"cloud": "ball", "hidden": true}]}
END
"$bin/neph-info" --json edits.json | tr -d '\n' | sed 's/{"name"/\n&/g' >told
[ "$(grep -c '"name"' told)" -eq 2 ] || fail "a hidden cloud is there: $(cat told)"
sed -n 2p told | grep -q '"bounds": \[\[8, 1, -2\], \[12, 5, 2\]\]' || fail "an edit does not scale and move: $(sed -n 2p told)"
sed -n 2p told | grep -q '"extinction": 7' || fail "an edit does not change the medium: $(sed -n 2p told)"
"$bin/neph-edit" -q edits.json --leave-edits 3 -o left.neph
"$bin/neph-info" --json left.neph | grep -q '"ball".*' || fail "--leave-edits hides a cloud"
sed 's/"ball-2"/"bull"/' edits.json >bad.json
refused 'bad.json: edits[0].cloud: there is no cloud "bull"' "$bin/neph-info" bad.json
sed 's/"extinction": 7/"extinction": -7/' edits.json >bad.json
refused 'bad.json: edits[0].medium.extinction' "$bin/neph-edit" bad.json --leave-edits 3 -o x.neph
# The ground and the time of day are the command line's.
view="--headless --size 32x18 --light-grid 8 --samples 1 --eye 2,6,40 --target 0,1,0"
# shellcheck disable=SC2086
"$bin/neph-view" -q gauss.neph $view --ground -1 --ground-colour 0.1,0.2,0.3 --day 9 --latitude 30 -o a.pfm --save-scene ground.json
grep -q '"ground": {"height": -1, "albedo": \[0.1, 0.2, 0.3' ground.json || fail "the ground is not saved: $(cat ground.json)"
grep -q '"day": {"hour": 9, "latitude": 30, "declination": 0}' ground.json || fail "the day is not saved: $(cat ground.json)"
"$bin/neph-view" -q ground.json --headless -o b.pfm
cmp -s a.pfm b.pfm || fail "the ground and the day of a scene are another picture"
# shellcheck disable=SC2086
"$bin/neph-render" -q gauss.neph --size 32x18 --eye 2,6,40 --target 0,1,0 --method march --light single --ground -1 \
    --ground-colour 0.1,0.2,0.3 -o a.pfm
"$bin/neph-render" -q ground.json --sun 60,40 --method march --light single -o b.pfm
"$bin/neph-render" -q ground.json --method march --light single -o c.pfm
"$bin/neph-render" --compare a.pfm b.pfm --tolerance 0.02 >/dev/null || fail "neph-render shows another ground"
! cmp -s b.pfm c.pfm || fail "neph-render does not know the scene's time of day"

# A thousand copies of one file (of three clouds) and a thousand generated clouds take a tenth of a second; ten seconds of a
# processor would be a mistake in the way they are made.
awk 'BEGIN { printf "{\"scene\": 1, \"clouds\": [{\"file\": \"gauss.neph\", \"copies\": [{}"
    for (i = 1; i < 1000; i++) printf ", {\"translate\": [%d, 0, %d]}", i, i % 37
    printf "]}"
    for (i = 0; i < 1000; i++)
        printf ", {\"generator\": \"neph-gauss\", \"options\": {\"seed\": %d, \"count\": 4}, \"translate\": [0, 0, %d]}", i, i
    print "]}" }' >many.json
slow=${NEPHELE_SLOW:-1} # so many times slower than usual may the programs be (valgrind, sanitizers)
(ulimit -t $((10 * slow)) && exec timeout $((60 * slow)) "$bin/neph-info" --csv many.json) >many.csv || fail "4000 clouds take too long, or fail"
[ "$(sed 1d many.csv | cut -d, -f1 | sort -u | wc -l)" -eq 4000 ] || fail "4000 clouds are not 4000"

# The shipped scenes can be read, and are what they are said to be.
for scene in "$source"/examples/scenes/*.json "$source"/examples/scenes/bench/*.json; do
    "$bin/neph-info" --json "$scene" >told || fail "$scene cannot be read"
done
primitives() { "$bin/neph-info" --csv "$source/examples/scenes/bench/$1.json" | sed 1d | wc -l; }
[ "$(primitives cumulus)" -eq 35 ] || fail "bench/cumulus.json has $(primitives cumulus) spheres, not 35"
[ "$(primitives field)" -eq 3500 ] || fail "bench/field.json has $(primitives field) spheres, not 3500"
[ "$(primitives mesh)" -eq 350 ] || fail "bench/mesh.json has $(primitives mesh) ellipsoids, not 350"

# Mistakes.
try() {
    printf '%s' "$2" >bad.json
    refused "bad.json:$1" "$bin/neph-render" bad.json -o x.png
}
cloud='{"scene": 1, "clouds": [{"generator": "neph-gauss"'
try '1:' '{'
mesh='{"scene": 1, "clouds": [], "meshes": [{"file": '
try ' meshes[0]: "../x.obj" leaves' "$mesh\"../x.obj\"}]}"
ln -s /etc/passwd link.obj
try ' meshes[0]: "link.obj" is a link' "$mesh\"link.obj\"}]}"
try ' meshes[0]: none.obj: cannot open' "$mesh\"none.obj\"}]}"
try ' meshes[0]: gauss.neph: not a mesh' "$mesh\"gauss.neph\"}]}"
printf 'v 0 0 0\nf 1 1 2\n' >bad.obj
try ' meshes[1]: bad.obj:2:' "$mesh\"wall.obj\"}, {\"file\": \"bad.obj\"}]}"
try ' clouds[0]: "../x.neph" leaves' '{"scene": 1, "clouds": [{"file": "../x.neph"}]}'
try ' clouds[0]: "/etc/passwd" leaves' '{"scene": 1, "clouds": [{"file": "/etc/passwd"}]}'
try ' clouds[0]: none.neph: cannot open' '{"scene": 1, "clouds": [{"file": "none.neph"}]}'
try ' clouds[0]: bad.json: ' '{"scene": 1, "clouds": [{"file": "bad.json"}]}'
try ' clouds[0].options.cuont: there is no such option' "$cloud, \"options\": {\"cuont\": 3}}]}"
try ' clouds[0].options.output: there is no such option' "$cloud, \"options\": {\"output\": \"x\"}}]}"
try ' clouds[0].options.save-scene: there is no such option' "$cloud, \"options\": {\"save-scene\": \"x\"}}]}"
try ' clouds[0].options.count: --count 0: must be' "$cloud, \"options\": {\"count\": 0}}]}"
try ' clouds[0].options.count: --count "x"' "$cloud, \"options\": {\"count\": \"x\"}}]}"
try ' clouds[0].options.no-prune: --no-prune is a flag' "$cloud, \"options\": {\"no-prune\": 1}}]}"
try ' clouds[0].options.count: --count takes a value' "$cloud, \"options\": {\"count\": true}}]}"
try ' clouds[0]: --area' "$cloud, \"options\": {\"area\": [9, 9]}}]}"
try ' clouds[0]: neph-gauss takes no input' "$cloud, \"input\": \"in/castellanus.lsys\"}]}"
try ' clouds[0]: neph-lsys needs a file' '{"scene": 1, "clouds": [{"generator": "neph-lsys"}]}'
try ' clouds[0]: there is no generator "neph-x"' '{"scene": 1, "clouds": [{"generator": "neph-x"}]}'
try ' clouds[0]: --fit --no-rotate' \
    '{"scene": 1, "clouds": [{"generator": "neph-mesh", "input": "in/suzanne.obj", "options": {"fit": true, "no-rotate": true}}]}'
try ' clouds[0].medium.at: ' "$cloud, \"medium\": {\"at\": [1, 2, 3]}}]}"
try ' medium.albedo: --albedo 2' "$cloud}], \"medium\": {\"albedo\": 2}}"
# More than may be held, by one generator or by stretched copies; told before memory is taken.
try ' clouds[0]: --field' "$cloud, \"options\": {\"field\": 10000, \"count\": 10000}}]}"
awk 'BEGIN { printf "{\"scene\": 1, \"clouds\": [{\"generator\": \"neph-gauss\", \"scale\": [1, 2, 1],"
    printf "\"options\": {\"count\": 20000, \"no-hollow\": true, \"no-prune\": true}, \"copies\": [{}"
    for (i = 1; i < 600; i++) printf ", {}"
    print "]}]}" }' >big.json
refused "more than 10000000 primitives" "$bin/neph-info" big.json
[ ! -e x.png ] || fail "a refused scene left a picture"

wrong "cannot name standard input" "$bin/neph-render" - -o x.png --save-scene x.json </dev/null
wrong "name the mesh's file" "$bin/neph-render" gauss.neph --mesh - -o x.png --save-scene x.json <wall.obj
wrong "needs a file's name" "$bin/neph-gauss" -o x.neph --save-scene -
wrong "give -o FILE" "$bin/neph-edit" gauss.neph --save-scene x.json
# What a program leaves out of a scene is said.
"$bin/neph-view" "$source/examples/scenes/lantern.json" --size 8x8 --headless --light-grid 4 --samples 1 -o x.png 2>err
grep -q "does not show the scene's lamp" err || fail "neph-view says nothing of the lamp"
lantern="$source/examples/scenes/lantern.json --size 8x8 --steps 9 --method march"
for light in "grid --light-resolution 4" "single --shadow grid --light-resolution 4"; do
    # shellcheck disable=SC2086
    "$bin/neph-render" $lantern --light $light -o x.png 2>err
    grep -q "do not show the scene's lamp" err || fail "neph-render --light $light says nothing of the lamp"
done
# shellcheck disable=SC2086
"$bin/neph-render" $lantern --light single -o a.pfm 2>err
grep -q "lamp" err && fail "--light single says that it leaves the lamp out"
# shellcheck disable=SC2086
"$bin/neph-render" -q $lantern --light single --lamp-intensity 0,0,0 -o b.pfm
cmp -s a.pfm b.pfm && fail "--light single does not show the scene's lamp"
echo "cli_scene: done"
