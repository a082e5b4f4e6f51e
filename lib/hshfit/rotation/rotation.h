#pragma once

#include <hshfit/brdf/directions.h>

#include <array>
#include <span>

namespace hshfit::inline rotation {

/// A rotation of directions, active: the vector d becomes R d, and a function f becomes
/// f(R^-1 d). Angles in radians. Each maker throws UsageError for values that are not finite, and
/// where stated below; a matrix is made orthonormal to rounding.
class Rotation {
public:
    /// The identity.
    Rotation() = default;

    /// Row by row. Throws UsageError where R R^T differs from the identity by more than 1e-6 in an
    /// element, or the determinant is negative.
    static Rotation fromMatrix(const std::array<double, 9>& rows);
    /// R_z(alpha) R_y(beta) R_z(gamma): gamma about +z comes first. Any real angles.
    static Rotation euler(double alpha, double beta, double gamma);
    /// By `angle` about an axis of any length but 0, right-handed.
    static Rotation aboutAxis(const Direction& axis, double angle);
    /// From a quaternion of any length but 0; q and -q are the same rotation.
    static Rotation fromQuaternion(double w, double x, double y, double z);
    /// +z goes to `up`, of any length but 0, along the shortest arc; to -z by half a turn about y.
    static Rotation zTo(const Direction& up);

    const std::array<double, 9>& matrix() const { return rows_; }
    Direction operator()(const Direction& d) const;
    Rotation inverse() const;
    /// `second` after `first`: (second * first)(d) = second(first(d)).
    friend Rotation operator*(const Rotation& second, const Rotation& first);

    /// Cosines and sines of the Euler angles, beta from 0 to pi; alpha = 0 where sin(beta) = 0.
    /// Accurate for every rotation: near beta = 0 alpha + gamma keeps its digits.
    struct Turns {
        double cosAlpha, sinAlpha, cosBeta, sinBeta, oneMinusCosBeta, cosGamma, sinGamma;
    };
    Turns turns() const;

private:
    std::array<double, 9> rows_{1, 0, 0, 0, 1, 0, 0, 0, 1};
};

/// The angle of `rotation`, from 0 to pi.
double angleOf(const Rotation& rotation);
/// Whether it moves nothing at all.
bool isIdentity(const Rotation& rotation);

}  // namespace hshfit::inline rotation
