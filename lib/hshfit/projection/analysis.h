#pragma once

#include <hshfit/bases/basis.h>
#include <hshfit/quadrature/azimuth_tables.h>

#include <cstddef>
#include <vector>

namespace hshfit::inline projection {

/// Rings of constant elevation, all with the same equispaced azimuths phi_j = (j + 1/2) 2 pi /
/// azimuths.
struct AnalysisGrid {
    std::vector<Elevation<double>> elevations;
    std::vector<double> weights;  ///< d mu per ring
    std::size_t azimuths = 0;     ///< a multiple of 4

    std::size_t points() const { return elevations.size() * azimuths; }

    /// Gauss-Legendre in cos(theta), over the hemisphere or the sphere: exact for products of two
    /// polynomials in cos(theta) of `rings` - 1 degrees, and of two harmonics of azimuths / 2 - 1.
    /// Throws UsageError for azimuths that are no multiple of 4, and without rings.
    static AnalysisGrid gauss(std::size_t rings, std::size_t azimuths, bool sphere = false);
};

/// Coefficients of many functions that are given on one grid:
///     c_{l,m} = sum over rings and azimuths of weight (2 pi / azimuths) f B_{l,m}
/// in the inner product of the basis: exact where the grid is (for HSH and SH of order n, n rings
/// and 2 n azimuths). Separable: folded azimuth sums, then theta sums, as matrix products over
/// blocks of functions that fit into the caches; where theta functions are even or odd about the
/// middle ring (HSH on the hemisphere, SH on the sphere), half of the theta sums. Moments of a
/// basis that is not orthonormal (LSOSH) become coefficients by `Basis::coefficientsFromMoments`,
/// which is left to the caller. Immutable; safe to use from many threads.
class Analysis {
public:
    Analysis(const Basis& basis, AnalysisGrid grid);

    const AnalysisGrid& grid() const { return grid_; }
    /// Whether the theta functions are even or odd about the middle ring.
    bool folded() const { return folded_; }

    /// samples [function][ring][azimuth] to out [function][slot].
    void run(const double* samples, std::size_t functions, double* out) const;

private:
    struct Workspace;
    void block(const double* samples, std::size_t functions, double* out, Workspace& w) const;
    /// Azimuth sums over ring r and, if folded, its mirror image, to w.spectrum.
    void ringSums(const double* samples, std::size_t functions, std::size_t r, Workspace& w) const;
    /// Moments of one m to `out`, [l by parity][function]; returns the end of what it wrote.
    double* thetaSums(int m, const Workspace& w, double* out) const;
    bool findParity(const std::vector<double>& whole) const;

    int order_;
    std::size_t slots_;
    AnalysisGrid grid_;
    bool folded_ = false;
    std::size_t half_ = 0;  ///< rings that are left after folding
    AzimuthColumns columns_;
    std::vector<double> azimuths_;    ///< [column][azimuth of the quadrant]
    std::vector<double> theta_;       ///< for each m, for each parity of l - m: [l][ring], weighted
    std::vector<std::size_t> first_;  ///< in theta_, [2 m + parity]
    std::vector<std::size_t> slotOfRow_;
};

}  // namespace hshfit::inline projection
