#pragma once

#include <hshfit/linear_algebra/decompositions.h>
#include <hshfit/material_library/library.h>

#include <array>
#include <cstddef>
#include <random>
#include <vector>

namespace hshfit::material_library {

/// The planes of channels (planeMatrix()), which count as independent.
inline constexpr std::size_t planes = 3;

/// A normal distribution of one plane of materials, in the numbers d = L^T c of LogSamples.
struct Normal {
    Eigen::VectorXd mean;
    Eigen::MatrixXd covariance;
};
using Prior = std::array<Normal, planes>;

/// The distributions that materials give. Within as many components as the basis has, the
/// covariance is shrunk towards its diagonal by K / (K + M), with K components and M materials.
/// Beyond the components it is the covariance of the rests of materials that took no part in
/// finding them, half of it alike in all directions.
struct MaterialPrior {
    /// The materials that `library` was learned from or, where it is final, the materials that its
    /// codes hold; at most a thousand, spread evenly. Throws InputError for fewer than three.
    MaterialPrior(const LogSpace& space, const Library& library);

    std::size_t count() const { return static_cast<std::size_t>(numbers[0].cols()); }
    const Prior& without(std::size_t material) const { return folds[material % folds.size()]; }
    /// Mean squares of ln(f + logOffset) beyond the terms, by restRow().
    double rest(Eigen::Index row) const { return rests.row(row).mean(); }

    double top = 0;                               ///< the greatest ln(f + logOffset) of all
    std::array<Eigen::MatrixXd, planes> numbers;  ///< [term][material]
    Eigen::MatrixXd rests;                        ///< [restRow][material]
    Prior all;
    std::vector<Prior> folds;  ///< of all but every n-th material
};

/// The row of Measured::rest of a plane and a zone.
Eigen::Index restRow(std::size_t plane, std::size_t zone);

/// Normal numbers of mean 0 and variance 1, the same on every machine.
Eigen::VectorXd normalNumbers(Eigen::Index count, std::mt19937_64& random);

}  // namespace hshfit::material_library
