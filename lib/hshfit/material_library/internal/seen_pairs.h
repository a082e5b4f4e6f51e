#pragma once

#include <hshfit/brdf/directions.h>
#include <hshfit/linear_algebra/decompositions.h>
#include <hshfit/material_library/log_brdf.h>

#include <cstddef>
#include <vector>

namespace hshfit::material_library {

/// The pairs of lit pixels of spheres, each under one lamp, 5, 20, 35, 50, 65 or 80 degrees from
/// the line of sight; half of each, since the other is its mirror image.
struct SeenPairs {
    SeenPairs();

    /// ln(f + logOffset) of a material there: [pair][channel].
    Eigen::MatrixXd logs(const LogMaterial& material) const;

    /// The weights with which pictures see squares of relative errors of f,
    ///     (f c / (f c + s))^2 / pairs,
    /// s a tenth of the median of f c over the pixels of the lamp, f by its `logs`:
    /// [pair][channel].
    Eigen::MatrixXd weights(const Eigen::MatrixXd& logs) const;

    /// The squares of colour differences that FLIP sees, to first order,
    ///     sum over c and d of metric(pair, n c + d) e_c e_d,
    /// e errors of the n = 1 or 3 channels of `logs` at a pair: |J e|^2 / pairs, J the Jacobian of
    /// Hunt-adjusted L*a*b* over 40, which is about 1 for a bright grey. The exposure is the
    /// longest of flipExposures() at which the pixel is not clipped.
    Eigen::MatrixXd colours(const Eigen::MatrixXd& logs) const;

    std::vector<DirectionPair> pairs;
    std::vector<std::size_t> first;  ///< where each lamp's pairs begin, and their number
    Eigen::VectorXd cosines;         ///< c = cos(theta_i)
    linear_algebra::RowMajor terms;  ///< [pair][term]

private:
    /// f c by ln(f + logOffset).
    Eigen::MatrixXd lit(const Eigen::MatrixXd& logs) const;
};

}  // namespace hshfit::material_library
