#pragma once

#include <hshfit/bases/basis.h>

#include <cstddef>
#include <vector>

namespace hshfit::inline transfer {

/// Rings of constant elevation with equispaced azimuths phi_j = j 2 pi / azimuths.
struct RingGrid {
    std::vector<Elevation<double>> elevations;
    std::vector<double> weights;  ///< d mu, times mu where that is the inner product
    std::size_t azimuths = 0;

    std::size_t points() const { return elevations.size() * azimuths; }
    double weight(std::size_t ring) const {
        return weights[ring] * 2 * pi / static_cast<double>(azimuths);
    }
    /// Exact in the inner product of `basis`, over its domain (the sphere for SH), for products of
    /// basis functions whose degrees in cos(theta) sum to `degree` and whose m to `harmonics`, if
    /// the sum of their m is even. Gauss-Legendre in cos(theta) on the sphere, in sqrt(cos(theta))
    /// on the hemisphere, where root factors of the makhotkin functions are polynomials too.
    static RingGrid exactFor(const Basis& basis, int degree, int harmonics);
};

/// Throws UsageError for a basis that is not orthonormal: sums of its functions have no single
/// inner product.
void requireOrthonormal(const Basis& basis);

/// Sums over a basis on a grid and integrals against it, ring by ring: O(order^3) for a grid that
/// resolves the order.
class RingTransform {
public:
    RingTransform(const Basis& basis, const RingGrid& grid);

    /// values[ring * azimuths + j] = sum over slots of c B.
    void synthesise(const double* c, double* values) const;
    /// out[ring * (2 order - 1) + order - 1 + m] = sum over l of c_{l,m} T_l^m, the parts of each
    /// m.
    void ringParts(const double* c, double* out) const;
    /// moments[slot] = integral of the values against B.
    void analyse(const double* values, double* moments) const;

    /// Theta parts of m: [l - m][ring].
    const std::vector<double>& theta(int m) const { return theta_[static_cast<std::size_t>(m)]; }

private:
    int order_;
    const RingGrid& grid_;
    std::size_t width_;                       ///< 2 order - 1
    std::vector<std::vector<double>> theta_;  ///< with the Condon-Shortley sign if there is one
    std::vector<double> azimuths_;            ///< [azimuth][order - 1 + m]
};

/// The integral of az_{m1} az_{m2} az_{m3} over phi: 0 unless one |m| is the sum of the others and
/// an even number of the m is negative.
double azimuthProduct(int m1, int m2, int m3);

}  // namespace hshfit::inline transfer
