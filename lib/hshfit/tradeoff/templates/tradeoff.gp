# Error against size and, where it was timed, against time, of every form of each BRDF.
# Run `gnuplot tradeoff.gp` in this folder: reads forms.csv and front.csv, writes front.svg;
# where timing.csv and timing_front.csv are there, writes timing.svg.
# Some of the rows, or another name: gnuplot -e "first=2; last=2; svg='a.svg'; timed=0" …

if (!exists("first")) first = 1
if (!exists("last")) last = {{rows}}

set encoding utf8
set datafile separator comma

array rowTitle[{{rows}}]
array channels[{{rows}}]
array smallest[{{rows}}]
array largest[{{rows}}]
array lowest[{{rows}}]
array highest[{{rows}}]
{{#entries}}
rowTitle[{{index}}] = {{{title}}}
channels[{{index}}] = {{channels}}
smallest[{{index}}] = {{smallest}}
largest[{{index}}] = {{largest}}
lowest[{{index}}] = {{lowest}}
highest[{{index}}] = {{highest}}
{{/entries}}
metric = {{{metric}}}

series = 'outgoing outgoing-factored basis basis-factored halfway{{#wavelets}} wavelets{{/wavelets}}'
array name[{{kinds}}] = ['per outgoing direction', 'the same, factored', 'both in one basis', \
                 'the same, factored', 'half and difference'{{#wavelets}}, 'wavelets, best k'{{/wavelets}}]
set linetype 1 linecolor rgb '#0072B2' pointtype 7 pointsize 0.35
set linetype 2 linecolor rgb '#56B4E9' pointtype 6 pointsize 0.4
set linetype 3 linecolor rgb '#D55E00' pointtype 5 pointsize 0.35
set linetype 4 linecolor rgb '#E69F00' pointtype 4 pointsize 0.4
set linetype 5 linecolor rgb '#009E73' pointtype 9 pointsize 0.55{{#wavelets}}
set linetype 6 linecolor rgb '#882255' pointtype 12 pointsize 0.5{{/wavelets}}

# Columns: brdf, series, cost, error, …; of the fronts: brdf, cost, error, knee, …
is(row, kind) = column(1) == row && column(2) == kind
positive(x) = x > 0 ? x : NaN
# An error of 0 is shown at the lower edge.
shown(x, row) = x > lowest[row] ? x : x >= 0 ? lowest[row] : NaN

set border 3 linewidth 0.8 linecolor rgb 'black'
set tics nomirror out scale 0.6
set grid linecolor rgb '#c8c8c8' linewidth 0.5 dashtype 1, linecolor rgb '#c8c8c8' linewidth 0.5 dashtype 1
set logscale xy
set format y '%g'
unset key

rows = last - first + 1
rowHeight = 1.0 / rows
if (exists("timed")) { from = timed; to = timed } else { from = 0; to = {{timed}} }
do for [pass = from:to] {
    data = exists("dataCsv") ? dataCsv : pass == 0 ? 'forms.csv' : 'timing.csv'
    front = exists("frontCsv") ? frontCsv : pass == 0 ? 'front.csv' : 'timing_front.csv'
    set terminal svg size 1000, 460 * rows noenhanced \
        font 'DejaVu Sans,Helvetica,Arial,sans-serif' fontscale 1.0
    if (exists("svg")) { set output svg } else { set output pass == 0 ? 'front.svg' : 'timing.svg' }
    set multiplot
    do for [row = first:last] {
        bottom = 1 - (row - first + 1) * rowHeight
        set bmargin at screen bottom + 0.13 * rowHeight
        set tmargin at screen bottom + 0.89 * rowHeight
        set lmargin at screen 0.10
        set rmargin at screen 0.76
        set label 1 rowTitle[row] at screen 0.10, screen bottom + 0.95 * rowHeight left
        set label 2 metric at screen 0.018, screen bottom + 0.51 * rowHeight center rotate
        set xlabel pass == 0 ? 'bytes' : 'nanoseconds a pair of directions, 4096 at a time, one thread'
        set xrange [*:*]
        set yrange [lowest[row]:highest[row]]
        set ytics auto
        set ytics add ('0' lowest[row])
        if (pass == 0) {
            set xrange [smallest[row]:largest[row]]
            set xtics ('64' 64, '256' 256, '1 KiB' 1024, '4 KiB' 4096, '16 KiB' 16384, \
                       '64 KiB' 65536, '256 KiB' 262144, '1 MiB' 1048576, '4 MiB' 4194304, \
                       '16 MiB' 16777216)
            # Sizes of published representations: 675 float weights (Sztrajman et al. 2021), and
            # 16 KiB a channel (Dupuy & Jakob 2018).
            set arrow 1 from first 2700, graph 0 to first 2700, graph 1 nohead dashtype 3 \
                linecolor rgb '#808080'
            set label 3 ' network' at first 2700, graph 0.97 left textcolor rgb '#808080'
            set arrow 2 from first 16384 * channels[row], graph 0 \
                to first 16384 * channels[row], graph 1 nohead dashtype 3 linecolor rgb '#808080'
            set label 4 ' RGL' at first 16384 * channels[row], graph 0.97 left \
                textcolor rgb '#808080'
        } else {
            set xtics auto
            unset arrow 1
            unset arrow 2
            unset label 3
            unset label 4
        }
        set key at screen 0.80, screen bottom + 0.87 * rowHeight left top Left reverse \
            samplen 1.5 spacing 1.25 noautotitle
        plot for [kind = 1:{{kinds}}] data skip 1 \
                using (is(row, kind) ? positive(column(3)) : NaN):(shown(column(4), row)) \
                title name[kind] with points linetype kind, \
             front skip 1 using (column(1) == row ? column(2) : NaN):(shown(column(3), row)) \
                title 'front' with steps linecolor rgb 'black' linewidth 1.2, \
             front skip 1 using (column(1) == row && column(4) == 1 ? column(2) : NaN):(shown(column(3), row)) \
                title 'its knee' with points pointtype 6 pointsize 1.6 linewidth 1.8 linecolor rgb 'black'
        unset key
        unset label 1
        unset label 2
    }
    unset multiplot
    set output
}
