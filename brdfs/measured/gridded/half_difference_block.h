#pragma once

#include <brdfs/measured/angles.h>
#include <hshfit/brdf/directions.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace hshfit::brdfs {

/// Half and difference angles (Rusinkiewicz 1998) of a block of pairs, in degrees, phi_d in
/// [0, 360): with u = wi + wo and v = wi - wo,
///     theta_h = atan2(|u_xy|, u_z),    theta_d = atan2(|v|, |u|),
///     phi_d = atan2((u x v)_z, -|u| v_z),    (u x v)_z = 2 (wo x wi)_z.
/// If phi_d is undefined (h is the normal, or wi = wo), it is set to 90, so that it does not
/// change when the pair turns about the normal.
struct HalfDifferenceBlock {
    static constexpr std::size_t size = 64;
    double thetaHalf[size], thetaDifference[size], phiDifference[size];

    // One short loop per angle, over arrays that cannot overlap: the compiler vectorises these.
    void set(const Direction& wo, const DirectionBatch& wi, std::size_t begin, std::size_t count) {
        double x[size], y[size], z[size];
        std::copy_n(wi.x + begin, count, x);
        std::copy_n(wi.y + begin, count, y);
        std::copy_n(wi.z + begin, count, z);
        double ux[size], uz[size], u[size], v[size], sine[size], cosine[size];
        for (std::size_t k = 0; k < count; ++k) {
            const double sx = x[k] + wo.x, sy = y[k] + wo.y, sz = z[k] + wo.z;
            const double dx = x[k] - wo.x, dy = y[k] - wo.y, dz = z[k] - wo.z;
            const double across2 = sx * sx + sy * sy;
            ux[k] = std::sqrt(across2);
            uz[k] = std::max(sz, 0.0);
            u[k] = std::sqrt(across2 + sz * sz);
            v[k] = std::sqrt(dx * dx + dy * dy + dz * dz);
            // across2 is 0 but for rounding where h is the normal.
            const bool defined = across2 > 1e-28;
            sine[k] = defined ? 2 * (wo.x * y[k] - x[k] * wo.y) : 1.0;
            cosine[k] = defined ? -dz * u[k] : 0.0;
        }
        for (std::size_t k = 0; k < count; ++k) {
            thetaHalf[k] = 180 / pi * quadrantAngle(ux[k], uz[k]);
        }
        for (std::size_t k = 0; k < count; ++k) {
            thetaDifference[k] = 180 / pi * quadrantAngle(v[k], u[k]);
        }
        for (std::size_t k = 0; k < count; ++k) {
            const double angle = 180 / pi * rayAngle(sine[k], cosine[k]);
            const double turned = angle < 0 ? angle + 360 : angle;
            phiDifference[k] = turned < 360 ? turned : 0;
        }
    }
};

}  // namespace hshfit::brdfs
