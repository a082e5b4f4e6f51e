#pragma once

#include <hshfit/accuracy/pair_sample.h>
#include <hshfit/linear_algebra/decompositions.h>
#include <hshfit/material_library/internal/seen_pairs.h>

#include <cstddef>

namespace hshfit::material_library {

/// Zones of pairs in which the rest beyond the terms is alike: by the angle of the lower direction,
/// up to 60, 75, 85 and 90 degrees, then by the angle of the half vector, up to 2, 20 and 90.
inline constexpr std::size_t restZones = 12;
/// Measured::rest has the zones for the sum of the channels, then the zones for their differences.
inline constexpr std::size_t restRows = 2 * restZones;
std::size_t restZone(const Direction& wi, const Direction& wo);

/// The sum of three channels and two differences: an orthogonal matrix.
Eigen::Matrix3d planeMatrix();

/// Fixed pairs with weights that sum to 1, the terms at each, and the metric that they give:
///     |d|^2 = c^T A c,   A = X^T W X + ridge,   d = L^T c,   A = L L^T,
/// the weighted mean of squares of a sum of terms with the numbers c.
struct LogSamples {
    LogSamples();

    PairSample pairs;
    Eigen::VectorXd weights;
    linear_algebra::RowMajor terms;  ///< X: [pair][term]
    Eigen::MatrixXd metric;          ///< A
    Eigen::MatrixXd lower;           ///< L
    SeenPairs seen;

    /// The terms at every `peakStep`th pair, by which codes see peaks.
    static constexpr Eigen::Index peakStep = 8;
    Eigen::Map<const linear_algebra::RowMajor, 0, Eigen::OuterStride<>> few() const;
    /// Weights at every `step`th pair by (f c)^2, c = cos(theta_i) and f by its ln(f + logOffset)
    /// there, that add up to 1: [pair][channel].
    Eigen::MatrixXd peakWeights(const Eigen::MatrixXd& logs, Eigen::Index step) const;
    /// ln(f + logOffset) of a material at every `peakStep`th pair, [pair][channel].
    Eigen::MatrixXd peakLogs(const LogMaterial& material) const;

    /// A^-1 b, column by column.
    Eigen::MatrixXd solve(Eigen::MatrixXd right) const;
};

}  // namespace hshfit::material_library
