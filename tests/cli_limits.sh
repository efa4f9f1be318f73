# Limits (docs/limits.md) hold before memory is taken: files that declare far more than they hold, and commands that ask
# for too much, end with a line and exit code 1 (2 where an option is out of its range), within 700 MB of address space
# (ulimit -v) and ten seconds of a processor (ulimit -t: on a busy machine a minute may pass).
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
    (ulimit -t 10 && $limit && exec timeout 60 "$bin/$program" "$@") > out 2> err < /dev/null || code=$?
    [ $code = "$wanted" ] || fail "$program $*: exit code $code, not $wanted"
    grep -q -e "$pattern" err || fail "$program $*: its line does not say \"$pattern\""
    ! grep -v "^$program: " err || fail "$program $*: a line that is not its own"
    [ ! -s out ] || fail "$program $*: an output all the same"
    count=$((count + 1))
}

"$bin/neph-layer" -q -o layer.neph
python3 - "$source" << 'END'
import json, os, struct, sys, zlib

def write(name, data):
    with open(name, "wb") as file:
        file.write(data)

def sparse(name, start, size):
    with open(name, "wb") as file:
        file.write(start)
        file.truncate(size)

# .neph (layout: docs/neph-format.md): a sparse file of 5 GiB, and huge numbers in fields of the header, of a row of the table
# and of chunks. The CRCs are made right, so that the number itself is what is met.
with open(sys.argv[1] + "/tests/frozen/v1.0-two-clouds.neph", "rb") as file:
    good = file.read()
with open("layer.neph", "rb") as file:
    layer = file.read()
sparse("sparse.neph", good, 5 << 30)

def rows(data):
    return range(32, 32 + 32 * struct.unpack_from("<I", data, 12)[0], 32)

def renew(data):
    for row in rows(data):
        start, length = struct.unpack_from("<QQ", data, row + 16)
        struct.pack_into("<I", data, row + 12, zlib.crc32(data[start:start + length]))
    end = rows(data)[-1] + 32
    struct.pack_into("<I", data, end, zlib.crc32(data[:end]))

def start_of(data, kind):
    return next(struct.unpack_from("<Q", data, row + 16)[0] for row in rows(data) if data[row:row + 4] == kind)

def claim(name, whole, at, crc=True, form="<I", value=0xFFFFFFF0):
    data = bytearray(whole)
    struct.pack_into(form, data, at, value)
    if crc:
        renew(data)
    write("claim-%s.neph" % name, data)

clouds = start_of(good, b"CLUD")
claim("chunks", good, 12, crc=False) # the table's end, and so its CRC's place, would be beyond the file
claim("size", good, 16, form="<Q", value=0xFFFFFFFFFFFFFFF0)
claim("record", good, clouds)
claim("clouds", good, clouds + 4)
claim("lists", good, clouds + 8)
claim("list", good, clouds + 16 + 136)
claim("name", good, clouds + 16 + 144)
claim("layers", layer, start_of(layer, b"LAYR") + 4)
# Of a chunk's place only the table's CRC can be made right.
data = bytearray(good)
struct.pack_into("<Q", data, 32 + 24, 0xFFFFFFFFFFFFFFF0)
end = rows(data)[-1] + 32
struct.pack_into("<I", data, end, zlib.crc32(data[:end]))
write("claim-length.neph", data)

# pictures: 16,000 x 16,000 pixels in a hundred bytes
def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

header = struct.pack(">IIBBBBB", 16000, 16000, 16, 6, 0, 0, 0)
write("huge.png", b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(b"0")) + chunk(b"IEND", b""))
header = struct.pack(">IIBBBBB", 0x7FFFFFFF, 0x7FFFFFFF, 16, 6, 0, 0, 0)
write("wide.png", b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(b"0")) + chunk(b"IEND", b""))
write("huge.pfm", b"PF\n16384 16384\n-1.0\n" + bytes(12))
write("wide.pfm", b"PF\n999999 999999\n-1.0\n" + bytes(12))
write("digits.pfm", b"PF\n2000000000 2000000000\n-1.0\n" + bytes(12))

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
gltf("buffer.gltf", buffers=[{"byteLength": 4000000000, "uri": "small.bin"}])
gltf("view.gltf", bufferViews=[{"buffer": 0, "byteLength": 4000000000}])
write("small.bin", bytes(36))
gltf("file.gltf", buffers=[{"byteLength": 36, "uri": "sparse.bin"}])
gltf("outside.gltf", buffers=[{"byteLength": 36, "uri": "../../etc/passwd"}])
sparse("sparse.bin", b"", 5 << 30)
write("deep.gltf", b"[" * 100000)
write("deep.json", b'{"clouds": ' + b"[" * 100000)

# scenes
def scene(name, clouds):
    write(name, json.dumps({"scene": 1, "clouds": clouds}).encode())

heap = {"generator": "neph-gauss", "options": {"count": 10000, "no-hollow": True, "no-prune": True}}
# Copies that are only moved share their primitives; stretched ones do not.
scene("copies.json", [dict(heap, scale=[1, 2, 1], copies=[{"translate": [i, 0, 0]} for i in range(1001)])])
scene("places.json", [dict(heap, copies=[{}] * 100001)])
scene("values.json", [dict(heap, copies=[{"translate": [0, 0, 0]}] * 100001)])
sparse("long.json", b"{", 17 << 20)
sparse("sparse.json", b"{", 5 << 30)

# grammars
write("grow.lsys", b"axiom X\niterations 100000\nX -> X X\n")
write("parameters.lsys", b"axiom A(" + b",".join([b"1"] * 1000) + b")\n")
write("brackets.lsys", b"axiom X\niterations 60000\nX -> [ [ X ] ]\n")
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

refused 1 "limit of 1073741824" neph-info sparse.neph
refused 1 "limit of 1073741824" neph-edit sparse.neph -o x.neph
# claim NAME REASON
claim() { refused 1 "claim-$1.neph: .*$2" neph-info "claim-$1.neph"; }
claim chunks "the number of chunks does not fit"
claim size "of 18446744073709551600"
claim length "chunk 0 (CLUD.* is not where it must be"
claim record "records of a size that it must not have"
claim clouds "declares a number of clouds that it does not hold"
claim lists "declares lists that are not those there"
claim list "names a list that is not there"
claim name "its name is not"
claim layers "LAYR.*declares a number of records that it does not hold"
"$bin/neph-gauss" -q --count 3 -o good.neph
picture() { refused 1 "$1: .*$2" neph-render --compare "$1" "$1"; }
picture huge.png "so few bytes cannot hold so many pixels"
picture wide.png "Invalid IHDR"
picture huge.pfm "has 12 bytes of pixels and needs 3221225472"
picture wide.pfm "999999x999999 pixels: each side must be from 1 to 16384"
picture digits.pfm "not a PFM header"
refused 2 "from 1 to 16384" neph-render good.neph --size 20000x20000 -o x.png
refused 1 "not enough memory" neph-render good.neph --size 16384x16384 --spp 1 -o x.png
refused 1 "limit of 4294967296" neph-vdb big.raw -o x.neph
refused 1 "not enough memory" neph-vdb big.raw --max-memory 1000000000000 -o x.neph
refused 1 "has 1125796830773228 bytes, not 28" neph-vdb claim.raw -o x.neph
refused 1 "from 1 to 65534" neph-vdb wide.raw -o x.neph
refused 1 "damaged0.vdb: holds no grid at all" neph-vdb damaged0.vdb -o x.neph
refused 1 "damaged1.vdb: reading it takes more than" neph-vdb damaged1.vdb -o x.neph
refused 1 "damaged2.vdb: OpenVDB cannot read it" neph-vdb damaged2.vdb -o x.neph
mesh() { refused 1 "$1: .*$2" neph-mesh "$1" -o x.neph; }
mesh vertices.ply "ends within its data"
mesh faces.ply "ends within its data"
mesh corners.ply "ends within its data"
mesh claim.stl "says 4294967295 facets, its 134 bytes hold 1"
refused 1 "claim.off:4:1: a finite number is missing" neph-mesh claim.off -o x.neph
refused 1 "corner.obj:4:7: a face names vertex 4294967294 of 3" neph-mesh corner.obj -o x.neph
mesh count.gltf "more than 33554432 positions"
mesh zeros.gltf "more than 33554432 positions"
mesh buffer.gltf "small.bin, requestedBytes 4000000000, but got 36"
mesh view.gltf "bufferView 0 reaches beyond its buffer of 36 bytes"
mesh outside.gltf "outside its own folder"
mesh deep.gltf "deeper than 200"
mesh sparse.obj "limit of 1073741824"
mesh file.gltf "sparse.bin: larger than the limit of 1073741824"
json() { refused 1 "$1: .*$2" neph-info "$1"; }
json deep.json "more than 8 objects and arrays"
json copies.json "more than 10000000 primitives"
json places.json "more than 100000 clouds"
json values.json "more than 500000 values"
json long.json "limit of 16777216"
json sparse.json "limit of 1073741824"
refused 1 "limit of 1048576" neph-lsys sparse.lsys -o x.neph
refused 1 "more than 1000000 primitives" neph-lsys grow.lsys -o x.neph
refused 1 "not enough memory" neph-lsys grow.lsys --max-primitives 1000000000000 -o x.neph
refused 1 "more than [0-9]* symbols" neph-lsys quiet.lsys -o x.neph
refused 1 "parameters.lsys:1:7: A has more than 16 arguments" neph-lsys parameters.lsys -o x.neph
refused 1 "open brackets is 100001" neph-lsys brackets.lsys -o x.neph
refused 2 "from 1 to 10000000" neph-gauss --count 10000001 -o x.neph
refused 2 "more than 100000000 spheres" neph-gauss --count 10000000 --no-hollow --no-prune --field 100 -o x.neph
refused 2 "from 1 to 100000" neph-meta --count 100001 -o x.neph
[ ! -e x.neph ] && [ ! -e x.png ] || fail "something that was refused made a file"
echo "cli_limits: $count refused"
