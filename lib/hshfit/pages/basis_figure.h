#pragma once

#include <hshfit/bases/basis.h>

#include <string>

namespace hshfit::inline pages {

/// The domain of the functions that a figure shows.
enum class FigureDomain { hemisphere, sphere };

/// Draws the functions of a basis to `path`, .png, .svg or .pdf, with gnuplot: |B_l^m| is the
/// radius in each direction, orange where the function is positive and blue where it is negative,
/// each function scaled to the same largest radius, a row for each l and a column for each m.
/// Functions that are 0 on the domain are left out. Fig. 10 of Gautron et al. 2004; with the domain
/// `sphere`, for bases that are defined below the horizon, Fig. 6 of Schönefeld 2005.
///
/// Throws UsageError for another extension, an order above 8, or a sphere where the basis has only
/// a hemisphere; NoFigures without gnuplot; OutputError where the file cannot be written.
void writeBasisFigure(const Basis& basis, FigureDomain domain, const std::string& path);

}  // namespace hshfit::inline pages
