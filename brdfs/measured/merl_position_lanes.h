// Positions in a MERL table, as many at a time as a register holds. Included by merl_positions.cpp
// once for each instruction set.

#include <brdfs/measured/angle_lanes.h>
#include <brdfs/measured/merl_positions.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

// With u = wi + wo and v = wi - wo (so that h = u/|u|, and v is at right angles to it):
//     theta_h = atan2(|u_xy|, u_z),    theta_d = atan2(|v|, |u|),
//     phi_d = atan2((u x v)_z, -|u| v_z)      and (u x v)_z = 2 (wo x wi)_z.
HWY_INLINE void indicesOf(const Direction& wo, Lanes x, Lanes y, Lanes z, bool reciprocal,
                          MerlIndices& at, std::size_t k) {
    const Lanes zero = 0.0;
    const Lanes sx = x + wo.x, sy = y + wo.y, sz = z + wo.z;
    const Lanes dx = x - wo.x, dy = y - wo.y, dz = z - wo.z;
    const Lanes across = sx * sx + sy * sy;
    const Lanes u = sqrt(across + sz * sz), v = sqrt(dx * dx + dy * dy + dz * dz);
    store(sqrt(16200 / pi * quadrantAngle(sqrt(across), max(sz, zero))), at.h + k);
    store(180 / pi * quadrantAngle(v, u), at.d + k);
    // Both are 0 but for rounding where h is the normal or wi = wo: any phi_d is right there, but
    // it has to be the same one when the pair turns about the normal.
    const auto defined = across > Lanes(1e-28);
    const Lanes sine = select(defined, 2.0 * (wo.x * y - x * wo.y), zero);
    const Lanes cosine = select(defined, -dz * u, zero);
    if (reciprocal) {
        store(180 / pi * lineAngle(sine, cosine), at.p + k);
    } else {
        const Lanes angle = 180 / pi * rayAngle(sine, cosine);
        store(select(angle < zero, angle + 360.0, angle), at.p + k);
    }
}

void merlIndices(const Direction& wo, const DirectionBatch& wi, bool reciprocal, MerlIndices& at) {
    const std::size_t lanes = lanesIn<Lanes>();
    Lanes x, y, z;
    std::size_t k = 0;
    for (; k + lanes <= wi.count; k += lanes) {
        load(wi.x + k, x), load(wi.y + k, y), load(wi.z + k, z);
        indicesOf(wo, x, y, z, reciprocal, at, k);
    }
    if (k == wi.count) return;
    constexpr std::size_t most = HWY_MAX_BYTES / sizeof(double);
    double rest[3][most] = {};
    const double* const axes[] = {wi.x, wi.y, wi.z};
    for (int i = 0; i < 3; ++i) std::copy_n(axes[i] + k, wi.count - k, rest[i]);
    load(rest[0], x), load(rest[1], y), load(rest[2], z);
    indicesOf(wo, x, y, z, reciprocal, at, k);
}

HWY_INLINE void storeIndex(Lanes value, std::uint32_t* to) {
    const hn::Rebind<std::int32_t, Lanes::Tag> integers;
    hn::StoreU(
        hn::BitCast(hn::RebindToUnsigned<decltype(integers)>(), hn::DemoteTo(integers, value.v)),
        hn::RebindToUnsigned<decltype(integers)>(), to);
}

void merlCorners(const MerlIndices& at, std::size_t count, double azimuths, MerlCorners& corners) {
    constexpr double last = 89;
    const double hStep = azimuths * static_cast<double>(MerlLayout::differenceCount);
    const Lanes zero = 0.0;
    for (std::size_t k = 0; k < count; k += lanesIn<Lanes>()) {
        Lanes h, d, p;
        load(at.h + k, h), load(at.d + k, d), load(at.p + k, p);
        // Beyond node 89 both ends are that node; a whole turn is node 0 again.
        const Lanes h0 = min(truncated(h), last), d0 = min(truncated(d), last), p0 = truncated(p);
        const Lanes low = h0 * hStep + d0 * azimuths;
        const Lanes dStep = select(d0 < Lanes(last), azimuths, zero);
        const Lanes high = low + select(h0 < Lanes(last), hStep, zero);
        store(h - h0, corners.th + k);
        store(d - d0, corners.td + k);
        store(p - p0, corners.tp + k);
        storeIndex(low, corners.row[0] + k);
        storeIndex(low + dStep, corners.row[1] + k);
        storeIndex(high, corners.row[2] + k);
        storeIndex(high + dStep, corners.row[3] + k);
        storeIndex(select(p0 < Lanes(azimuths), p0, zero), corners.p0 + k);
        const Lanes next = p0 + 1.0;
        storeIndex(select(next < Lanes(azimuths), next, next - azimuths), corners.p1 + k);
    }
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
