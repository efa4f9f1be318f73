# Limits (docs/limits.md) hold before memory is taken: files that declare far more than they hold, and commands that ask
# for too much, end with a line and exit code 1 (2 where an option is out of its range), within 700 MB of address space
# (ulimit -v) and ten seconds.
# $1: programs, $2: source folder.
set -eu
bin=$(cd "$1" && pwd)
source=$(cd "$2" && pwd)
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
cd "$tmp"

# The sanitizers need terabytes of address space: there, only the line and the code are looked at.
space=700000
if (ulimit -v $space && "$bin/neph-vdb" --version && "$bin/neph-render" --version) > /dev/null 2>&1; then
    limit="ulimit -v $space"
else
    echo "cli_limits: the programs do not start within $space KiB of address space (sanitizers?): it is not limited"
    limit=true
fi

fail() {
    echo "cli_limits: $1" >&2
    [ ! -s err ] || head -n 5 err | cut -c 1-300 >&2
    exit 1
}

count=0
# refused CODE PATTERN PROGRAM ARGUMENT...: ends with that code, and each line is the program's; one has the pattern.
refused() {
    wanted=$1
    pattern=$2
    program=$3
    shift 3
    code=0
    ($limit && exec timeout 10 "$bin/$program" "$@") > out 2> err < /dev/null || code=$?
    [ $code = "$wanted" ] || fail "$program $*: exit code $code, not $wanted"
    grep -q -e "$pattern" err || fail "$program $*: its line does not say \"$pattern\""
    ! grep -v "^$program: " err || fail "$program $*: a line that is not its own"
    [ ! -s out ] || fail "$program $*: an output all the same"
    count=$((count + 1))
}

python3 - "$source" << 'END'
import json, os, struct, sys, zlib

def write(name, data):
    with open(name, "wb") as file:
        file.write(data)

def sparse(name, start, size):
    with open(name, "wb") as file:
        file.write(start)
        file.truncate(size)

# .neph: huge counts with right CRCs (layout: docs/neph-format.md), and a sparse file of 5 GiB
with open(sys.argv[1] + "/tests/frozen/v1.0-two-clouds.neph", "rb") as file:
    good = file.read()
sparse("sparse.neph", good, 5 << 30)
for name, at in (("claim-%d.neph" % i, i) for i in range(8, 32, 4)):
    data = bytearray(good)
    struct.pack_into("<I", data, at, 0xFFFFFFF0)
    write(name, data)

# pictures: 16,000 x 16,000 pixels in a hundred bytes
def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

header = struct.pack(">IIBBBBB", 16000, 16000, 16, 6, 0, 0, 0)
write("huge.png", b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(b"0")) + chunk(b"IEND", b""))
header = struct.pack(">IIBBBBB", 0x7FFFFFFF, 0x7FFFFFFF, 16, 6, 0, 0, 0)
write("wide.png", b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(b"0")) + chunk(b"IEND", b""))
write("huge.pfm", b"PF\n16384 16384\n-1.0\n" + bytes(12))
write("wide.pfm", b"PF\n2000000000 2000000000\n-1.0\n" + bytes(12))

# raw volumes
sparse("big.raw", struct.pack("<3I", 2000, 2000, 1000), 12 + 4 * 2000 * 2000 * 1000)
write("claim.raw", struct.pack("<3I", 65534, 65534, 65534) + bytes(16))
write("wide.raw", struct.pack("<3I", 0xFFFFFFFF, 1, 1) + bytes(16))

# meshes
ply = "ply\nformat binary_little_endian 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\n" \
      "element face %d\nproperty list uint int vertex_indices\nend_header\n"
write("vertices.ply", (ply % (4294967295, 1)).encode() + bytes(36))
write("faces.ply", (ply % (3, 4294967295)).encode() + bytes(36))
write("corners.ply", (ply % (3, 1)).encode() + bytes(36) + struct.pack("<Iiii", 4294967295, 0, 1, 2))
write("claim.stl", bytes(80) + struct.pack("<I", 4294967295) + bytes(50))
write("claim.off", b"OFF\n4294967295 4294967295 0\n0 0 0\n")
write("corner.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4294967295\n")
sparse("sparse.obj", b"v 0 0 0\n", 5 << 30)

def gltf(name, **changes):
    data = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
            "bufferViews": [{"buffer": 0, "byteLength": 36}],
            "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64," + "A" * 48}]}
    data.update(changes)
    write(name, json.dumps(data).encode())

gltf("count.gltf", accessors=[{"bufferView": 0, "componentType": 5126, "count": 2000000000, "type": "VEC3"}])
gltf("zeros.gltf", accessors=[{"componentType": 5126, "count": 2000000000, "type": "VEC3"}])
gltf("buffer.gltf", buffers=[{"byteLength": 4000000000, "uri": "data:application/octet-stream;base64,AAAA"}])
gltf("file.gltf", buffers=[{"byteLength": 36, "uri": "sparse.bin"}])
gltf("outside.gltf", buffers=[{"byteLength": 36, "uri": "../../etc/passwd"}])
sparse("sparse.bin", b"", 5 << 30)
write("deep.gltf", b"[" * 100000)
write("deep.json", b'{"clouds": ' + b"[" * 100000)

# scenes
write("copies.json", b'{"scene": 1, "clouds": [' + b",".join(
    b'{"generator": "neph-gauss", "options": {"count": 10000000}, "at": [%d,0,0]}' % i for i in range(40)) + b"]}")
sparse("sparse.json", b"{", 5 << 30)

# grammars
write("grow.lsys", b"axiom X\niterations 100000\nX -> X X\n")
write("parameters.lsys", b"axiom A(" + b",".join([b"1"] * 1000) + b")\n")
write("brackets.lsys", b"axiom X\niterations 100000\nX -> [ X\n")
write("quiet.lsys", b"axiom x\niterations 100\nx -> x x\n")
sparse("sparse.lsys", b"axiom X\n", 5 << 30)

# OpenVDB: a damaged count
with open(sys.argv[1] + "/tests/frozen/vdb/fog.vdb", "rb") as file:
    vdb = file.read()
for i, at in enumerate((45, 60, 100)):
    data = bytearray(vdb)
    data[at:at + 8] = b"\xff\xff\xff\x7f\xff\xff\xff\x7f"
    write("damaged%d.vdb" % i, data)
END

refused 1 "limit of" neph-info sparse.neph
refused 1 "limit of" neph-edit sparse.neph -o x.neph
for file in claim-*.neph; do
    refused 1 "$file" neph-info "$file"
done
"$bin/neph-gauss" -q --count 3 -o good.neph
for file in huge.png wide.png huge.pfm wide.pfm; do
    refused 1 "$file" neph-render --compare "$file" "$file"
done
refused 2 "16384" neph-render good.neph --size 20000x20000 -o x.png
refused 1 "memory" neph-render good.neph --size 16384x16384 --spp 1 -o x.png
refused 1 "limit of" neph-vdb big.raw -o x.neph
refused 1 "big.raw\|memory" neph-vdb big.raw --max-memory 1000000000000 -o x.neph
refused 1 "has .* bytes" neph-vdb claim.raw -o x.neph
refused 1 "65534" neph-vdb wide.raw -o x.neph
for file in damaged*.vdb; do
    refused 1 "$file" neph-vdb "$file" -o x.neph
done
for file in vertices.ply faces.ply corners.ply claim.stl claim.off corner.obj count.gltf zeros.gltf buffer.gltf \
    outside.gltf deep.gltf; do
    refused 1 "$file" neph-mesh "$file" -o x.neph
done
refused 1 "limit of" neph-mesh sparse.obj -o x.neph
refused 1 "sparse.bin" neph-mesh file.gltf -o x.neph
for file in deep.json sparse.json copies.json; do
    refused 1 "$file" neph-info "$file"
done
refused 1 "limit of" neph-lsys sparse.lsys -o x.neph
refused 1 "primitives" neph-lsys grow.lsys -o x.neph
refused 1 "memory\|primitives" neph-lsys grow.lsys --max-primitives 1000000000000 -o x.neph
for file in parameters brackets; do
    refused 1 "$file.lsys" neph-lsys $file.lsys -o x.neph
done
refused 2 "10000000" neph-gauss --count 10000001 -o x.neph
refused 2 "100000000" neph-gauss --count 10000000 --no-hollow --no-prune --field 100 -o x.neph
refused 2 "100000" neph-meta --count 100001 -o x.neph
[ ! -e x.neph ] && [ ! -e x.png ] || fail "something that was refused made a file"
echo "cli_limits: $count refused"
