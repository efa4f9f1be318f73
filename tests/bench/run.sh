#!/bin/sh
# Growth: the viewer's time and memory against the camera's distance (Jimenez 2018, Table 3 and Figure 16), primitives,
# pixels, what the cloud covers of the picture, and clouds, as a table (CSV), one sheet of charts (gnuplot) and the exponent
# of each curve. $1: folder of programs; $2: folder to write to; --quick: fewer points, small pictures, no judgement.
# Ends within ten minutes: what is left after that is not begun, and said.
# Exit 1: a curve's upper half grows faster than its x to the power of 1.15, or a thousand clouds of which ten are in sight
# take more than 1.1 times a frame of the ten alone.
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
    frames=5 size=160x90 limit=120
    distances="12 96" counts="35 350 3500" heights="90 180" clouds="1 10 100" tens="10 100" views="67 45"
else
    frames=10 size=640x360 limit=540
    distances="6 12 24 48 96 192" counts="35 350 3500 35000 100000" heights="180 360 720 1440 2160"
    clouds="1 3 10 30 100 300 1000" tens="10 100 1000" views="100 80 67 55 45 35"
fi
csv=$out/growth.csv
echo "chart,method,x,milliseconds,p95,first_picture_ms,cpu_ms,megabytes,steps" >"$csv"

# one CHART X METHOD FRAMES FILE OPTIONS...: a row, unless the time is over or the program had more than its share of it
one()
{
    chart=$1 x=$2 method=$3 count=$4 file=$5
    shift 5
    if [ $(($(date +%s) - start)) -gt $limit ]; then
        echo "run.sh: no time left for $chart $x $method" >&2
        return
    fi
    if ! timeout 60 "$bin/neph-view" "$file" -q --bench "$count" --method "$method" "$@" >"$work/json"; then
        echo "run.sh: $chart $x $method took too long, or failed" >&2
        return
    fi
    number() { sed -n "s/.*\"$1\": *\([0-9.e+-]*\).*/\1/p" "$work/json"; }
    echo "$chart,$method,$x,$(number median),$(number p95),$(number first_picture_ms),$(number cpu_ms),$((\
        $(number memory_bytes) / 1048576)),$(number steps_per_pixel)" | tee -a "$csv"
}

# fewer HEIGHT: frames of so large a picture, so that none takes all the time
fewer() { awk "BEGIN { n = int($frames * 360 * 360 / ($1 * $1)); print (n < 2 ? 2 : n > $frames ? $frames : n) }"; }

gauss="$bin/neph-gauss -q --no-hollow --no-prune"
$gauss -o "$work/cumulus.neph"

# Ten clouds before the eye, and the others behind it.
for n in $tens; do
    behind=
    [ "$n" = 10 ] || behind=', {"generator": "neph-gauss", "translate": [0, 0, -2000],
        "options": {"field": '$((n - 10))', "area": [1000, 1000], "no-hollow": true, "no-prune": true, "seed": 6}}'
    cat >"$work/ten$n.json" <<SCENE
{"scene": 1, "clouds": [{"generator": "neph-gauss",
    "options": {"field": 10, "area": [100, 100], "no-hollow": true, "no-prune": true, "seed": 5}}$behind],
 "sun": {"azimuth": 60, "height": 40}, "sky": "clear"}
SCENE
done
# They are compared to a few percent, so they take turns, and each one's best counts.
rows=$csv
csv=$work/turns
: >"$csv"
for _ in 1 2 3 4; do
    for n in $tens; do
        one ten-in-sight "$n" default $((4 * frames)) "$work/ten$n.json" --size $size --eye 0,2,-80 --target 0,2,0 --fov 70
    done
done >"$work/said"
csv=$rows
for n in $tens; do
    grep "^ten-in-sight,default,$n," "$work/turns" | sort -t, -k4,4g | head -n 1 | tee -a "$csv"
done
for n in $clouds; do
    side=$(awk "BEGIN { print 32 * sqrt($n) }")
    $gauss --field "$n" --area "$side,$side" -o "$work/field.neph"
    one clouds "$n" default $frames "$work/field.neph" --size $size --eye 0,-30,0 --target 0,0,60 --fov 60
done
for method in default exact; do
    for d in $distances; do
        one distance "$d" "$method" $frames "$work/cumulus.neph" --size $size --eye "0,1,$d" --target 0,1,0 --fov 67
    done
    for fov in $views; do # the narrower, the more of the picture is cloud: x is by how much its area is magnified
        x=$(awk "BEGIN { t = sin($fov * 3.14159265 / 360) / cos($fov * 3.14159265 / 360); printf \"%.3f\", 1 / (t * t) }")
        one coverage "$x" "$method" $frames "$work/cumulus.neph" --size $size --eye 0,1,16 --target 0,1,0 --fov "$fov"
    done
    for n in $counts; do
        # As large a cloud of smaller spheres: their surfaces together stay.
        radius=$(awk "BEGIN { print 2.9 * sqrt(35 / $n) }")
        $gauss --count "$n" --max-radius "$radius" --noise-scale 0.5 -o "$work/many.neph"
        one primitives "$n" "$method" $((frames / 2 + 1)) "$work/many.neph" --size $size --eye 0,1,12 --target 0,1,0 --fov 67
    done
    for h in $heights; do
        width=$((h * 16 / 9))
        one pixels $((width * h)) "$method" "$(fewer "$h")" "$work/cumulus.neph" --size "${width}x$h" --eye 0,1,12 \
            --target 0,1,0 --fov 67
    done
done

# The exponent of each curve, by least squares of the logarithms: of all points, and of the upper half of them.
wrong=0
awk -F, '
    function slope(key, from,    n, i, x, y, sx, sy, xx, xy) {
        for (i = from; i <= many[key]; i++) {
            x = log(xs[key, i]); y = log(ys[key, i]); n++; sx += x; sy += y; xx += x * x; xy += x * y
        }
        return n > 1 ? (n * xy - sx * sy) / (n * xx - sx * sx) : 0
    }
    NR > 1 { keys[$1 "," $2 ",frame"] }
    NR > 1 && ($1 == "clouds" || $1 == "primitives") { keys[$1 "," $2 ",first picture"]; keys[$1 "," $2 ",memory"] }
    NR > 1 {
        for (key in keys) {
            split(key, part, ",")
            if (part[1] != $1 || part[2] != $2)
                continue
            many[key]++
            xs[key, many[key]] = $3
            ys[key, many[key]] = part[3] == "frame" ? $4 : part[3] == "memory" ? $8 : $6
        }
    }
    END {
        for (key in keys) {
            upper = slope(key, int((many[key] + 1) / 2))
            printf "%s,%.2f,%.2f%s\n", key, slope(key, 1), upper, (upper > 1.15 ? ",faster than linear" : "")
        }
    }' "$csv" | sort >"$work/exponents"
{ echo "chart,method,of,exponent,exponent of the upper half" && cat "$work/exponents"; } | tee "$out/exponents.csv"
grep -q "faster than linear" "$out/exponents.csv" && wrong=1
ratio=$(awk -F, '$1 == "ten-in-sight" { if (!first) first = $4; last = $4 } END { printf "%.3f", last / first }' "$csv")
echo "a frame of many clouds of which ten are in sight takes $ratio times that of the ten alone"
awk "BEGIN { exit !($ratio > 1.1) }" && wrong=1

gnuplot <<PLOT
set terminal pngcairo size 1500,900 font "sans,11"
set output "$out/growth.png"
set datafile separator ","
set logscale xy
set grid lc rgb "#dddddd"
set key top left
set border 3
set tics nomirror
set pointsize 1.2
blue = "#1f5fa8"; red = "#c0392b"; green = "#2e8b57"; grey = "#999999"
set multiplot layout 2,3 title "neph-view, llvmpipe on two cores: a frame of a moving view" font "sans,14"
rows(chart, method) = sprintf("< grep '^%s,%s,' $csv", chart, method)
has(chart, method) = system(sprintf("grep -c '^%s,%s,' $csv || true", chart, method)) + 0
set ylabel "milliseconds a frame"
# A line of slope 1 through the first point of the default.
through(chart) = real(system(sprintf("awk -F, '\$1 == \"%s\" && \$2 == \"default\" && \$4 > 0 { print \$4 / \$3; exit }' $csv", chart)))
do for [chart in "distance pixels coverage primitives"] {
    set title chart
    set xlabel chart eq "distance" ? "metres from the cloud's middle" : chart eq "pixels" ? "pixels" : chart eq "coverage" ? "magnification of the cloud's area" : "primitives"
    set xrange [*:*]
    if (chart eq "distance") {
        set key top right
        plot rows(chart, "default") using 3:4 with linespoints pt 7 lw 2 lc rgb blue title "default", \
             rows(chart, "exact") using 3:4 with linespoints pt 5 lw 2 lc rgb red title "exact"
        set key top left
    } else {
        k = through(chart)
        plot rows(chart, "default") using 3:(k * \$3) with lines dt 2 lc rgb grey title "linear", \
             rows(chart, "default") using 3:4 with linespoints pt 7 lw 2 lc rgb blue title "default", \
             rows(chart, "exact") using 3:4 with linespoints pt 5 lw 2 lc rgb red title "exact"
    }
}
set title "clouds"
set xlabel "clouds"
set key top left
k = through("clouds")
plot rows("clouds", "default") using 3:(k * \$3) with lines dt 2 lc rgb grey title "linear", \
     rows("clouds", "default") using 3:4 with linespoints pt 7 lw 2 lc rgb blue title "all around: a frame", \
     rows("clouds", "default") using 3:6 with linespoints pt 5 lw 2 lc rgb red title "all around: to the first picture", \
     rows("ten-in-sight", "default") using 3:4 with linespoints pt 9 lw 2 lc rgb green title "ten in sight: a frame"
set key top left
set title "memory"
set ylabel "megabytes"
set xlabel "primitives, clouds"
plot rows("clouds", "default") using 3:8 with linespoints pt 7 lw 2 lc rgb blue title "clouds of 35 spheres", \
     rows("primitives", "default") using 3:8 with linespoints pt 5 lw 2 lc rgb red title "primitives, default", \
     rows("primitives", "exact") using 3:8 with linespoints pt 9 lw 2 lc rgb green title "primitives, exact"
unset multiplot
PLOT
echo "$csv $out/growth.png"
[ $quick = 1 ] || exit $wrong
