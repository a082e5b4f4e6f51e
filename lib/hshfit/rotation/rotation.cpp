#include <hshfit/rotation/rotation.h>

#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline rotation {
namespace {

using Rows = std::array<double, 9>;

/// The largest element of R R^T - I that counts as rounding of a caller's numbers.
constexpr double tolerance = 1e-6;

template <std::size_t n>
void requireFinite(const std::array<double, n>& values, const char* what) {
    if (!std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); }))
        throw UsageError(fmt::format("{} of a rotation: every number has to be finite", what));
}

/// Three numbers over their length. Scaled first, so that no square over- or underflows.
Direction unit(const Direction& d, const char* what) {
    requireFinite<3>({d.x, d.y, d.z}, what);
    const double largest = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
    if (largest == 0)
        throw UsageError(fmt::format("{} of a rotation: 0,0,0 has no direction", what));
    const Direction s{d.x / largest, d.y / largest, d.z / largest};
    const double length = std::sqrt(dot(s, s));
    return {s.x / length, s.y / length, s.z / length};
}

Rows product(const Rows& a, const Rows& b) {
    Rows c{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            c[3 * i + j] = a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
    return c;
}

Rows transposed(const Rows& a) {
    return {a[0], a[3], a[6], a[1], a[4], a[7], a[2], a[5], a[8]};
}

/// The largest element of R R^T - I in magnitude.
double defectOf(const Rows& r) {
    const Rows gram = product(r, transposed(r));
    double largest = 0;
    for (std::size_t i = 0; i < 9; ++i)
        largest = std::max(largest, std::abs(gram[i] - (i % 4 == 0 ? 1 : 0)));
    return largest;
}

/// Newton's step R (3 I - R^T R) / 2 towards the nearest orthogonal matrix squares the defect.
Rows orthonormal(Rows r) {
    for (int step = 0; step < 2; ++step) {
        const Rows gram = product(transposed(r), r);
        Rows factor;
        for (std::size_t i = 0; i < 9; ++i) factor[i] = (i % 4 == 0 ? 1.5 : 0) - 0.5 * gram[i];
        r = product(r, factor);
    }
    return r;
}

}  // namespace

Rotation Rotation::fromMatrix(const Rows& rows) {
    requireFinite(rows, "matrix");
    if (const double defect = defectOf(rows); !(defect <= tolerance))
        throw UsageError(fmt::format(
            "matrix of a rotation: R R^T differs from the identity by {:.3g}; it has to be "
            "orthonormal to {:g}",
            defect, tolerance));
    const double determinant = rows[0] * (rows[4] * rows[8] - rows[5] * rows[7]) -
                               rows[1] * (rows[3] * rows[8] - rows[5] * rows[6]) +
                               rows[2] * (rows[3] * rows[7] - rows[4] * rows[6]);
    if (determinant < 0)
        throw UsageError(
            "matrix of a rotation: the determinant is -1, that of a mirror; it has "
            "to be 1");
    Rotation result;
    result.rows_ = orthonormal(rows);
    return result;
}

Rotation Rotation::euler(double alpha, double beta, double gamma) {
    requireFinite<3>({alpha, beta, gamma}, "Euler angles");
    const double ca = std::cos(alpha), sa = std::sin(alpha), cb = std::cos(beta),
                 sb = std::sin(beta), cg = std::cos(gamma), sg = std::sin(gamma);
    Rotation result;
    result.rows_ = {ca * cb * cg - sa * sg,
                    -ca * cb * sg - sa * cg,
                    ca * sb,
                    sa * cb * cg + ca * sg,
                    -sa * cb * sg + ca * cg,
                    sa * sb,
                    -sb * cg,
                    sb * sg,
                    cb};
    return result;
}

Rotation Rotation::aboutAxis(const Direction& axis, double angle) {
    requireFinite<1>({angle}, "angle");
    const Direction d = unit(axis, "axis");
    const double s = std::sin(angle / 2);
    return fromQuaternion(std::cos(angle / 2), s * d.x, s * d.y, s * d.z);
}

Rotation Rotation::fromQuaternion(double w, double x, double y, double z) {
    requireFinite<4>({w, x, y, z}, "quaternion");
    const double largest = std::max({std::abs(w), std::abs(x), std::abs(y), std::abs(z)});
    if (largest == 0)
        throw UsageError("quaternion of a rotation: 0,0,0,0 is none; give one of length 1");
    w /= largest, x /= largest, y /= largest, z /= largest;
    const double two = 2 / (w * w + x * x + y * y + z * z);
    Rotation result;
    result.rows_ = {
        1 - two * (y * y + z * z), two * (x * y - w * z),     two * (x * z + w * y),
        two * (x * y + w * z),     1 - two * (x * x + z * z), two * (y * z - w * x),
        two * (x * z - w * y),     two * (y * z + w * x),     1 - two * (x * x + y * y)};
    return result;
}

Rotation Rotation::zTo(const Direction& up) {
    const Direction d = unit(up, "direction");
    // The half vector of +z and d is the axis of half a turn that takes one to the other; the
    // shortest arc is that half turn after the one about +z, the quaternion (1 + z, -y, x, 0).
    const double w = d.z > 0 ? 1 + d.z : (d.x * d.x + d.y * d.y) / (1 - d.z);
    if (w == 0) return fromQuaternion(0, 0, 1, 0);
    return fromQuaternion(w, -d.y, d.x, 0);
}

Direction Rotation::operator()(const Direction& d) const {
    return {rows_[0] * d.x + rows_[1] * d.y + rows_[2] * d.z,
            rows_[3] * d.x + rows_[4] * d.y + rows_[5] * d.z,
            rows_[6] * d.x + rows_[7] * d.y + rows_[8] * d.z};
}

Rotation Rotation::inverse() const {
    Rotation result;
    result.rows_ = transposed(rows_);
    return result;
}

Rotation operator*(const Rotation& second, const Rotation& first) {
    Rotation result;
    result.rows_ = orthonormal(product(second.rows_, first.rows_));
    return result;
}

Rotation::Turns Rotation::turns() const {
    const Rows& r = rows_;
    const double across = std::hypot(r[2], r[5]);
    const double ca = across > 0 ? r[2] / across : 1, sa = across > 0 ? r[5] / across : 0;
    // Second row of R_z(-alpha) R = R_y(beta) R_z(gamma).
    double sg = ca * r[3] - sa * r[0], cg = ca * r[4] - sa * r[1];
    const double length = std::hypot(cg, sg);
    sg /= length, cg /= length;
    const double norm = std::hypot(across, r[8]), cb = r[8] / norm, sb = across / norm;
    return {ca, sa, cb, sb, cb > 0 ? sb * sb / (1 + cb) : 1 - cb, cg, sg};
}

bool isIdentity(const Rotation& rotation) {
    return rotation.matrix() == Rotation().matrix();
}

double angleOf(const Rotation& rotation) {
    const Rows& r = rotation.matrix();
    const double s = std::hypot(r[7] - r[5], r[2] - r[6], r[3] - r[1]);
    return std::atan2(s, r[0] + r[4] + r[8] - 1);
}

}  // namespace hshfit::inline rotation
