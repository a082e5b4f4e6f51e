# The functions of a basis as surfaces; `data` has x y z sign, `last` is the highest l.
set terminal @terminal
set output out
set encoding utf8
set palette defined (-1 "#3b6fb6", 1 "#e08a2e")
set cbrange [-1:1]
unset colorbox
unset border
unset tics
unset key
set view equal xyz
set view 68, 0, 2.7
set pm3d depthorder noborder
set pm3d lighting primary 0.35 specular 0.1
set margins 0, 0, 0, 0
set xrange [-last - 1.0:last + 0.6]
set yrange [-0.5:0.5]
set zrange [-last - 0.7:0.6]
do for [l = 0:last] {
    set label sprintf("l = %d", l) at -last - 0.6, 0, -l + 0.05 right
}
do for [m = -last:last] {
    set label sprintf("m = %d", m) at m, 0, -last - 0.68 center
}
splot data using 1:2:3:4 with pm3d
