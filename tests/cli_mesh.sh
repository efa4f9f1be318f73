# neph-mesh: options, summaries, frames, and bad input: one clear line, exit 1, no output file. $1: programs, $2: source.
set -eu
programs=$(cd "$1" && pwd)
mesh=$programs/neph-mesh
info=$programs/neph-info
meshes=$(cd "$2/examples/meshes" && pwd)
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT

fail() {
    echo "cli_mesh: $1" >&2
    exit 1
}
# make ARGUMENTS: writes $tmp/out.neph, the summary in $tmp/said
make() {
    "$mesh" "$@" -o "$tmp/out.neph" 2> "$tmp/said" || fail "failed: $* ($(cat "$tmp/said"))"
}
said() {
    grep -q -- "$1" "$tmp/said" || fail "the summary lacks \"$1\": $(cat "$tmp/said")"
}
# refused PATTERN ARGUMENTS: exit 1, one line with the pattern, nothing on standard output, no file
refused() {
    pattern=$1
    shift
    rm -f "$tmp/none.neph"
    status=0
    "$mesh" "$@" -o "$tmp/none.neph" > "$tmp/out" 2> "$tmp/said" || status=$?
    [ "$status" = 1 ] || fail "exit $status instead of 1: $* ($(cat "$tmp/said"))"
    [ "$(wc -l < "$tmp/said")" = 1 ] || fail "not one line: $* ($(cat "$tmp/said"))"
    grep -q -- "^neph-mesh: .*$pattern" "$tmp/said" || fail "expected \"$pattern\": $(cat "$tmp/said")"
    [ ! -s "$tmp/out" ] || fail "something on standard output: $*"
    [ ! -e "$tmp/none.neph" ] || fail "an output file is left: $*"
    [ -z "$(find "$tmp" -name 'none.neph*')" ] || fail "a temporary file is left: $*"
}
wrong() {
    status=0
    "$mesh" "$@" -o "$tmp/none.neph" > /dev/null 2> "$tmp/said" || status=$?
    [ "$status" = 2 ] || fail "exit $status instead of 2: $*"
    [ "$(wc -l < "$tmp/said")" = 1 ] || fail "not one line: $*"
}
# rows: the primitives, one a line
rows() {
    "$info" --csv "$tmp/out.neph" | tail -n +2
}

# --- what is said, and how many primitives there are
make "$meshes/suzanne.obj"
said "OBJ, 500 faces, 968 triangles"
said "2 duplicate vertices merged, 0 zero-area and 0 duplicate faces dropped"
said "968 triangles to 370"
said "370 ellipsoids"
[ "$(rows | wc -l)" = 370 ] || fail "not 370 rows"
"$mesh" -q "$meshes/suzanne.obj" -o "$tmp/same.neph" 2> "$tmp/said"
[ ! -s "$tmp/said" ] || fail "-q is not quiet"
cmp -s "$tmp/out.neph" "$tmp/same.neph" || fail "the same command gives other bytes"
"$mesh" -q - < "$meshes/suzanne.glb" > "$tmp/out.neph" || fail "a pipe of GLB is not known"
[ "$(rows | wc -l)" = 370 ] || fail "not 370 rows from a pipe"
make --faces 0 "$meshes/suzanne.stl"
said "968 ellipsoids"
make --faces 100 "$meshes/suzanne.gltf"
said "100 ellipsoids"
make "$meshes/skinned.glb"
said "rest pose"
make "$meshes/instances.gltf"
said "5 nodes place meshes"
make --fill 40 --voxels 64 "$meshes/torus.obj"
said "370 ellipsoids, [1-9][0-9]* spheres inside"
make --fill 40 --voxels 64 "$meshes/open.obj"
said "no inside (it is open"
make --measure "$meshes/torus.obj"
said "covered: 100.00 %"

# --- axes, units, size, place: a triangle whose barycentre is 1,2,3
cat > "$tmp/one.obj" << 'END'
v 0 2 3
v 3 2 3
v 0 2 3.5
v 0 2 2.5
f 1 2 3
f 1 2 4
END
sed 's/^f 1 2 4$//; s/^v 0 2 2.5$//; s/3\.5/3/; s/^v 0 2 3$/v 0 1 3/' "$tmp/one.obj" | sed '3s/.*/v 0 3 3/' > "$tmp/tri.obj"
# first NUMBERS: the first row's x,y,z,a,b,c, to 4 digits
first() {
    is=$(rows | head -1 | awk -F, '{printf "%.4f %.4f %.4f %.4f %.4f %.4f", $3, $4, $5, $6, $7, $8}' | sed 's/-0\.0000/0.0000/g')
    [ "$is" = "$1" ] || fail "row \"$is\", expected \"$1\""
}
# tri.obj: 0,1,3  3,2,3  0,3,3: barycentre 1,2,3, radii sqrt 2, 2, sqrt 2
make --scale 1 "$tmp/tri.obj"
first "1.0000 2.0000 3.0000 1.4142 2.0000 1.4142"
make --scale 2 "$tmp/tri.obj"
first "1.0000 2.0000 3.0000 2.8284 4.0000 2.8284"
make --scale 1 --unit 0.01 "$tmp/tri.obj"
first "0.0100 0.0200 0.0300 0.0141 0.0200 0.0141"
make --scale 1 --up z "$tmp/tri.obj"
first "1.0000 3.0000 -2.0000 1.4142 2.0000 1.4142"
make --scale 1 --size 6 "$tmp/tri.obj"
first "2.0000 4.0000 6.0000 2.8284 4.0000 2.8284"
make --scale 1 --center "$tmp/tri.obj"
first "-0.5000 0.0000 0.0000 1.4142 2.0000 1.4142"
make --scale 1 --no-rotate "$tmp/tri.obj"
rows | head -1 | grep -q ',0,0,0,1$' || fail "--no-rotate turns: $(rows | head -1)"
make --fit --scale 1 --thickness 0.5 "$tmp/tri.obj"
# Steiner: 2/sqrt 3 along y, 2 along x; half of the root of their product across
first "1.0000 2.0000 3.0000 2.0000 1.1547 0.7598"
# far away: the frame takes the way, the primitives keep the shape
sed 's/^v \([0-9]*\) /v 100000\1 /' "$tmp/tri.obj" > "$tmp/far.obj"
make --scale 1 "$tmp/far.obj"
first "-0.5000 0.0000 0.0000 1.4142 2.0000 1.4142"
"$info" --json "$tmp/out.neph" | tr -d ' \n' | grep -q '\[1,0,0,1000001.5\]' || fail "the frame lacks the offset"

# --- repair
cat > "$tmp/bad.obj" << 'END'
v 0 0 0
v 1 0 0
v 0 1 0
v 0 0 0
f 1 2 3
f 4 2 3
f 1 1 2
END
make "$tmp/bad.obj"
said "1 duplicate vertices merged, 1 zero-area and 1 duplicate faces dropped; 1 triangles left"

# --- wrong commands
wrong
wrong --faces 12x "$tmp/tri.obj"
wrong --faces -1 "$tmp/tri.obj"
wrong --scale nan "$tmp/tri.obj"
wrong --fit --no-rotate "$tmp/tri.obj"
wrong --size 2 --unit 3 "$tmp/tri.obj"
wrong --thickness 0.5 "$tmp/tri.obj"
wrong --up x "$tmp/tri.obj"
[ ! -e "$tmp/none.neph" ] || fail "a wrong command left a file"

# --- bad files
refused "cannot open" "$tmp/missing.obj"
refused "cannot" "$tmp"
for suffix in obj ply stl off gltf glb; do
    : > "$tmp/empty.$suffix"
    refused "empty" "$tmp/empty.$suffix"
    head -c 3000 "$mesh" > "$tmp/garbage.$suffix"
    refused "garbage.$suffix" "$tmp/garbage.$suffix"
done
head -c 3000 "$mesh" > "$tmp/garbage"
refused "not a mesh that is known" "$tmp/garbage"
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\n' > "$tmp/a.obj"
refused "no faces" "$tmp/a.obj"
printf 'v 0 0 0\nv 1 0 0\nv nan 1 0\nf 1 2 3\n' > "$tmp/a.obj"
refused "a.obj:3:3: .*finite" "$tmp/a.obj"
printf 'v 0 0 0\nv 1 0 0\nv 1e999 1 0\nf 1 2 3\n' > "$tmp/a.obj"
refused "a.obj:3:3: .*finite" "$tmp/a.obj"
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 7\n' > "$tmp/a.obj"
refused "a.obj:4:7: .*vertex 6 of 3" "$tmp/a.obj"
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -4\n' > "$tmp/a.obj"
refused "a.obj:4:7:" "$tmp/a.obj"
printf 'v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n' > "$tmp/a.obj"
refused "no triangle of the mesh has an area" "$tmp/a.obj"
printf 'OFF\n3 4000000000 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n' > "$tmp/a.off"
refused "a.off:7:1: .*cut off" "$tmp/a.off"
printf 'ply\nformat ascii 1.0\n' > "$tmp/a.ply"
refused "end_header is missing" "$tmp/a.ply"
printf 'ply\nformat ascii 1.0\nproperty float x\nend_header\n' > "$tmp/a.ply"
refused "a.ply:3:9: a property stands before" "$tmp/a.ply"
printf 'ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\nabc' > "$tmp/a.ply"
refused "cut off" "$tmp/a.ply"
for file in suzanne.ply suzanne.stl suzanne.off suzanne.glb suzanne.gltf torus-text.stl; do
    size=$(wc -c < "$meshes/$file")
    for part in 1 4 6 9; do
        head -c $((size * part / 10)) "$meshes/$file" > "$tmp/cut-$file"
        refused "cut-$file" "$tmp/cut-$file"
    done
done

# --- glTF: buffers and where they may lie
cp "$meshes/suzanne.gltf" "$meshes/suzanne.bin" "$tmp"
head -c 5000 "$tmp/suzanne.bin" > "$tmp/short.bin"
sed 's/suzanne.bin/short.bin/' "$tmp/suzanne.gltf" > "$tmp/short.gltf"
refused "short.gltf: the file .*short.bin" "$tmp/short.gltf"
sed 's/suzanne.bin/short.bin/; s/"byteLength" : 11892/"byteLength" : 5000/' "$tmp/suzanne.gltf" > "$tmp/short.gltf"
refused "short.gltf: the file .*\(beyond its buffer\|need\)" "$tmp/short.gltf"
sed 's/suzanne.bin/lost.bin/' "$tmp/suzanne.gltf" > "$tmp/lost.gltf"
refused "lost.bin.*not there" "$tmp/lost.gltf"
mkdir "$tmp/in" "$tmp/in/deep"
cp "$tmp/suzanne.bin" "$tmp/in/deep"
ln -s "$tmp/suzanne.bin" "$tmp/in/link.bin"
for uri in ../suzanne.bin "$tmp/suzanne.bin" http://example.org/suzanne.bin file:///suzanne.bin %2e%2e/suzanne.bin deep/../../suzanne.bin link.bin; do
    sed "s|\"uri\" *: *\"suzanne.bin\"|\"uri\":\"$uri\"|" "$tmp/suzanne.gltf" > "$tmp/in/escape.gltf"
    grep -q "$uri" "$tmp/in/escape.gltf" || fail "the test did not change the URI to $uri"
    refused "outside its own folder" "$tmp/in/escape.gltf"
done
# a current folder that has such a file must not help
(cd "$tmp" && sed 's|suzanne.bin|lost.bin|' suzanne.gltf > in/near.gltf && cp suzanne.bin lost.bin)
(cd "$tmp" && refused "lost.bin.*not there" in/near.gltf)
sed 's|suzanne.bin|deep/suzanne.bin|' "$tmp/suzanne.gltf" > "$tmp/in/below.gltf"
make "$tmp/in/below.gltf"
said "968 triangles to 370"
for name in KHR_draco_mesh_compression EXT_meshopt_compression; do
    sed "s|\"asset\"|\"extensionsRequired\":[\"$name\"],\"asset\"|" "$tmp/suzanne.gltf" > "$tmp/packed.gltf"
    refused "$name.*without compression" "$tmp/packed.gltf"
done
awk 'BEGIN { printf "{\"asset\":{\"version\":\"2.0\",\"extras\":"; for (i = 0; i < 100000; i++) printf "["; print "" }' > "$tmp/deep.gltf"
refused "nests" "$tmp/deep.gltf"
