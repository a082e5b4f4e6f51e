#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/coefficients/light_coefficients.h>
#include <hshfit/light/light_samples.h>
#include <hshfit/lighting/elevation_table.h>
#include <hshfit/rotation/sh_rotation.h>

#include <memory>

namespace hshfit::lighting {

/// An isotropic, mirror-symmetric BRDF as spherical harmonics by elevation:
///     F_{l,m}(theta_o) = integral over the hemisphere of f cos(theta_i) Y_{l,m}(wi),  m >= 0,
/// with wo at azimuth 0. Light of `order` bands is then reflected exactly, but for the
/// interpolation between rows: the radiance is the sum of F_{l,m} L_{l,m} over the coefficients of
/// light in the frame of n and wo. Texel l (l + 1) / 2 + m has R, G, B.
struct HarmonicTable {
    int order = 0;
    ElevationTable table = {};

    std::size_t bytes() const { return table.values.size() * sizeof(float); }
};

/// The texel of (l, m >= 0).
constexpr std::size_t harmonicTexel(int l, int m) {
    return static_cast<std::size_t>(l * (l + 1) / 2 + m);
}

/// Throws UsageError for a BRDF that is not isotropic and mirror-symmetric or an order that is not
/// 1 to 16; NumericError where f is not finite.
HarmonicTable fitHarmonics(const Brdf& brdf, int order, ElevationRows rows = {});

/// Radiance under light by SH coefficients in the world. Immutable.
class HarmonicShading {
public:
    /// `light`: RGB on the sphere, at least of the table's order, without the Condon-Shortley sign.
    HarmonicShading(HarmonicTable table, const LightCoefficients& light);
    Rgb radiance(const Direction& normal, const Direction& viewer) const;

    const HarmonicTable& table() const { return table_; }
    const std::vector<Rgb>& light() const { return light_; }  ///< [slot]

private:
    HarmonicTable table_;
    std::vector<Rgb> light_;
    std::vector<double> planes_;  ///< [channel][slot]
    std::shared_ptr<const ShRotation> rotation_;
};

/// The axes in which a table is read: +z the normal, +x the viewer's part across it (any tangent
/// where that vanishes).
struct ViewAxes {
    ViewAxes(const Direction& normal, const Direction& viewer);
    Direction toLocal(const Direction& world) const;
    Direction toWorld(const Direction& local) const;

    Direction x, y, z;
    double cosine = 1;  ///< of the viewer
};

/// Throws UsageError, naming `what`, unless the BRDF's laws say isotropic and mirror-symmetric.
void requireIsotropic(const Brdf& brdf);

}  // namespace hshfit::lighting
