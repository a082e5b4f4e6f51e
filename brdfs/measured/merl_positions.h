#pragma once

#include <brdfs/measured/merl_layout.h>
#include <hshfit/brdf/directions.h>

#include <cstddef>
#include <cstdint>

namespace hshfit::brdfs {

/// Fractional indices (h, d, p) of a block of direction pairs in a MERL table (merl_layout.h),
/// within 1e-9. At most `size` directions; arrays are written in whole registers, so that entries
/// beyond `count` are undefined.
struct MerlIndices {
    static constexpr std::size_t size = 64;

    double h[size], d[size], p[size];

    void set(const Direction& wo, DirectionBatch wi, const MerlLayout& layout);
    /// To the nearest nodes.
    void round(std::size_t count, std::size_t azimuths);
};

/// The eight cells around each of a block of positions: four rows in phi_d (h and d, each at both
/// ends), two cells of each row, and the fractions between them.
struct MerlCorners {
    std::uint32_t row[4][MerlIndices::size];
    std::uint32_t p0[MerlIndices::size], p1[MerlIndices::size];
    double th[MerlIndices::size], td[MerlIndices::size], tp[MerlIndices::size];

    void set(const MerlIndices& at, std::size_t count, const MerlLayout& layout);

    /// Interpolates f at `count` positions in registers of two rows, to out[channel * stride +
    /// k], with 0 where z[k] <= 0. `cells` points to the first cell of the file. Returns one
    /// bit for each position left to the scalar path: those with an invalid cell or at the wrap
    /// of the azimuth, or all of them on machines without such registers.
    std::uint64_t blend(const unsigned char* cells, const MerlLayout& layout, const double* z,
                        std::size_t count, double* out, std::size_t stride) const;
};

}  // namespace hshfit::brdfs
