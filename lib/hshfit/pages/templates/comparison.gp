# A reference BRDF against its approximation.
# Run `gnuplot comparison.gp` in this folder: reads polar.csv, half.csv, residual.csv and albedo.csv,
# writes the .svg files. Other names: gnuplot -e "svg1='a.svg'" comparison.gp …
if (!exists("polarCsv")) polarCsv = 'polar.csv'
if (!exists("halfCsv")) halfCsv = 'half.csv'
if (!exists("residualCsv")) residualCsv = 'residual.csv'
if (!exists("albedoCsv")) albedoCsv = 'albedo.csv'
{{#figures}}
if (!exists("svg{{index}}")) svg{{index}} = '{{file}}'
{{/figures}}

set encoding utf8
set datafile separator comma

# One drawn channel a column pair: reference in column first + 2 k, approximation after it.
channels = {{channelCount}}
array name[channels]
array broad[channels]
array thin[channels]
{{#channels}}
name[{{index}}] = '{{name}}'
broad[{{index}}] = '{{broad}}'
thin[{{index}}] = '{{thin}}'
{{/channels}}

# Polar panels: outgoing elevation, full radius of the linear one, decades of the logarithmic one.
array slice[{{panelCount}}]
array top[{{panelCount}}]
array low[{{panelCount}}]
array high[{{panelCount}}]
{{#panels}}
slice[{{index}}] = {{slice}}; top[{{index}}] = {{top}}; low[{{index}}] = {{low}}; high[{{index}}] = {{high}}
{{/panels}}
slices = {{slices}}

# First and last rows of each curve in its file.
array polarFirst[{{polarCount}}]
array polarLast[{{polarCount}}]
{{#polarRows}}
polarFirst[{{index}}] = {{first}}; polarLast[{{index}}] = {{last}}
{{/polarRows}}
array halfFirst[{{halfCount}}]
array halfLast[{{halfCount}}]
{{#halfRows}}
halfFirst[{{index}}] = {{first}}; halfLast[{{index}}] = {{last}}
{{/halfRows}}
array albedoFirst[{{albedoCount}}]
array albedoLast[{{albedoCount}}]
{{#albedoRows}}
albedoFirst[{{index}}] = {{first}}; albedoLast[{{index}}] = {{last}}
{{/albedoRows}}

radius(f, p, logarithmic) = logarithmic ? \
    (f <= 10.0**low[p] ? NaN : f >= 10.0**high[p] ? 1 : (log10(f) - low[p]) / (high[p] - low[p])) : \
    (f <= 0 ? NaN : f >= top[p] ? 1 : f / top[p])
x(f, p, logarithmic) = radius(f, p, logarithmic) * sin(column(3) * pi / 180)
y(f, p, logarithmic) = radius(f, p, logarithmic) * cos(column(3) * pi / 180)
# '+' runs over the range of x, which becomes a half turn.
ringX(t) = sin(t / 1.12 * pi / 2)
ringY(t) = cos(t / 1.12 * pi / 2)

font = 'DejaVu Sans,Helvetica,Arial,sans-serif'
soft = '#8a929c'
set tics nomirror out scale 0.6

do for [k = 1:channels] {
    set linetype 2 * k - 1 linecolor rgb broad[k] linewidth 5 dashtype 1
    set linetype 2 * k linecolor rgb thin[k] linewidth 1.5 dashtype (7, 3)
}
{{#figures}}
{{#polar}}

set terminal svg size 1100, 40 + 300 * slices noenhanced font font fontscale 1.0
set output svg{{index}}
set multiplot
full = 40.0 + 300.0 * slices
unset border
unset tics
unset key
unset grid
unset xlabel
unset ylabel
unset logscale
set xrange [-1.12:1.12]
set yrange [-0.14:1.14]
do for [row = 1:slices] {
    p = {{place}} * slices + row
    do for [logarithmic = 0:1] {
        set lmargin at screen 0.02 + 0.5 * logarithmic
        set rmargin at screen 0.48 + 0.5 * logarithmic
        set bmargin at screen 1 - (20 + 300.0 * row) / full
        set tmargin at screen 1 - (20 + 300.0 * row - 289) / full
        unset label
        unset arrow
        rings = logarithmic ? high[p] - low[p] : 4
        do for [ring = 1:rings] {
            r = 1.0 * ring / rings
            set label (logarithmic ? sprintf('%g', 10.0**(low[p] + ring)) : \
                sprintf('%g', top[p] * r)) at r, -0.07 center textcolor rgb soft font ',10'
        }
        do for [spoke = -90:90:30] {
            set arrow from 0, 0 to sin(spoke * pi / 180), cos(spoke * pi / 180) nohead \
                linecolor rgb '#c8c8c8' linewidth 0.5 back
            if (abs(spoke) < 90 && abs(spoke + slice[p]) > 4) {
                set label sprintf('%d°', abs(spoke)) at 1.07 * sin(spoke * pi / 180), \
                    1.07 * cos(spoke * pi / 180) center textcolor rgb soft font ',10'
            }
        }
        side = slice[p] * pi / 180
        set arrow from -1.03 * sin(side), 1.03 * cos(side) to -1.14 * sin(side), 1.14 * cos(side) \
            size 0.03, 20 linewidth 1.5 linecolor rgb 'black'
        set label sprintf('θo = %g°, %s', slice[p], logarithmic ? 'logarithmic' : 'linear') \
            at -1.1, 1.1 left
        plot for [ring = 1:rings] '+' \
                using (ringX($1) * ring / rings):(ringY($1) * ring / rings) \
                with lines linecolor rgb '#c8c8c8' linewidth 0.5 dashtype 1, \
             for [k = 1:channels] polarCsv skip 1 every ::polarFirst[p]::polarLast[p] \
                using (x(column(2 * k + 2), p, logarithmic)): \
                      (y(column(2 * k + 2), p, logarithmic)) with lines linetype 2 * k - 1, \
             for [k = 1:channels] polarCsv skip 1 every ::polarFirst[p]::polarLast[p] \
                using (x(column(2 * k + 3), p, logarithmic)): \
                      (y(column(2 * k + 3), p, logarithmic)) with lines linetype 2 * k
    }
}
unset label
unset arrow
unset multiplot
set output
{{/polar}}
{{#half}}

set terminal svg size 1100, 620 noenhanced font font fontscale 1.0
set output svg{{index}}
set multiplot
set border 3 linewidth 0.8 linecolor rgb 'black'
set tics nomirror out scale 0.6
set grid linecolor rgb '#c8c8c8' linewidth 0.5 dashtype 1, linecolor rgb '#c8c8c8' linewidth 0.5 dashtype 1
set logscale y
set yrange [10.0**{{halfLow}}:10.0**{{halfHigh}}]
set ytics nomirror {{halfStep}}
set format y '%g'
set xrange [0:1]
set xtics nomirror ('0°' 0, '1°' sqrt(1 / 90.0), '5°' sqrt(5 / 90.0), '15°' sqrt(15 / 90.0), \
           '30°' sqrt(30 / 90.0), '45°' sqrt(45 / 90.0), '60°' sqrt(60 / 90.0), '90°' 1)
do for [panel = 0:5] {
    set lmargin at screen 0.067 + 0.327 * (panel % 3)
    set rmargin at screen 0.325 + 0.327 * (panel % 3)
    set bmargin at screen panel < 3 ? 0.57 : 0.09
    set tmargin at screen panel < 3 ? 0.95 : 0.47
    set xlabel panel >= 2 ? 'θh' : ''
    if (panel < 5) {
        unset key
        h = {{place}} * 5 + panel + 1
        set label 1 sprintf('θd = %d°', 20 * panel) at graph 0.97, graph 0.95 right
        plot for [k = 1:channels] halfCsv skip 1 every ::halfFirst[h]::halfLast[h] \
                using (sqrt(column(3) / 90)):(column(2 * k + 2)) \
                with lines linetype 2 * k - 1, \
             for [k = 1:channels] halfCsv skip 1 every ::halfFirst[h]::halfLast[h] \
                using (sqrt(column(3) / 90)):(column(2 * k + 3)) \
                with lines linetype 2 * k
    } else {
        unset label 1
        unset border
        unset tics
        unset xlabel
        unset grid
        set key at graph 0.05, graph 0.95 left top Left reverse samplen 3 spacing 1.4 noautotitle
        plot for [k = 1:channels] NaN with lines linetype 2 * k - 1 \
                title 'reference' . name[k], \
             for [k = 1:channels] NaN with lines linetype 2 * k title 'approximation' . name[k]
    }
}
unset key
unset multiplot
unset logscale
set output
{{/half}}
{{#residual}}

set terminal svg size 1100, 480 noenhanced font font fontscale 1.0
set output svg{{index}}
set multiplot
set border 15 linewidth 0.8 linecolor rgb 'black'
set tics nomirror out scale 0.6
unset grid
unset label
set object 1 rectangle from graph 0, 0 to graph 1, 1 fillcolor rgb '#9aa0a6' fillstyle solid \
    noborder behind
set lmargin at screen 0.065
set rmargin at screen 0.415
set bmargin at screen 0.13
set tmargin at screen 0.93
set xrange [0:1]
set yrange [0:90]
set xtics nomirror ('0°' 0, '1°' sqrt(1 / 90.0), '5°' sqrt(5 / 90.0), '15°' sqrt(15 / 90.0), \
           '30°' sqrt(30 / 90.0), '45°' sqrt(45 / 90.0), '60°' sqrt(60 / 90.0), '90°' 1)
set ytics nomirror 0, 15, 90
set format y '%g°'
set xlabel 'θh'
set ylabel 'θd' rotate by 0
end = log10({{ratio}})
set cbrange [-end:end]
set palette defined (-1 '#2166AC', -0.5 '#92C5DE', 0 '#F7F7F7', 0.5 '#F4A582', 1 '#B2182B')
set cbtics nomirror (sprintf('÷ %.3g', 10**end) -end, sprintf('÷ %.3g', 10**(end / 2)) -end / 2, '= 1' 0, \
            sprintf('× %.3g', 10**(end / 2)) end / 2, sprintf('× %.3g', 10**end) end)
set colorbox user origin screen 0.43, screen 0.13 size screen 0.013, screen 0.8
set label 1 'approximation / reference' at screen 0.43, screen 0.965 left
first = {{place}} * {{cells}}
inside(value) = value < -end ? -end : value > end ? end : value
plot residualCsv skip 1 every ::first::(first + {{cells}} - 1) \
    using (sqrt(column(3) / 90)):(column(2)): \
          (strlen(strcol(4)) && column(5) == 1 ? inside(column(4)) : NaN) with image
unset object
unset colorbox

set border 3
set tics nomirror out scale 0.6
set grid linecolor rgb '#c8c8c8' linewidth 0.5 dashtype 1, linecolor rgb '#c8c8c8' linewidth 0.5 dashtype 1
set lmargin at screen 0.61
set rmargin at screen 0.97
set xrange [0:90]
set yrange [0:{{albedoTop}}]
set xtics nomirror 0, 15, 90
set xtics format '%g°'
set ytics nomirror autofreq
set format y '%g'
set xlabel 'θo'
unset ylabel
set label 1 'directional albedo' at graph 0, screen 0.965 left
a = {{place}} + 1
plot for [k = 1:channels] albedoCsv skip 1 every ::albedoFirst[a]::albedoLast[a] \
        using (column(2)):(column(2 * k + 1)) \
        with lines linetype 2 * k - 1, \
     for [k = 1:channels] albedoCsv skip 1 every ::albedoFirst[a]::albedoLast[a] \
        using (column(2)):(column(2 * k + 2)) \
        with lines linetype 2 * k
unset label 1
set xtics format '%g'
unset multiplot
set output
{{/residual}}
{{/figures}}
