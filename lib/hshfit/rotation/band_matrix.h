#pragma once

#include <hshfit/rotation/rotation.h>

#include <vector>

namespace hshfit::inline rotation {

/// The matrix of a rotation in one band of the real spherical harmonics, row by row: element
/// [(l + m) (2l + 1) + l + k] is the coefficient of Y_(l,m) in Y_(l,k)(R^-1 d). The direct route,
/// for any angle:
///     d_(m-1,k) = [2 (m cos(beta) - k) / sin(beta) d_(m,k) - g_(m+1) d_(m+1,k)] / g_m,
///     g_m = sqrt((l + m)(l - m + 1)),
/// downwards from d_(l,k) in closed form to m = |k|, where values grow or oscillate, so that it is
/// stable; the others follow from symmetries. Values below the range of double carry an exponent of
/// their own. Elements are right to 1e-14 for l < 1000 (Wigner's sum in 700 digits).
/// O(l^2) operations. Throws UsageError for l < 0.
///
/// With `condonShortley` element (m, k) has the sign (-1)^(m + k) more.
std::vector<double> bandMatrix(int l, const Rotation& rotation, bool condonShortley = false);

}  // namespace hshfit::inline rotation
