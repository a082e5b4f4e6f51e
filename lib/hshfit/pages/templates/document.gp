# A document of pages for gnuplot, which reads `pdf`, the file to write, and csv1, csv2, …
font = '{{font}},{{fontSize}}'

set encoding utf8
set datafile separator comma
unset key

set terminal pdfcairo size {{widthCm}}cm,{{heightCm}}cm enhanced color rounded font font fontscale 0.75
set output pdf
{{#pages}}
set multiplot
{{#statements}}
{{{statement}}}
{{/statements}}
set lmargin at screen 0
set rmargin at screen 1
set bmargin at screen 0
set tmargin at screen 1
unset border
unset tics
unset logscale
plot [0:1] [0:1] -1 notitle
unset label
unset arrow
unset object
{{#figures}}
{{>figureSpace}}
{{>figurePanels}}
{{/figures}}
unset multiplot
{{/pages}}
set output
