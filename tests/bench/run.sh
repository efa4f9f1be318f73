#!/bin/sh
# Growth: the viewer's time and memory against the camera's distance, primitives, resolution and clouds, as a table (CSV)
# and one sheet of charts (gnuplot). $1: folder of programs; $2: folder to write to; --quick: fewer points, small pictures.
# Ends within ten minutes: what is left after that is not begun, and said.
set -eu
quick=0
[ "${1:-}" = --quick ] && { quick=1; shift; }
[ $# = 2 ] || { echo "usage: run.sh [--quick] PROGRAMS OUTPUT" >&2; exit 2; }
bin=$(cd "$1" && pwd)
mkdir -p "$2"
out=$(cd "$2" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
start=$(date +%s)
if [ $quick = 1 ]; then
    frames=3 size=160x90 limit=120
    distances="12 96" counts="35 350 3500" heights="90 180" clouds="1 10 100"
else
    frames=10 size=640x360 limit=570
    distances="6 12 24 48 96 192" counts="35 350 3500 35000 100000" heights="180 360 720 1440 2160"
    clouds="1 3 10 30 100 300 1000"
fi
csv=$out/growth.csv
echo "chart,method,x,milliseconds,p95,first_picture_ms,megabytes" >"$csv"

# one CHART X METHOD FILE OPTIONS...: a row, unless the time is over or the program had more than its share of it
one() {
    chart=$1 x=$2 method=$3 file=$4
    shift 4
    if [ $(($(date +%s) - start)) -gt $limit ]; then
        echo "run.sh: no time left for $chart $x $method" >&2
        return
    fi
    if ! timeout 60 sh -c '"$@" >"$0/json" & pid=$!; most=0
        while kill -0 $pid 2>/dev/null; do
            now=$(sed -n "s/^VmHWM:[^0-9]*\([0-9]*\).*/\1/p" /proc/$pid/status 2>/dev/null || true)
            [ -n "$now" ] && most=$now
            sleep 0.05
        done
        echo "$most" >"$0/memory"; wait $pid' "$work" \
        "$bin/neph-view" "$file" -q --bench $frames --method "$method" "$@"; then
        echo "run.sh: $chart $x $method took too long, or failed" >&2
        return
    fi
    number() { sed -n "s/.*\"$1\": *\([0-9.e+-]*\).*/\1/p" "$work/json"; }
    echo "$chart,$method,$x,$(number median),$(number p95),$(number first_picture_ms),$(($(cat "$work/memory") / 1024))" |
        tee -a "$csv"
}

gauss="$bin/neph-gauss -q --no-hollow --no-prune"
$gauss -o "$work/cumulus.neph"
for n in $clouds; do
    side=$(awk "BEGIN { print 32 * sqrt($n) }")
    $gauss --field "$n" --area "$side,$side" -o "$work/field.neph"
    one clouds "$n" default "$work/field.neph" --size $size --eye 0,-30,0 --target 0,0,60 --fov 60
done
for method in default exact; do
    for d in $distances; do
        one distance "$d" $method "$work/cumulus.neph" --size $size --eye "0,1,$d" --target 0,1,0 --fov 67
    done
    for h in $heights; do
        one resolution "$h" $method "$work/cumulus.neph" --size $((h * 16 / 9))x"$h" --eye 0,1,12 --target 0,1,0 --fov 67
    done
    for fov in 100 67 45 30; do # the narrower, the more of the picture is cloud
        one coverage $fov $method "$work/cumulus.neph" --size $size --eye 0,1,16 --target 0,1,0 --fov $fov
    done
    for n in $counts; do
        # As large a cloud of smaller spheres: their surfaces together stay.
        radius=$(awk "BEGIN { print 2.9 * sqrt(35 / $n) }")
        $gauss --count "$n" --max-radius "$radius" --noise-scale 0.5 -o "$work/many.neph"
        one primitives "$n" $method "$work/many.neph" --size $size --eye 0,1,12 --target 0,1,0 --fov 67
    done
done
for series in clouds,default distance,default distance,exact resolution,default resolution,exact coverage,default \
    coverage,exact primitives,default primitives,exact; do
    grep -q "^$series," "$csv" || { echo "run.sh: $series was not measured, so there are no charts" >&2; exit 1; }
done
gnuplot <<PLOT
set terminal pngcairo size 1200,800 font "sans,9"
set output "$out/growth.png"
set datafile separator ","
set logscale xy
set grid
set key top left
set multiplot layout 2,3
rows(chart, method) = sprintf("< grep '^%s,%s,' $csv", chart, method)
set ylabel "milliseconds a frame"
do for [chart in "distance resolution coverage primitives"] {
    set title chart
    set xlabel chart eq "distance" ? "metres" : chart eq "resolution" ? "rows of pixels" : chart eq "coverage" ? "field of view, degrees" : "primitives"
    plot rows(chart, "default") using 3:4 with linespoints title "default", rows(chart, "exact") using 3:4 with linespoints title "exact"
}
set title "clouds"
set xlabel "clouds"
plot rows("clouds", "default") using 3:4 with linespoints title "a frame", rows("clouds", "default") using 3:6 with linespoints title "first picture"
set title "memory"
set ylabel "megabytes"
plot rows("clouds", "default") using 3:7 with linespoints title "clouds", rows("primitives", "default") using 3:7 with linespoints title "primitives, default", rows("primitives", "exact") using 3:7 with linespoints title "primitives, exact"
unset multiplot
PLOT
echo "$csv $out/growth.png"
