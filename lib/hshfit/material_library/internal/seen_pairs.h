#pragma once

#include <hshfit/linear_algebra/decompositions.h>
#include <hshfit/material_library/log_brdf.h>

#include <cstddef>
#include <vector>

namespace hshfit::material_library {

/// The pairs of lit pixels of spheres, each under one lamp, 5, 20, 35, 50, 65 or 80 degrees from
/// the line of sight; half of each, since the other is its mirror image.
struct SeenPairs {
    SeenPairs();

    /// The weights with which pictures see squares of relative errors of f,
    ///     (f c / (f c + s))^2 / pairs,
    /// s a tenth of the median of f c over the pixels of the lamp, f by the sums of the material:
    /// [pair][channel].
    Eigen::MatrixXd weights(const LogMaterial& material) const;

    std::vector<std::size_t> first;  ///< where each lamp's pairs begin, and their number
    Eigen::VectorXd cosines;         ///< c = cos(theta_i)
    linear_algebra::RowMajor terms;  ///< [pair][term]
};

}  // namespace hshfit::material_library
