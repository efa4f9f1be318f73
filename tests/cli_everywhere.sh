# The same everywhere: bytes do not depend on the number of threads, the locale, the time zone, the folder, or the names
# of files; numbers are read and written with a point; pictures of neph-render are equal between runs and thread counts.
# (Compilers and optimisation: cli_same_bytes.sh. Another processor: arm64.sh.)
# $1: programs, $2: source folder.
set -eu
bin=$(cd "$1" && pwd)
source=$(cd "$2" && pwd)
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT

fail() {
    echo "cli_everywhere: $1" >&2
    exit 1
}

# A locale with a decimal comma. Made here, in a folder of its own: the system need not have it.
command -v localedef > /dev/null || fail "localedef is missing (install libc-bin)"
[ -e /usr/share/i18n/locales/de_DE ] || fail "the locale's source is missing (install locales)"
mkdir "$tmp/locales"
localedef -i de_DE -f UTF-8 "$tmp/locales/de_DE.UTF-8" || [ -e "$tmp/locales/de_DE.UTF-8/LC_NUMERIC" ]
comma=$(LOCPATH=$tmp/locales LC_ALL=de_DE.UTF-8 locale decimal_point)
[ "$comma" = , ] || fail "the locale has no decimal comma, so it tests nothing"

cat > "$tmp/half.lsys" << 'END'
axiom X(0.5)
iterations 4
radius 0.5  length 0.25..1.75  extinction 2.5
X(r) : r > 0.1 -> F(r) [ +(22.5) X(r*0.75) ] &(0.5) X(r/1.5)
END

# make FOLDER: what all programs make, in FOLDER, named bare.
make() {
    mkdir -p "$1"
    cd "$1"
    cp "$tmp/half.lsys" half.lsys
    cp "$source/examples/meshes/torus.obj" torus.obj
    "$bin/neph-gauss" -q --sigma 2.5,1.5,0.5 --extinction 0.5 -o gauss.neph
    "$bin/neph-gauss" -q --preset congestus --seed 5 --field 4 --area 60.5,40 -o field.neph
    "$bin/neph-lsys" -q half.lsys --seed 3 -o lsys.neph
    "$bin/neph-meta" -q --count 20 --max-radius 1.5 -o meta.neph
    "$bin/neph-layer" -q --preset fog --coverage 0.5 -o layer.neph
    "$bin/neph-edit" -q gauss.neph --grow --clip --hollow --prune --scale 0.5,1,1 --rotate 10.5,0,0 -o edit.neph
    "$bin/neph-mesh" -q torus.obj --faces 40 --scale 1.25 -o mesh.neph
    "$bin/neph-gauss" -q --sigma 2.5,1.5,0.5 --save-scene scene.json -o scene.neph
    "$bin/neph-info" --json gauss.neph > info.json
    "$bin/neph-info" --csv lsys.neph > info.csv
    "$bin/neph-info" --json scene.json > scene-info.json
    "$bin/neph-render" -q gauss.neph --size 48x27 --spp 2 --exposure 0.5 -o path.pfm
    "$bin/neph-render" -q layer.neph --size 16x9 --spp 1 -o layer.pfm
    "$bin/neph-render" -q gauss.neph --method march --steps 20 --size 48x27 --sun 30.5,40 -o march.png
    "$bin/neph-render" -q gauss.neph --method march --steps 20 --size 48x27 -o march.exr
    "$bin/neph-render" -q gauss.neph --method paper --size 16x9 -o paper.pfm
    cd "$tmp"
}

count=0
same() { # same FOLDER WHAT
    for file in "$tmp"/plain/*; do
        cmp -s "$file" "$1/$(basename "$file")" || fail "$(basename "$file") differs $2"
        count=$((count + 1))
    done
}

(export LC_ALL=C OMP_NUM_THREADS=1 && make "$tmp/plain")
grep -q '0\.5' "$tmp/plain/info.json" || fail "info.json has no 0.5"
(export OMP_NUM_THREADS=7 && make "$tmp/threads")
same "$tmp/threads" "between 1 and 7 threads"
(export LOCPATH="$tmp/locales" LC_ALL=de_DE.UTF-8 LANG=de_DE.UTF-8 TZ=Pacific/Chatham && make "$tmp/Ordner für Wolken, 雲 & 'so'")
same "$tmp/Ordner für Wolken, 雲 & 'so'" "with a decimal comma, another time zone and a folder with blanks and signs"

# --- names of files: blanks, no ASCII, a leading dash, no UTF-8
cd "$tmp/plain"
bad=$(printf 'L\344tin-1')
for name in "a b" "Wölkchen" "雲" "-dash" "semi;colon" "$bad" "new
line" '$(touch x)'; do
    "$bin/neph-gauss" -q --sigma 2.5,1.5,0.5 --extinction 0.5 "--output=./$name.neph"
    cmp -s gauss.neph "./$name.neph" || fail "\"$name.neph\" has other bytes"
    "$bin/neph-edit" -q "./$name.neph" --prune -o "./$name-edited.neph"
    "$bin/neph-info" --json "./$name-edited.neph" > "./$name.json" || fail "neph-info does not read \"$name-edited.neph\""
    "$bin/neph-render" -q "./$name.neph" --size 16x9 --spp 1 -o "./$name.png"
    for made in "./$name.neph" "./$name.png" "./$name.json"; do
        [ -s "$made" ] || fail "there is no \"$made\""
        count=$((count + 1))
    done
    case $name in
    "a b" | "雲" | "$bad") ;; # meshes and volumes take longer: three names of the eight
    *) continue ;;
    esac
    cp torus.obj "./$name.obj"
    "$bin/neph-mesh" -q "./$name.obj" --faces 40 -o "./$name.mesh.neph" || fail "neph-mesh does not read \"$name.obj\""
    cp "$source/tests/frozen/vdb/fog.vdb" "./$name.vdb"
    "$bin/neph-render" -q "./$name.vdb" --size 16x9 --spp 1 -o "./$name.vdb.png" ||
        fail "neph-render does not read \"$name.vdb\""
done
# The same without a folder before it, so that the dash does reach the programs: --output= and what follows -- are names.
"$bin/neph-gauss" -q --sigma 2.5,1.5,0.5 --extinction 0.5 --output=-bare.neph
"$bin/neph-edit" -q --prune -o -bare-edited.neph -- -bare.neph
"$bin/neph-info" --json -- -bare-edited.neph > ./-bare.json || fail "neph-info does not read \"-bare-edited.neph\""
"$bin/neph-render" -q --size 16x9 --spp 1 --output=-bare.png -- -bare.neph
cp torus.obj ./-bare.obj
"$bin/neph-mesh" -q --faces 40 --output=-bare-mesh.neph -- -bare.obj || fail "neph-mesh does not read \"-bare.obj\""
cmp -s gauss.neph ./-bare.neph || fail "\"-bare.neph\" has other bytes"
for made in -bare-edited.neph -bare.json -bare.png -bare-mesh.neph; do
    [ -s "./$made" ] || fail "there is no \"$made\""
    count=$((count + 1))
done
"$bin/neph-info" --json -bare.neph > /dev/null 2>&1 && fail "-bare.neph is read as a name without --"
# What says nothing about the name of the file: its folder. What stays of the name is UTF-8.
"$bin/neph-info" --json "./$bad-edited.neph" | python3 -c 'import json, sys; json.load(sys.stdin.buffer)' ||
    fail "a name that is no UTF-8 makes JSON that is none"
[ ! -e x ] || fail "a name was run as a command"
echo "cli_everywhere: $count files equal or there"
