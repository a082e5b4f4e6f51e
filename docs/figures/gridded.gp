# MERL slices as pictures, from the files themselves:
#     gnuplot -e "folder='FOLDER'" docs/figures/gridded.gp
# A .slice file is float32 [theta_d 90][theta_h 90][R, G, B].
if (!exists("folder")) folder = 'merl_slices'
set terminal pngcairo size 1000,300 font 'sans,10'
set output 'docs/figures/gridded.png'
code(f) = 255 * (f > 1 ? 1 : f)**(1 / 2.2)
set multiplot layout 1,4 margins 0.06,0.99,0.17,0.9 spacing 0.02,0
set xrange [0:90]
set yrange [0:90]
set xtics 0,30,60
set ytics 0,30,90
set xlabel '90° (θ_h / 90°)^½'
unset key
set size square
do for [name in 'alum-bronze red-plastic pink-fabric blue-metallic-paint'] {
    set title name
    if (name eq 'alum-bronze') { set ylabel 'θ_d' } else { unset ylabel; set format y '' }
    plot folder . '/' . name . '.slice' binary array=(90,90) format='%float%float%float' \
        origin=(0.5,0.5) using (code($1)):(code($2)):(code($3)) with rgbimage
}
unset multiplot
