# Columns of the data: 4 and 5 are x and y, 6 and 7 the ends of bars and bands.
given(c) = strlen(strcol(c)) ? column(c) : NaN
# Values at or below `floor` have no place on a logarithmic axis, or in a polar plot.
placed(f) = f > floor ? f : NaN
raised(f) = f > floor ? f : floor
isBelow(f) = f <= floor
{{#axes}}
px(t, f) = t
py(t, f) = f
{{/axes}}
{{#rooted}}
px(t, f) = sqrt(t / 90.0)
{{/rooted}}
{{#polar}}
radius(f) = logarithmic ? (f <= floor ? 0 : (log10(f) - low) / (high - low)) : (f <= 0 ? 0 : f / high)
px(t, f) = radius(f) * sin(t * pi / 180)
py(t, f) = radius(f) * cos(t * pi / 180)
{{/polar}}
