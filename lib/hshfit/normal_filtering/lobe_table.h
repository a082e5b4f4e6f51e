#pragma once

#include <hshfit/brdf/directions.h>

#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace hshfit::inline normal_filtering {

/// The distribution of the microfacets' normals about a surface normal, in the frame of that
/// normal: the factor D of f = D(h) M(wi, wo).
struct NormalDistribution {
    /// D(h) in 1/sr for unit vectors with h.z >= 0, finite. Any scale; 1 = integral of D cos.
    std::function<double(const Direction& h)> density;
    /// Slopes along x and y within which D falls to a small part of its peak: alpha of GGX or
    /// Beckmann. A D of equal widths has to depend on h.z alone.
    double widthX = 0.1, widthY = 0.1;
};

/// D as a sum of Gaussians about the normal, in q = (h.x, h.y) sqrt(2 / (1 + h.z)), whose length is
/// the chord 2 sin(theta_h / 2):
///     D(h) widthX widthY = sum of peaks[j] exp(-((q_x / widthX)^2 + (q_y / widthY)^2) /
///                                              (2 variances[j])).
struct GaussianSum {
    std::vector<double> peaks, variances;
    /// L2 distance from D over the hemisphere, relative to the norm of D.
    double error = 0;
};

/// Place in a LobeTable: row and column, fractions allowed; beyond its ends the nearest.
using LobePlace = std::array<double, 2>;

struct LobeTableOptions {
    int order = 33;  ///< bands 0, 2, …, order - 1 are kept; odd
};

/// Distributions over up to two parameters (roughness; anisotropy), as coefficients of spherical
/// harmonics and as sums of Gaussians. D counts as even, D(-h) = D(h), which leaves bands of even l
/// alone and no jump at the horizon. Between entries coefficients and widths are linear; error(…)
/// measures that. Immutable; safe to use from many threads.
class LobeTable {
public:
    using Make = std::function<NormalDistribution(std::size_t row, std::size_t column)>;
    /// Throws UsageError for an empty table or an order that is even or outside of [3, 301], and
    /// InputError for a density that is negative, not finite, or 0 everywhere.
    LobeTable(std::size_t rows, std::size_t columns, const Make& make,
              const LobeTableOptions& options = {});

    std::size_t rows() const { return rows_; }
    std::size_t columns() const { return columns_; }
    int order() const { return order_; }
    /// Whether all widths are equal in pairs, so that only coefficients of m = 0 exist.
    bool isotropic() const { return isotropic_; }

    /// Coefficients d_l of Y_(l,0), l = 0, 2, …, order - 1. Isotropic tables only.
    void zonal(const LobePlace& place, std::span<double> out) const;
    /// Coefficients in slots l(l+1) + m, order^2 of them, 0 for odd l.
    void coefficients(const LobePlace& place, std::span<double> out) const;
    std::array<double, 2> widths(const LobePlace& place) const;
    /// The sum of the nearest entry; the widths scale it to others.
    const GaussianSum& gaussians(const LobePlace& place) const;

    /// L2 over the sphere of bands `order` and up to order() - 1 of an entry, relative to the norm
    /// of all that are kept: an entry's own truncation error, which filtering can only make smaller
    /// in absolute terms.
    double truncation(const LobePlace& place, int order) const;

private:
    struct Entry {
        std::array<double, 2> widths;
        std::vector<double> coefficients;  ///< zonal, or slots
        GaussianSum gaussians;
    };
    struct Corner {
        const Entry* entry;
        double share;
    };
    std::array<Corner, 4> corners(const LobePlace& place) const;

    std::size_t rows_, columns_;
    int order_;
    bool isotropic_ = true;
    std::vector<Entry> entries_;
};

}  // namespace hshfit::inline normal_filtering
