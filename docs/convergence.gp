# The plot of docs/light.md: gnuplot -c docs/convergence.gp convergence.csv docs/convergence.png
set terminal pngcairo size 960,420 font "sans,10"
set output ARG2
set datafile separator ","
set logscale xy 2
set format y "10^{%L}"
set logscale y 10
set xlabel "steps across the scene"
set yrange [1e-8:1]
set key bottom left samplen 2
set grid back lc rgb "#dddddd"
rules = "riemann-left riemann-right trapezoid simpson simpson38 exponential"
colours = "#4477aa #66ccee #228833 #ee6677 #aa3377 #222222"
set multiplot layout 1,2
do for [scene in "smooth spheroid"] {
    set title scene eq "smooth" ? "smooth density: each rule at its order" : "spheroid: order 1, whatever the rule"
    set ylabel scene eq "smooth" ? "mean error of radiance" : ""
    plot for [i=1:6] ARG1 using (stringcolumn(1) eq scene && stringcolumn(2) eq word(rules, i) ? $3 : NaN):4 \
        with linespoints lc rgb word(colours, i) pt (i + 3) ps 0.8 title word(rules, i)
}
unset multiplot
