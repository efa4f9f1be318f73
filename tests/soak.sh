# Many small frames without growth: neph-view draws them while the eye goes round a cloud with something opaque in it, and its
# memory is looked at meanwhile; with programs built with the sanitizers, what they find ends it, too. A command of its own:
# minutes. A window is opened as well (Xvfb, xdotool): its eye turned, its panel folded and unfolded, its size changed.
#
#     sh tests/soak.sh build/asan-ubsan/bin . 10000
set -eu
bin=$(cd "$1" && pwd)
source=$(cd "$2" && pwd)
frames=${3:-10000}
test=soak
. "$source/tests/window.sh"

"$bin/neph-gauss" -q --count 8 -o cloud.neph
printf 'v -2 0 0\nv 2 0 0\nv 2 4 0\nv -2 4 0\nf 1 2 3 4\n' >wall.obj
# Mesa and its LLVM keep what they have compiled until the process ends, which the leak check would tell of.
ASAN_OPTIONS=${ASAN_OPTIONS:-detect_leaks=0}
export ASAN_OPTIONS

memory() { awk '/^VmRSS/ { print $2 }' "/proc/$1/status" 2>/dev/null || true; }
# watch PROCESS: its memory [KiB] every second, into the file memory, until it ends
watch()
{
    : >memory
    while kill -0 "$1" 2>/dev/null; do
        memory "$1" >>memory
        sleep 1
    done
}
# grows: whether the last quarter of the samples' mean is more than the second quarter's by 2 % and 4 MiB. The first is the
# beginning; the sanitizer's quarantine and Mesa's caches fill in it.
grows()
{
    awk 'NF { m[n++] = $1 } END {
        if (n < 8) { print "too short to tell"; exit 0 }
        for (i = int(n / 4); i < int(n / 2); i++) { a += m[i]; k++ }
        for (i = int(3 * n / 4); i < n; i++) { b += m[i]; l++ }
        a /= k; b /= l
        printf "%d KiB in the second quarter, %d in the last, of %d samples\n", a, b, n
        exit !(b > a * 1.02 + 4096) }' memory
}

"$bin/neph-view" -q cloud.neph --mesh wall.obj --ground -1 --bench "$frames" --size 32x18 --light-grid 8 >bench.json 2>bench.log &
viewer=$!
watch "$viewer"
status=0
wait "$viewer" || status=$?
viewer=
[ "$status" = 0 ] || fail "$frames frames ended with $status: $(tail -n 20 bench.log)"
grep -q "\"frames\": $frames" bench.json || fail "not all frames were drawn: $(cat bench.json)"
if grows >growth; then fail "memory: $(cat growth)"; fi
echo "soak: $frames frames without a window: $(cat growth)"

# The window: about ten frames a round.
rounds=$((frames / 100))
open cloud.neph cloud.neph --mesh wall.obj --size 240x160 --samples 1 --light-grid 8
watch "$viewer" &
watching=$!
round=0
while [ "$round" -lt "$rounds" ]; do
    at 200 100 mousedown 1 mousemove --window "$window" 210 105 mousemove --window "$window" 225 100 mouseup 1
    key Tab
    key t
    key x
    xdotool windowsize "$window" $((200 + round % 5 * 10)) $((140 + round % 3 * 10))
    round=$((round + 1))
done
rest_end=$(($(date +%s) + 120))
until rests || [ "$(date +%s)" -ge "$rest_end" ]; do sleep 0.5; done
quit
wait "$watching" || true
if grows >growth; then fail "memory of the window: $(cat growth)"; fi
! grep -q "ERROR: \|runtime error" viewer.log || fail "the sanitizers say: $(head -n 20 viewer.log)"
echo "soak: $rounds rounds in the window: $(cat growth)"
