# Samples of a goniometer in the plane of incidence and the interpolation between them.
# From the root of the project, after `./run figures`:
#     gnuplot -c docs/figures/scattered.gp build/docs/sample_scattered FILE CHANNEL
# writes docs/figures/scattered.png. The figure in the page: garnet_red.brdf, channel 25 (650 nm).

program = ARG1
array Angles[4] = [20, 40, 60, 80]
array Colours[4] = ["#3b6fb6", "#e08a2e", "#4c9a56", "#9a4c8c"]

set terminal pngcairo size 1200,560 font "sans,13"
set output "docs/figures/scattered.png"
set logscale y
set yrange [0.03:60]
set xrange [-90:90]
set xtics 30
set grid lc rgb "#dddddd"
set key top left reverse Left
set xlabel "outgoing angle in the plane of incidence, degrees (mirror side: +)"
set ylabel "f, 1/sr"
plot for [k = 1:4] sprintf("< %s curve %d %s %s", program, Angles[k], ARG3, ARG2) \
        using 1:($3 == 1 ? $2 : NaN) with lines lw 2 lc rgb Colours[k] \
        title sprintf("incidence %d degrees", Angles[k]), \
    for [k = 1:4] sprintf("< %s curve %d %s %s", program, Angles[k], ARG3, ARG2) \
        using 1:($3 == 0 ? $2 : NaN) with lines lw 2 dt 3 lc rgb Colours[k] notitle, \
    for [k = 1:4] sprintf("< %s samples %d %s %s", program, Angles[k], ARG3, ARG2) \
        using 1:2 with points pt 6 ps 1.2 lw 1.5 lc rgb Colours[k] notitle
