# Lobes of GGX and their linearly transformed cosines in the plane of incidence.
# From the root of the project, after `./run figures`:
#     gnuplot -c docs/figures/ltc.gp build/docs/sample_ltc
# writes docs/figures/ltc.png.

program = ARGC > 0 ? ARG1 : "build/docs/sample_ltc"
array Roughness[3] = [0.3, 0.6, 0.9]
array Angles[3] = [10, 50, 75]
array Colours[3] = ["#3b6fb6", "#e08a2e", "#4c9a56"]

set terminal pngcairo size 1500,460 font "sans,13"
set output "docs/figures/ltc.png"
set multiplot layout 1,3 margins 0.05,0.99,0.17,0.9 spacing 0.05,0.05
set xlabel "wi in the plane of incidence, degrees"
set key top left
set xrange [-90:90]
set xtics 30
set yrange [0:*]
do for [i = 1:3] {
    set title sprintf("ggx, roughness %.1f: f cos (lines), fit (dots)", Roughness[i])
    plot for [k = 1:3] sprintf("< %s lobe ggx %g %g", program, Roughness[i], Angles[k]) \
            using 1:2 with lines lw 2 lc rgb Colours[k] title sprintf("wo at %d", Angles[k]), \
        for [k = 1:3] sprintf("< %s lobe ggx %g %g", program, Roughness[i], Angles[k]) \
            using 1:3 every 15 with points pt 7 ps 0.5 lc rgb Colours[k] notitle
}
unset multiplot
