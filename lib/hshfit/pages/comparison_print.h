#pragma once

#include <hshfit/pages/comparison.h>
#include <hshfit/pages/print_figure.h>

#include <vector>

namespace hshfit::inline pages {

/// The plots of a comparison for print, for each azimuth A: polar-A, f in the plane of incidence;
/// half-A, over theta_h; albedo-A; and residual-A, the map of log10(approximation / reference) at
/// one scale of colours whose lightness grows, so that its sign is seen in greyscale too.
std::vector<PrintFigure> printFigures(const Comparison& comparison, const FigureStyle& style);

}  // namespace hshfit::inline pages
