#pragma once

// The parts of writeComparison, apart from the folder that they go to.

#include <hshfit/pages/comparison.h>

#include <string>
#include <vector>

namespace hshfit::inline pages {

/// A figure that comparison.gp draws.
struct ComparisonFigure {
    std::string kind;  ///< polar, half or residual
    double azimuth = 0;
    std::string file;  ///< "polar-90.svg"
};

/// Azimuth by azimuth: polar, half, residual.
std::vector<ComparisonFigure> figuresOf(const Comparison& comparison);

/// Azimuth, theta_o, theta_i, then reference and approximation of every drawn channel; empty where
/// a value is not finite.
std::string polarCsv(const Comparison& comparison);
/// Azimuth, theta_d, theta_h, then as polarCsv.
std::string halfCsv(const Comparison& comparison);
/// Azimuth, theta_o, then as polarCsv.
std::string albedoCsv(const Comparison& comparison);
/// Azimuth, theta_d, theta_h, log10_ratio (empty where there is none), measured (0 or 1).
std::string residualCsv(const Comparison& comparison);

/// The ratio at the ends of the colour bar, which 98 % of the cells keep to.
double largestRatio(const Comparison& comparison);

/// The script of gnuplot that draws the figures, and comparison.json.
std::string comparisonScript(const Comparison& comparison);
std::string comparisonJson(const Comparison& comparison);

/// `figures` holds the SVG documents of figuresOf, or nothing at all; `spheres` is a PNG file;
/// `opening` is HTML in front of its sections.
std::string comparisonPage(const Comparison& comparison, const std::vector<std::string>& figures,
                           const std::string& spheres, const std::string& opening = {});

/// Shares of the cells of all maps where the reference was measured.
struct ResidualShares {
    std::size_t cells = 0;  ///< measured ones
    std::size_t unmeasured = 0;
    std::size_t noRatio = 0;   ///< measured ones without a ratio
    double median = 0;         ///< of |log10 ratio|; 0 without any
    double most = 0;           ///< the 98th percentile of it
    double withinTenth = 0;    ///< share of cells with a ratio within 10 %
    double withinTwofold = 0;  ///< and within a factor of two
};
ResidualShares residualShares(const Comparison& comparison);

}  // namespace hshfit::inline pages
