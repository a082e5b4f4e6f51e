// Positions in a MERL table, as many at a time as a register holds. Included by merl_positions.cpp
// once for each instruction set.

#include <brdfs/lanes/lanes_batch.h>
#include <brdfs/measured/angle_lanes.h>
#include <brdfs/measured/merl_positions.h>

#include <hwy/cache_control.h>

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
    // Both arguments are 0 but for rounding where h is the normal or wi = wo. phi_d is
    // arbitrary there, but must not change when the pair turns about the normal.
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
    forEachLanes(wi, [&](Lanes x, Lanes y, Lanes z, std::size_t k)
                         HWY_ATTR { indicesOf(wo, x, y, z, reciprocal, at, k); });
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

#if HWY_MAX_BYTES >= 32
using FourCells = hn::FixedTag<double, 4>;

/// Two cells of each of two rows.
HWY_INLINE hn::Vec<FourCells> fourCells(const unsigned char* low, const unsigned char* high) {
    const hn::FixedTag<double, 2> two;
    return hn::Combine(FourCells(), hn::LoadU(two, reinterpret_cast<const double*>(high)),
                       hn::LoadU(two, reinterpret_cast<const double*>(low)));
}

HWY_INLINE hn::Vec<FourCells> twice(double low, double high) {
    const hn::FixedTag<double, 2> two;
    return hn::Combine(FourCells(), hn::Set(two, high), hn::Set(two, low));
}

/// One position; false where a cell is not a value.
HWY_INLINE bool blend(const unsigned char* cells, std::size_t plane, const MerlCorners& at,
                      std::size_t k, double* out, std::size_t stride) {
    const double th = at.th[k], td = at.td[k], tp = at.tp[k];
    const auto low = twice((1 - th) * (1 - td), (1 - th) * td),
               high = twice(th * (1 - td), th * td);
    const unsigned char* rows[4];
    for (int i = 0; i < 4; ++i) rows[i] = cells + (at.row[i][k] + at.p0[k]) * sizeof(double);
    auto least = hn::Zero(FourCells());
    bool valid = true;
    for (std::size_t c = 0; c < 3; ++c) {
        const auto below = fourCells(rows[0], rows[1]), above = fourCells(rows[2], rows[3]);
        least = hn::Min(least, hn::Min(below, above));
        const auto four = hn::MulAdd(high, above, hn::Mul(low, below));
        const hn::FixedTag<double, 2> two;
        HWY_ALIGN double pair[2];
        hn::Store(hn::Add(hn::LowerHalf(two, four), hn::UpperHalf(two, four)), two, pair);
        const double sum = pair[0] + tp * (pair[1] - pair[0]);
        valid = valid && sum >= 0 && sum <= std::numeric_limits<double>::max();
        out[c * stride] = sum * merlScale[c];
        for (const unsigned char*& row : rows) row += plane;
    }
    return valid && hn::AllFalse(FourCells(), hn::Lt(least, hn::Zero(FourCells())));
}
#endif

HWY_INLINE void prefetch(const unsigned char* cells, std::size_t plane, const MerlCorners& at,
                         std::size_t k) {
    for (std::size_t c = 0; c < 3; ++c)
        for (const auto& row : at.row)
            hwy::Prefetch(cells + c * plane + (row[k] + at.p0[k]) * sizeof(double));
}

std::uint64_t merlBlend(const unsigned char* cells, std::size_t plane, const MerlCorners& at,
                        const double* z, std::size_t count, double* out, std::size_t stride) {
#if HWY_MAX_BYTES >= 32
    // The number of evaluations between prefetching cells and using them. 4 to 8 are equally fast
    // (measured_eval in bench/); without prefetching an evaluation takes half as long again.
    constexpr std::size_t distance = 6;
    std::uint64_t open = 0;
    for (std::size_t k = 0; k < count; ++k) {
        if (k + distance < count) prefetch(cells, plane, at, k + distance);
        if (!(z[k] > 0))
            for (std::size_t c = 0; c < 3; ++c) out[c * stride + k] = 0;
        else if (at.p1[k] == 0 || !blend(cells, plane, at, k, out + k, stride))
            open |= std::uint64_t{1} << k;
    }
    return open;
#else
    (void)z, (void)out, (void)stride;
    for (std::size_t k = 0; k < count; ++k) prefetch(cells, plane, at, k);
    return ~std::uint64_t{0};
#endif
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
