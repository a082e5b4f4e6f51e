# Lobes of the analytic models in the plane of incidence, each scaled to the same largest radius.
# From the root of the project, after `./run figures`:
#     gnuplot -c docs/figures/brdfs.gp build/docs/sample_brdf
# writes docs/figures/brdfs.png.

program = ARGC > 0 ? ARG1 : "build/docs/sample_brdf"
array Specs[20] = ["lambert", "oren-nayar:sigma=30", "eon:roughness=1", "minnaert:k=1.5", \
    "phong:exponent=20", "blinn-phong:exponent=80", "lafortune:exponent=20,Cz=.7", \
    "sg:sharpness=20", "ward:ax=.2,ay=.2", "ashikhmin-shirley:nu=80,nv=80,Rs=.05,Rd=.5", \
    "cook-torrance:m=.2,F0=.05", "he:sigma=.15,tau=2", "abc:B=100,C=1", "sgd:alpha=.05,p=.5", \
    "beckmann:alpha=.2", "ggx:alpha=.2", "gtr:alpha=.2,gamma=1", \
    "disney:roughness=.5", "charlie:r=.4", "lambert:kd=.3 + ggx:alpha=.2,F0=.04"]
array Angles[3] = [10, 45, 75]
array Colours[3] = ["#3b6fb6", "#e08a2e", "#4c9a56"]

set terminal pngcairo size 1500,1240 font "sans,13"
set output "docs/figures/brdfs.png"
set multiplot layout 5,4 margins 0.02,0.98,0.02,0.96 spacing 0.02,0.05
set size ratio -1
set xrange [-1.05:1.05]
set yrange [0:1.05]
unset border
unset tics
unset key
do for [i = 1:|Specs|] {
    set title Specs[i] noenhanced offset 0,-0.5
    set object 1 circle at 0,0 size 1 arc [0:180] nowedge fs empty border lc rgb "#cccccc"
    set arrow 1 from -1.05,0 to 1.05,0 nohead lc rgb "#888888"
    do for [k = 1:3] {
        set arrow (1 + k) from 0,0 to -1.03*sin(Angles[k]*pi/180),1.03*cos(Angles[k]*pi/180) \
            nohead dt 2 lc rgb Colours[k]
    }
    plot for [k = 1:3] sprintf("< %s lobe %d '%s'", program, Angles[k], Specs[i]) \
        using 1:2 with lines lw 2 lc rgb Colours[k]
}
unset multiplot
