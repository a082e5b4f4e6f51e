#pragma once

#include <hshfit/rotation/rotation.h>

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace hshfit::inline rotation {

/// Rotation of coefficients of the real spherical harmonics (bases/sh.h), exact in every band:
///     sum of c'_i Y_i(d) = sum of c_i Y_i(R^-1 d).
/// Route ZXZXZ with fixed quarter turns (Schönefeld 2005, 5.3; Pinchon & Hoggan 2007):
///     R = R_z(alpha) S R_z(-beta) S R_z(gamma),  S = exchange of y and z,
/// turns about z as 2 x 2 blocks in +-m, S as a sparse symmetric matrix per band that is made once.
///
/// Errors relative to the norm of a vector: below 1e-13 at order 100, 1e-12 at 300, 1e-11 at 1000
/// (docs/explanation/rotation.md). Tables take 12 bytes for each coefficient; a band of S is made
/// when it is applied, and takes 4 bytes for each entry of the band's matrix. Immutable; safe to
/// use from many threads; bands run in parallel.
class ShRotation {
public:
    static constexpr int maxOrder = 1000;

    struct Options {
        /// The coefficients carry the Condon-Shortley sign.
        bool condonShortley = false;
    };
    /// Throws UsageError unless 1 <= order <= maxOrder.
    explicit ShRotation(int order, Options options);
    explicit ShRotation(int order) : ShRotation(order, Options()) {}
    ~ShRotation();
    ShRotation(ShRotation&&) noexcept;
    ShRotation& operator=(ShRotation&&) noexcept;

    int order() const { return order_; }

    /// `channels` vectors under each rotation: in[(r * channels + c) * order^2 + slot] to the same
    /// place of `out`, which may be `in`.
    void rotate(std::span<const Rotation> rotations, std::size_t channels, const double* in,
                double* out) const;
    std::vector<double> rotate(const Rotation& rotation, std::span<const double> c) const;

private:
    struct Tables;
    int order_;
    Options options_;
    std::unique_ptr<const Tables> tables_;
};

}  // namespace hshfit::inline rotation
