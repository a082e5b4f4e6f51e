# Figures for print.
# Run `gnuplot figures.gp` in this folder: reads the .csv files, writes the .pdf and .svg files.
# Other names: gnuplot -e "pdf1='a.pdf'" figures.gp …
{{#figures}}
if (!exists("csv{{index}}")) csv{{index}} = '{{name}}.csv'
if (!exists("pdf{{index}}")) pdf{{index}} = '{{name}}.pdf'
if (!exists("svg{{index}}")) svg{{index}} = '{{name}}.svg'
{{/figures}}
font = '{{font}},{{fontSize}}'

set encoding utf8
set datafile separator comma
unset key

{{#figures}}
{{>figureSpace}}
do for [format in "pdf svg"] {
    if (format eq "pdf") {
        set terminal pdfcairo size {{widthCm}}cm,{{heightCm}}cm enhanced color rounded font font fontscale 0.75
        set output pdf{{index}}
    } else {
        set terminal svg size {{widthPt}},{{heightPt}} enhanced rounded linewidth 0.5 font font fontscale 1.0
        set output svg{{index}}
    }
    set multiplot
{{>figurePanels}}
    unset multiplot
    set output
}
{{/figures}}
