# Captured energy (Gautron et al. 2004, Eq. 15) of each BRDF, basis and order.
# Run `gnuplot curves.gp` in this folder: reads curves.csv, writes curves.svg and curves.pdf.
# Some of the rows, other names, or no file: gnuplot -e "first=2; last=2; svg='a.svg'; pdf=''" …

if (!exists("first")) first = 1
if (!exists("last")) last = {{rows}}
if (!exists("csv")) csv = 'curves.csv'
if (!exists("svg")) svg = 'curves.svg'
if (!exists("pdf")) pdf = 'curves.pdf'

set encoding utf8
set datafile separator comma

# One entry a row: its title, why it has no curves, the ends of its axes, how
# many points go to a mark, and the places of the bases that have a curve.
array rowTitle[{{rows}}]
array reason[{{rows}}]
array maxCount[{{rows}}]
array maxOrder[{{rows}}]
array leastMissing[{{rows}}]
array interval[{{rows}}]
array own[{{rows}}]
{{#entries}}
rowTitle[{{index}}] = {{{title}}}
reason[{{index}}] = {{{reason}}}
maxCount[{{index}}] = {{maxCount}}
maxOrder[{{index}}] = {{maxOrder}}
leastMissing[{{index}}] = {{leastMissing}}
interval[{{index}}] = {{interval}}
own[{{index}}] = {{{own}}}
{{/entries}}

bases = '{{bases}}'
{{#styles}}
set linetype {{index}} linecolor rgb '{{colour}}' dashtype {{dash}} linewidth 1.8 \
    pointtype {{point}} pointsize 0.55
{{/styles}}

# Columns of curves.csv: report, basis, order, coefficients, slots, accuracy, …
# The axis shows what is missing, logarithmically and downwards, labelled with what is captured.
is(row, basis) = column(1) == row && strcol(2) eq word(bases, basis)
missing(row) = 1 - column(6) < leastMissing[row] ? leastMissing[row] : \
               1 - column(6) > 1 ? 1 : 1 - column(6)

set border 3 linewidth 0.8 linecolor rgb 'black'
set tics nomirror out scale 0.6
set grid linecolor rgb '#c8c8c8' linewidth 0.5 dashtype 1, linecolor rgb '#c8c8c8' linewidth 0.5 dashtype 1
set logscale y
set format y ''
unset key

rows = last - first + 1
rowHeight = 1.0 / rows
do for [pass = 1:2] {
    file = pass == 1 ? svg : pdf
    if (file eq '') { continue }
    if (pass == 1) {
        set terminal svg size 1100, 380 * rows noenhanced \
            font 'DejaVu Sans,Helvetica,Arial,sans-serif' fontscale 1.0
    } else {
        set terminal pdfcairo size 11, 3.8 * rows noenhanced \
            font 'DejaVu Sans,11' linewidth 1.6
    }
    set output file
    set multiplot
    do for [row = first:last] {
        bottom = 1 - (row - first + 1) * rowHeight
        set bmargin at screen bottom + 0.16 * rowHeight
        set tmargin at screen bottom + 0.86 * rowHeight
        set yrange [1:leastMissing[row]]
        if (leastMissing[row] > 0.3) {
            set ytics ('0 %%' 1, '10 %%' 0.9, '20 %%' 0.8, '30 %%' 0.7, '40 %%' 0.6, '50 %%' 0.5)
        } else { if (leastMissing[row] > 0.05) {
            set ytics ('0 %%' 1, '20 %%' 0.8, '40 %%' 0.6, '60 %%' 0.4, '80 %%' 0.2, '90 %%' 0.1)
        } else {
            set ytics ('0 %%' 1, '50 %%' 0.5, '80 %%' 0.2, '90 %%' 1e-1, '99 %%' 1e-2, \
                       '99.9 %%' 1e-3, '99.99 %%' 1e-4, '99.999 %%' 1e-5, '99.9999 %%' 1e-6)
        } }
        set label 1 rowTitle[row] at screen 0.105, screen bottom + 0.95 * rowHeight left
        if (reason[row] eq '') {
            unset label 2
        } else {
            set label 2 reason[row] at graph 0.5, graph 0.55 center
        }

        set lmargin at screen 0.105
        set rmargin at screen 0.435
        set label 3 'captured energy' at screen 0.016, screen bottom + 0.51 * rowHeight \
            center rotate
        set xlabel 'coefficients'
        set logscale x
        set xrange [1:maxCount[row]]
        set xtics (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 1e4, 1e5, 1e6)
        plot for [basis = 1:words(bases)] csv skip 1 \
            using (is(row, basis) ? column(4) : NaN):(missing(row)) \
            with linespoints linetype basis pointinterval interval[row]

        unset label 1
        unset label 3
        set lmargin at screen 0.52
        set rmargin at screen 0.85
        set xlabel 'order'
        unset logscale x
        set xrange [1:maxOrder[row]]
        set xtics autofreq
        if (reason[row] eq '') {
            set key at screen 0.86, screen bottom + 0.84 * rowHeight left top Left reverse \
                samplen 2.5 spacing 1.25 noautotitle
        }
        plot for [basis = 1:words(bases)] csv skip 1 \
            using (is(row, basis) ? column(3) : NaN):(missing(row)) \
            title (strstrt(own[row], sprintf(' %d ', basis)) ? word(bases, basis) : '') \
            with linespoints linetype basis pointinterval interval[row]
        unset key
    }
    unset multiplot
    set output
}
