#!/bin/sh
# Flights through the three standard scenes: at 640x360 the slowest frame against the median, and values that are no number; and the
# largest jumps from a frame to the next beside the path-traced reference's own, as a table (CSV) on standard output.
#   sh tests/bench/flight.sh PROGRAMS SOURCE [SIZE [FRAMES [SPP]]]        # of the jumps: 160x90 300 256; some minutes
# A jump is the root mean square of the difference of two pictures over their mean. The reference's is taken from two pairs of
# pictures of different seeds, whose noise is not the same: the mean of the product of the two differences.
# Exit 1: a frame beyond four times the median (only an idle machine can tell), a value that is no number, or a jump that is
# larger than the reference's by more than a tenth and 0.02.
set -eu
if [ $# -lt 2 ] || [ $# -gt 5 ]; then
    echo "usage: flight.sh PROGRAMS SOURCE [SIZE [FRAMES [SPP]]]" >&2
    exit 2
fi
bin=$(cd "$1" && pwd)
source=$(cd "$2" && pwd)
size=${3:-160x90} frames=${4:-300} spp=${5:-256}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
values=$((${size%x*} * ${size#*x} * 3))
wrong=0

number() { sed -n "s/.*\"$1\": *\([0-9.e+-]*\).*/\1/p" "$work/report"; }

# reference FRAME SEED: that frame's picture, as a number a line
reference()
{
    row=$(sed -n "$(($1 + 2))p" "$work/frames.csv")
    # shellcheck disable=SC2046
    set -- "$2" $(echo "$row" | awk -F, '{ print $10 "," $11 "," $12, $13 "," $14 "," $15 }')
    "$bin/neph-render" -q "$scene" --size "$size" --spp "$spp" --seed "$1" --eye "$2" --target "$3" -o "$work/picture.pfm"
    tail -c $((values * 4)) "$work/picture.pfm" | od -An -v -tfF -w4
}

echo "scene,frame,jump,reference"
for name in cumulus mesh field; do
    scene=$source/examples/scenes/bench/$name.json
    "$bin/neph-view" -q "$scene" --size "$size" --bench "$frames" --flight --bench-frames "$work/frames.csv" >"$work/report"
    # The three largest jumps that do not follow each other.
    tail -n +2 "$work/frames.csv" | sort -t, -k5,5gr |
        awk -F, '{ for (i in taken) if ($1 - i <= 3 && i - $1 <= 3) next; taken[$1]; print $1, $5; if (++n == 3) exit }' >"$work/worst"
    while read -r frame jump; do
        for seed in 1 2; do
            reference $((frame - 1)) $((10 * frame + seed)) >"$work/before$seed"
            reference "$frame" $((10 * frame + seed + 5)) >"$work/after$seed"
        done
        own=$(paste "$work/before1" "$work/after1" "$work/before2" "$work/after2" | awk '
            { sum += ($2 - $1) * ($4 - $3); mean += ($1 + $2 + $3 + $4) / 4 }
            END { printf "%.4f", sqrt(sum > 0 ? sum / NR : 0) / (mean / NR) }')
        echo "$name,$frame,$jump,$own"
        awk "BEGIN { exit !($jump > 1.1 * $own + 0.02) }" && wrong=1
    done <"$work/worst"
    awk "BEGIN { exit !($(number wrong_values) > 0) }" && wrong=1
    "$bin/neph-view" -q "$scene" --size 640x360 --bench "$frames" --flight >"$work/report"
    echo "$name: median $(number median) ms, 95 % $(number p95), slowest $(number max);" \
        "$(number wrong_values) values that are no number" >&2
    awk "BEGIN { exit !($(number max) > 4 * $(number median) || $(number wrong_values) > 0) }" && wrong=1
done
exit $wrong
