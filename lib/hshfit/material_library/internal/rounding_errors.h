#pragma once

#include <hshfit/material_library/basis.h>
#include <hshfit/material_library/form_error.h>
#include <hshfit/material_library/log_space.h>

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

namespace hshfit::material_library {

/// A material in all terms, and its codes in a basis.
struct RoundedMaterial {
    const Measured& measured;
    std::span<const std::uint8_t> codes;
};

/// The distances of materials in a basis from their sums of all terms: formError over errorPairs(),
/// in single precision, of many materials together. The terms at all pairs take 27 MB.
class RoundingErrors {
public:
    explicit RoundingErrors(const Basis& basis);
    /// The errors, without FLIP. The digits do not depend on threads, but on which materials are
    /// together.
    std::vector<FormError> of(std::span<const RoundedMaterial> materials) const;

private:
    using Rows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

    const Basis& basis_;
    Rows terms_;      ///< [pair][term]
    Rows functions_;  ///< [pair][function]: the mean, then the components
};

}  // namespace hshfit::material_library
