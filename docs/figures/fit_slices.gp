# Losses of our fits against those of published ones, a point per material. From the root of the
# project:
#     gnuplot docs/figures/fit_slices.gp
# draws docs/figures/fit_slices.csv, which the program fit_slices wrote, to
# docs/figures/fit_slices.png.

set datafile separator ","
table = "docs/figures/fit_slices.csv"
array Models[5] = ["ward", "cook-torrance", "abc", "sgd", "ggx"]
array Titles[5] = ["Ward", "Cook-Torrance", "ABC", "SGD", "GGX against Cook-Torrance"]
array First[5] = [1, 3, 6, 8, 9]
array Last[5] = [2, 5, 7, 8, 10]
array Collections[10] = ["ngan-ward", "ngan-ward-duer", "ngan-cook-torrance", \
    "low-cook-torrance-e1", "low-cook-torrance-e2", "low-abc-smooth-e2", "low-abc-microfacet-e2", \
    "bagher-sgd", "ngan-cook-torrance", "low-cook-torrance-e2"]
array Losses[10] = ["cosine", "cosine", "cosine", "cosine", "log", "log", "log", "cosine", \
    "cosine", "log"]
array Colours[3] = ["#3b6fb6", "#e08a2e", "#4c9a56"]
array Points[3] = [7, 5, 9]
kept(model, k, value) = (strcol(1) eq Collections[k] && strcol(2) eq model && \
    strcol(3) eq Losses[k]) ? value : NaN

set terminal pngcairo size 1400,900 font "sans,12"
set output "docs/figures/fit_slices.png"
set multiplot layout 2,3
set logscale xy
set format "10^{%T}"
set key top left Left reverse
set grid lc rgb "#dddddd"
set size square
set xrange [1e-4:2]
set yrange [1e-4:50]
set xlabel "loss of the published fit"
set ylabel "loss of ours"
do for [m = 1:5] {
    set title Titles[m]
    plot x with lines lc rgb "#888888" notitle, \
        for [k = First[m]:Last[m]] table using (kept(Models[m], k, column(5))): \
            (kept(Models[m], k, column(6))) with points pt Points[k - First[m] + 1] ps 0.8 \
            lc rgb Colours[k - First[m] + 1] title Collections[k] . ", " . Losses[k]
}
unset multiplot
