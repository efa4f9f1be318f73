# Nothing lost: every writing program is killed at random moments (kill_at_random.py, kill_chart.py), and all but neph-chart
# run against a full disk, a folder that may not be written, pipes and streams that are closed, and an input that ends early. A file is whole or
# not there, a failure is one line and exit code 1, and no temporary file is left.
# $1: programs, $2: source folder, $3: kills (60).
set -eu
bin=$(cd "$1" && pwd)
source=$(cd "$2" && pwd)
kills=${3:-60}
tmp=$(mktemp -d)
mounted=
trap '[ -z "$mounted" ] || umount "$mounted"; rm -rf "$tmp"' EXIT
cd "$tmp"

fail() {
    echo "cli_kill: $1" >&2
    [ ! -s err ] || sed 's/^/    /' err >&2
    exit 1
}

# refused WHAT CODE: it ended with 1 and with one line, which says what failed.
refused() {
    [ "$2" = 1 ] || fail "$1: exit code $2, not 1"
    [ "$(wc -l < err)" = 1 ] || fail "$1: not one line"
    grep -q '^neph-[a-z]*: .' err || fail "$1: the line does not begin with the program's name"
}

python3 "$source/tests/kill_at_random.py" "$bin" "$source" "$kills" "${4:-1}"
python3 "$source/tests/kill_chart.py" "$bin" $(((kills + 19) / 20)) "${4:-1}"

mesh=$source/examples/meshes/suzanne.ply
fog=$source/tests/frozen/vdb/fog.vdb
"$bin/neph-gauss" -q --count 12 -o cloud.neph
"$bin/neph-gauss" -q --count 30000 --no-hollow --no-prune -o big.neph
# Every writing program but neph-chart, by the file that it makes. What gauss, meta, edit and info write is more than a pipe
# takes before its reader ends.
write() { # write NAME OPTIONS...: standard input is closed, so that nothing waits for it
    name=$1
    shift
    case $name in
    gauss) set -- "$bin/neph-gauss" -q --count 30000 --no-hollow --no-prune "$@" ;;
    lsys) set -- "$bin/neph-lsys" -q "$source/examples/anvil.lsys" "$@" ;;
    meta) set -- "$bin/neph-meta" -q --count 9000 "$@" ;;
    layer) set -- "$bin/neph-layer" -q "$@" ;;
    mesh) set -- "$bin/neph-mesh" -q "$mesh" "$@" ;;
    edit) set -- "$bin/neph-edit" -q big.neph --scale 2,2,2 "$@" ;;
    info) set -- "$bin/neph-info" --csv big.neph "$@" ;;
    vdb) set -- "$bin/neph-vdb" -q "$fog" --cells 16 --primitives 3 "$@" ;;
    vdb-out) set -- "$bin/neph-vdb" -q cloud.neph --resolution 32 "$@" ;;
    view) set -- "$bin/neph-view" -q cloud.neph --headless --size 64x36 --samples 1 --light-grid 4 "$@" ;;
    render) set -- "$bin/neph-render" -q cloud.neph --size 64x36 --spp 1 "$@" ;;
    esac
    "$@" 2> err < /dev/null
}
writers="gauss lsys meta layer mesh edit info vdb-out render view"
[ "$kills" -lt 200 ] || writers="$writers vdb" # which takes a second
suffix() {
    case $1 in
    info) echo csv ;;
    vdb-out) echo vdb ;;
    render | view) echo png ;;
    *) echo neph ;;
    esac
}

# --- a full disk: a file system of 1 page more than nothing where we may mount one, else a limit on a file's size
mkdir disk
if [ "$(id -u)" = 0 ] && mount -t tmpfs -o size=4k none disk 2> /dev/null; then
    mounted=$tmp/disk
    head -c 4096 /dev/zero > disk/filler 2> /dev/null || true
    count=1
else
    echo "cli_kill: no file system can be mounted here; the full disk is a limit on sizes"
    count=0
fi
for name in $writers; do
    code=0
    if [ -n "$mounted" ]; then
        write $name -o "disk/x.$(suffix $name)" || code=$?
    else
        (ulimit -f 0 && exec 2> /dev/null && write $name -o "disk/x.$(suffix $name)") || code=$?
        echo "neph-$name: (its line cannot be written either)" > err
    fi
    refused "neph-$name on a full disk" $code
    [ "$(find disk -type f | wc -l)" = $count ] || fail "neph-$name left a file on a full disk"
    code=0
    write $name > /dev/full || code=$?
    refused "neph-$name to /dev/full" $code
done
for option in --help --version --generate=man; do
    code=0
    "$bin/neph-gauss" $option > /dev/full 2> err || code=$?
    refused "neph-gauss $option to /dev/full" $code
done

# --- a limit on a file's size
for name in gauss meta edit info; do
    code=0
    (ulimit -f 64 && write $name -o "small.$(suffix $name)") || code=$?
    refused "neph-$name beyond ulimit -f" $code
    [ -z "$(find . -name 'small.*')" ] || fail "neph-$name left a file beyond ulimit -f"
done

# --- a folder that is not there, and one that may not be written (root may write anywhere: /proc is such a folder)
mkdir closed
chmod 555 closed
[ "$(id -u)" != 0 ] || { rmdir closed && ln -s /proc closed; }
for name in $writers; do
    places=closed
    [ $name != gauss ] || places="closed nowhere"
    for place in $places; do
        code=0
        write $name -o "$place/x.$(suffix $name)" || code=$?
        refused "neph-$name in the folder \"$place\"" $code
    done
done

# --- a closed pipe: the reader takes ten bytes and goes. -o names a picture's format, so neph-render has none.
for name in gauss meta edit info; do
    { write $name || echo $? > code; } | head -c 10 > /dev/null
    refused "neph-$name into a pipe that closes" "$(cat code)"
    rm code
done

# --- closed streams: no file of ours takes their place
for name in $writers; do
    case $name in render | view) continue ;; esac
    code=0
    write $name >&- || code=$?
    refused "neph-$name without standard output" $code
done
"$bin/neph-gauss" --count 12 -o whole.neph <&- >&- 2>&- || fail "neph-gauss -o without streams"
cmp -s whole.neph cloud.neph || fail "without streams, what neph-gauss says gets into its file"
code=0
"$bin/neph-info" - <&- > out 2> err || code=$?
refused "neph-info without standard input" $code

# --- an input that ends early, through a FIFO and through a pipe
mkfifo fifo
size=$(wc -c < cloud.neph)
for part in 0 10 $((size / 2)) $((size - 1)); do
    for way in "neph-info fifo" "neph-edit -q fifo -o part.neph" "neph-render -q fifo -o part.png"; do
        { head -c $part cloud.neph > fifo; } &
        writer=$!
        code=0
        # shellcheck disable=SC2086
        timeout 20 "$bin"/$way > out 2> err || code=$?
        wait $writer
        refused "$way after $part bytes" $code
    done
done
code=0
head -c 100 "$mesh" | "$bin/neph-mesh" -q - -o part.neph 2> err || code=$?
refused "neph-mesh of a part" $code
code=0
printf 'axiom X\nX -> [ X' | "$bin/neph-lsys" -q - -o part.neph 2> err || code=$?
refused "neph-lsys of a part" $code
code=0
head -c 1000 "$fog" > part.vdb
"$bin/neph-vdb" -q part.vdb -o part.neph 2> err || code=$?
refused "neph-vdb of a part" $code
[ ! -e part.neph ] && [ ! -e part.png ] || fail "a part of an input made an output"

left=$(find . -name '*.??????' -type f ! -name '*.neph')
[ -z "$left" ] || fail "left: $left"
echo "cli_kill: obstacles passed by: $writers"
