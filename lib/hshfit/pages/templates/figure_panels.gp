{{#legend}}
    {{{statement}}}
{{/legend}}
{{#panels}}
    set lmargin at screen {{left}}
    set rmargin at screen {{right}}
    set bmargin at screen {{bottom}}
    set tmargin at screen {{top}}
    set label 1000 {{{title}}} at screen {{left}}, screen {{titleAt}} left
    floor = {{floor}}
    unset logscale
{{#axes}}
    set border 3 linewidth 0.6 linecolor rgb 'black'
    set xrange [{{xLow}}:{{xHigh}}]
    set yrange [{{yLow}}:{{yHigh}}]
    set xtics nomirror out scale 0.5,0.25 offset 0,0.3 ({{{xTicks}}})
    set ytics nomirror out scale 0.5,0.25 offset 0.4,0 ({{{yTicks}}})
    set label 1001 {{{xLabel}}} at screen {{middle}}, screen {{xLabelAt}} center
    set label 1002 {{{yLabel}}} at screen {{yLabelAt}}, screen {{centre}} center rotate by 90
{{#logarithmic}}
    set logscale y
{{/logarithmic}}
{{/axes}}
{{#map}}
    set border 15 linewidth 0.6 linecolor rgb 'black'
    set palette defined (-1 '#00204D', -0.5 '#414D6B', 0 '#7C7B78', 0.5 '#BCAF6F', 1 '#FFEA46')
    set cbrange [{{zLow}}:{{zHigh}}]
    set cbtics nomirror out scale 0.5 offset -0.4,0 ({{{zTicks}}})
    set colorbox user origin screen {{right}} + {{barGap}}, screen {{bottom}} size screen {{barWidth}}, screen {{top}} - {{bottom}}
    set object 1000 rectangle from graph 0, 0 to graph 1, 1 fillcolor rgb 'white' fillstyle pattern 4 noborder behind
    shown(value) = value < {{zLow}} ? {{zLow}} : value > {{zHigh}} ? {{zHigh}} : value
{{/map}}
{{#polar}}
    unset border
    unset tics
    logarithmic = {{polarLogarithmic}}
    low = {{polarLow}}
    high = {{polarHigh}}
    set xrange [-1.12:1.12]
    set yrange [-0.14:1.14]
{{#rings}}
    set label {{{label}}} at {{at}}, -0.08 center textcolor rgb '#555555' font ',{{ringFont}}'
{{/rings}}
    do for [spoke = -90:90:30] {
        set arrow from 0, 0 to sin(spoke * pi / 180), cos(spoke * pi / 180) nohead linecolor rgb '#c8c8c8' linewidth 0.4 back
        if (abs(spoke) < 90 && abs(spoke + {{arrow}}) > 6) {
            set label sprintf('%d°', abs(spoke)) at 1.08 * sin(spoke * pi / 180), 1.08 * cos(spoke * pi / 180) center textcolor rgb '#555555' font ',{{ringFont}}'
        }
    }
{{#arrow}}
    set arrow from -1.14 * sin({{arrow}} * pi / 180), 1.14 * cos({{arrow}} * pi / 180) to -1.02 * sin({{arrow}} * pi / 180), 1.02 * cos({{arrow}} * pi / 180) size 0.05, 20 filled linewidth 1 linecolor rgb 'black'
{{/arrow}}
{{/polar}}
    plot 1/0 notitle{{#ringCurves}}, \
        '+' using ({{at}} * sin($1 / 1.12 * pi / 2)):({{at}} * cos($1 / 1.12 * pi / 2)) with lines linecolor rgb '#c8c8c8' linewidth 0.4{{/ringCurves}}{{#series}}{{#line}}, \
        csv{{figure}} skip 1 every ::{{first}}::{{last}} using (px(given(4), given(5))):(py(given(4), placed(given(5)))) with lines linecolor rgb '{{ink}}' linewidth {{width}} dashtype {{dash}}{{/line}}{{#band}}, \
        csv{{figure}} skip 1 every ::{{first}}::{{last}} using (px(given(4), given(6))):(raised(given(6))):(raised(given(7))) with filledcurves fillcolor rgb '{{ink}}' fillstyle solid noborder{{/band}}{{#ends}}, \
        csv{{figure}} skip 1 every ::{{first}}::{{last}} using (px(given(4), given(6))):(py(given(4), given(6))) with lines linecolor rgb '{{ink}}' linewidth 1 dashtype 1, \
        csv{{figure}} skip 1 every ::{{first}}::{{last}} using (px(given(4), given(7))):(py(given(4), given(7))) with lines linecolor rgb '{{ink}}' linewidth 1 dashtype 1{{/ends}}{{#bars}}, \
        csv{{figure}} skip 1 every ::{{first}}::{{last}} using (px(given(4), raised(given(6)))):(py(given(4), raised(given(6)))):(px(given(4), placed(given(7))) - px(given(4), raised(given(6)))):(py(given(4), placed(given(7))) - py(given(4), raised(given(6)))) with vectors nohead linecolor rgb '{{ink}}' linewidth 0.6 dashtype 1{{/bars}}{{#points}}, \
        csv{{figure}} skip 1 every ::{{first}}::{{last}} using (px(given(4), given(5))):(py(given(4), placed(given(5)))) with points linecolor rgb '{{ink}}' linewidth 0.7 pointtype {{marker}} pointsize {{size}}, \
        csv{{figure}} skip 1 every ::{{first}}::{{last}} using (px(given(4), floor)):(isBelow(given(5)) ? py(given(4), floor) : NaN) with points linecolor rgb '{{ink}}' linewidth 0.7 pointtype 10 pointsize {{size}}{{/points}}{{#image}}, \
        csv{{figure}} skip 1 every ::{{first}}::{{last}} using (px(given(4), 0)):(given(5)):(shown(given(6))) with image{{/image}}{{/series}}

    unset label
    unset arrow
    unset object
{{/panels}}
