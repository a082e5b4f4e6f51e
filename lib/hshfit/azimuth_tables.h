#pragma once

#include <cstddef>
#include <memory>
#include <vector>

namespace hshfit {

/// The azimuth functions on a part of a quadrant: phi_j = (j + 1/2) 2 pi / azimuths for `count` of
/// j = 0 .. azimuths/4 - 1. The other quadrants follow by symmetry (ring_kernels.h).
struct AzimuthTable {
    std::size_t count = 0;
    std::vector<double> cosine, sine;  ///< of phi_j
    /// [column][count], az_m without the Condon-Shortley sign: cos(m phi) for m = 0, 2, …, for m =
    /// 1, 3, …, then sin(m phi) for m = 1, 3, …, for m = 2, 4, ….
    std::vector<double> rows;

    void fill(int order, std::size_t azimuths, std::size_t first, std::size_t howMany);
};

/// How many columns of an AzimuthTable each kind takes.
struct AzimuthColumns {
    std::size_t c0, c1, s1, s0;
    explicit AzimuthColumns(int order)
        : c0((order + 1) / 2), c1(order / 2), s1(order / 2), s0((order - 1) / 2) {}
    std::size_t all() const { return c0 + c1 + s1 + s0; }
    /// The column of az_m, |m| < order.
    std::size_t of(int m) const {
        const std::size_t k = static_cast<std::size_t>(m < 0 ? -m : m) / 2;
        if (m >= 0) return m % 2 == 0 ? k : c0 + k;
        return m % 2 != 0 ? c0 + c1 + k : c0 + c1 + s1 + k - 1;
    }
};

/// Tables of whole quadrants, kept for all outgoing directions of a projection. Safe to use from
/// many threads.
class AzimuthTables {
public:
    explicit AzimuthTables(int order);
    ~AzimuthTables();

    int order() const { return order_; }
    /// The whole quadrant of a ring; none where it would take too much room (2 MB, 4096 azimuths):
    /// whoever needs it fills it piece by piece. `azimuths` is a multiple of 4.
    const AzimuthTable* find(std::size_t azimuths) const;

private:
    struct Kept;
    int order_;
    std::unique_ptr<Kept> kept_;
};

}  // namespace hshfit
