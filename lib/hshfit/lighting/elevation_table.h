#pragma once

#include <hshfit/brdf/brdf.h>

#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace hshfit::lighting {

/// The elevations of a table's rows: row k of n is at
///     cos(theta_o) = (1 - span (k / (n - 1))^2)^2,   span = 1 - sqrt(leastCosine),
/// from the normal to 89.4 degrees: nearly even in angle, and four times as dense at the horizon,
/// where albedos of measured materials rise steeply.
struct ElevationRows {
    static constexpr double leastCosine = 0.01;
    static double span() { return 1 - std::sqrt(leastCosine); }
    std::size_t count = 32;  ///< at least 2

    double cosine(std::size_t row) const;
    /// A row and the share of the one after it; elevations below the last row are the last row's.
    struct Place {
        std::size_t row = 0;
        double share = 0;
    };
    Place place(double cosine) const;
};

/// The azimuths of wo, about the tangent, that a table has. An isotropic BRDF needs one. A
/// mirror-symmetric one needs a quarter turn with both its ends, because wo in another quarter sees
/// the mirror image of a lobe; any other needs the whole circle, of which the first node follows
/// the last.
struct AzimuthNodes {
    static constexpr std::size_t defaultSteps =
        8;  ///< docs/explanation/lighting.md has the errors of others
    std::size_t count = 1;
    bool folded = false;

    AzimuthNodes() = default;
    /// The azimuths that the laws ask for, with `steps` between nodes in a quarter turn (at least
    /// 1).
    AzimuthNodes(const Laws& laws, std::size_t steps);

    double angle(std::size_t node) const;
    /// Two nodes, the share of the second, and whether the lobe has to be mirrored at the plane of
    /// incidence.
    struct Place {
        std::size_t first = 0, second = 0;
        double share = 0;
        bool mirrored = false;
    };
    Place place(double azimuth) const;
};

/// Numbers by elevation, and by azimuth where there are several, as shaders read them: texels of
/// four, interpolated linearly between rows and between azimuths.
struct ElevationTable {
    ElevationRows rows = {};
    AzimuthNodes azimuths = {};
    std::size_t texels = 0;      ///< of a row
    std::vector<double> values;  ///< [azimuth][row][texel][4]

    ElevationTable() = default;
    ElevationTable(ElevationRows rows, std::size_t texels, AzimuthNodes azimuths = {});

    std::size_t height() const { return azimuths.count * rows.count; }
    std::size_t bytes() const { return values.size() * sizeof(float); }  ///< as float32
    std::span<double> row(std::size_t k, std::size_t azimuth = 0);
    std::span<const double> row(std::size_t k, std::size_t azimuth = 0) const;
    /// The interpolated row of a view: 4 texels numbers to `out`. Returns whether the lobe has to
    /// be mirrored at the plane of incidence.
    bool at(double cosine, double azimuth, std::span<double> out) const;
};

}  // namespace hshfit::lighting
