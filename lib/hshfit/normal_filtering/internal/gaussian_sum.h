#pragma once

#include <hshfit/normal_filtering/lobe_table.h>

namespace hshfit::inline normal_filtering {

/// The sum of Gaussians nearest to D: variances at steps of a factor 2, peaks by least squares
/// without negative ones (Lawson & Hanson 1974, NNLS), over chords in geometric steps, mean over 16
/// azimuths. Squares are weighed by 1 / (D + peak / 1000), so that tails count beside the peak.
GaussianSum fitGaussians(const NormalDistribution& distribution);

/// x >= 0 with the least |A x - b|, A given by columns (Lawson & Hanson 1974, chapter 23).
std::vector<double> nonNegativeLeastSquares(const std::vector<std::vector<double>>& columns,
                                            const std::vector<double>& b);

}  // namespace hshfit::inline normal_filtering
