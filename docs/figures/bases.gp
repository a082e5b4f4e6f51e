# The first functions of every basis as lobes |B_l^m|: orange where positive, blue where negative.
# From the root of the project, after `./run figures`:
#     gnuplot -c docs/figures/bases.gp build/docs/sample_basis
# writes docs/figures/bases-NAME.png.

program = ARGC > 0 ? ARG1 : "build/docs/sample_basis"
array Names[7] = ["hsh", "sh", "esh", "zernike", "makhotkin", "makhotkin-flux", "h-basis"]
array Orders[7] = [4, 4, 4, 4, 4, 4, 3]

set terminal pngcairo size 1100,640 font "sans,13"
set palette defined (-1 "#3b6fb6", 1 "#e08a2e")
set cbrange [-1:1]
unset colorbox
unset border
unset tics
unset key
set view equal xyz
set view 68, 0, 2.75
set pm3d depthorder noborder
set pm3d lighting primary 0.35 specular 0.1
set margins 0, 0, 0, 0

do for [i = 1:|Names|] {
    last = Orders[i] - 1
    set output sprintf("docs/figures/bases-%s.png", Names[i])
    set xrange [-last - 0.9:last + 0.6]
    set yrange [-0.5:0.5]
    set zrange [-last - 0.6:0.6]
    unset label
    do for [l = 0:last] {
        set label sprintf("l = %d", l) at -last - 0.5, 0, -l + 0.1 right
    }
    do for [m = -last:last] {
        set label sprintf("m = %d", m) at m, 0, -last - 0.55 center
    }
    splot sprintf("< %s %s %d", program, Names[i], Orders[i]) using 1:2:3:4 with pm3d
}
