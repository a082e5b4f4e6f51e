#pragma once

// Names that the statistics of fits share.

#include <Eigen/Core>

#include <cstddef>
#include <span>

namespace hshfit::brdfs {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

inline Eigen::Index at(std::size_t i) {
    return static_cast<Eigen::Index>(i);
}

inline Matrix squareMatrix(std::span<const double> values, std::size_t n) {
    return Eigen::Map<const Matrix>(values.data(), at(n), at(n));
}

/// Rounding leaves some of 1 - leverage where a value, or a scan, alone decides.
inline constexpr double leastFreedom = 1e-6;

}  // namespace hshfit::brdfs
