#pragma once

#include <hshfit/quadrature/azimuth_spread.h>

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace hshfit::inline quadrature {

/// Columns come in whole groups of this many; columns that are missing are filled with zeros.
constexpr std::size_t laneGroup = 4;

/// The number of columns of each kind of azimuth function, rounded up to whole groups of `group`.
struct AzimuthColumns {
    std::size_t c0, c1, s1, s0;
    explicit AzimuthColumns(int order, std::size_t group = laneGroup)
        : c0(whole((order + 1) / 2, group)),
          c1(whole(order / 2, group)),
          s1(c1),
          s0(whole((order - 1) / 2, group)) {}
    std::size_t all() const { return c0 + c1 + s1 + s0; }
    /// The column of az_m, |m| < order.
    std::size_t of(int m) const {
        const std::size_t k = static_cast<std::size_t>(m < 0 ? -m : m) / 2;
        if (m >= 0) return m % 2 == 0 ? k : c0 + k;
        return m % 2 != 0 ? c0 + c1 + k : c0 + c1 + s1 + k - 1;
    }

private:
    static std::size_t whole(int count, std::size_t group) {
        return (static_cast<std::size_t>(count) + group - 1) / group * group;
    }
};

/// The azimuth functions at some of a ring's azimuths, relative to its centre: equispaced ones on a
/// part of a quadrant, clustered ones on a part of the half circle above 0. The rest of the ring
/// follows by symmetry (ring_kernels.h).
struct AzimuthTable {
    std::size_t count = 0;
    std::vector<double> cosine, sine;  ///< of phi_j
    std::vector<double> weights;       ///< d phi / dt where clustered
    /// [count][column], az_m without the Condon-Shortley sign, times the weight, columns as in
    /// AzimuthColumns: cos(m phi) for m = 0, 2, …, for m = 1, 3, …, then sin(m phi) for m = 1, 3,
    /// …, for m = 2, 4, …; 0 in columns that only fill a group.
    std::vector<double> rows;

    /// Azimuths number first to first + howMany - 1.
    void fill(int order, const AzimuthSpacing& spacing, std::size_t first, std::size_t howMany);
    /// Azimuths at nodes t with the weights of their own, before the weights of the spacing's map.
    void fill(int order, const AzimuthSpacing& spacing, std::span<const double> t,
              std::span<const double> ofNodes);

private:
    void fillRows(int order);
};

/// Number of azimuths in a table: of a quadrant or, if clustered, of half of the circle.
inline std::size_t tableSize(const AzimuthSpacing& spacing) {
    return spacing.azimuths / (spacing.squeeze > 0 ? 2 : 4);
}

/// A cache of whole tables for all outgoing directions of a projection. Safe to use from many
/// threads.
class AzimuthTables {
public:
    explicit AzimuthTables(int order);
    ~AzimuthTables();

    int order() const { return order_; }
    /// None for a table beyond 2 MB (4096 azimuths), which the caller fills piece by piece. The
    /// cache holds at most 64 MB; further tables belong to the caller. Results are bitwise
    /// identical whether or not a table was cached. A table lives as long as both the pointer and
    /// this object.
    std::shared_ptr<const AzimuthTable> find(const AzimuthSpacing& spacing) const;

private:
    struct Kept;
    int order_;
    std::unique_ptr<Kept> kept_;
};

}  // namespace hshfit::inline quadrature
