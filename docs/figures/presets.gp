# One material as measured and as the published fits have it, green channel at a difference angle of
# 30 degrees. From the root of the project, after `./run figures`:
#     gnuplot -c docs/figures/presets.gp build/docs/preset_slices FOLDER
# with the folder of MERL slices writes docs/figures/presets.png.

program = ARGC > 0 ? ARG1 : "build/docs/preset_slices"
folder = ARGC > 1 ? ARG2 : "."
material = "alum-bronze"
data = sprintf("< %s %s curve %s 30", program, folder, material)
array Left[7] = ["ward", "ward-duer", "blinn-phong", "cook-torrance", "ashikhmin-shirley", \
    "lafortune", "he"]
array Right[6] = ["cook-torrance-e1", "cook-torrance-e2", "ashikhmin-shirley-e2", "abc-smooth-e2", \
    "abc-microfacet-e2", "sgd"]
array RightColumns[6] = [12, 13, 11, 14, 15, 16]
array Colours[7] = ["#3b6fb6", "#7fb0e0", "#e08a2e", "#4c9a56", "#a03c8c", "#c0392b", "#6b5b3e"]

set terminal pngcairo size 1400,620 font "sans,13"
set output "docs/figures/presets.png"
set multiplot layout 1,2
set logscale y
set xrange [0:45]
set yrange [0.008:10]
set format y "%g"
set xlabel "half angle in degrees"
set ylabel "f in 1/sr"
set key top right
set grid lc rgb "#dddddd"
set title material . ": measured, and Ngan et al. 2005"
plot data using 1:2 with points pt 7 ps 0.6 lc rgb "black" title "measured", \
    for [k = 1:7] data using 1:(column(k + 2)) with lines lw 2 lc rgb Colours[k] title Left[k]
set title material . ": measured, and Löw et al. 2012, Bagher et al. 2012"
plot data using 1:2 with points pt 7 ps 0.6 lc rgb "black" title "measured", \
    for [k = 1:6] data using 1:(column(RightColumns[k])) with lines lw 2 lc rgb Colours[k] \
        title Right[k]
unset multiplot
