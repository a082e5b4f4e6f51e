#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/coefficients/light_coefficients.h>
#include <hshfit/light/light_samples.h>
#include <hshfit/lighting/elevation_table.h>
#include <hshfit/rotation/sh_rotation.h>

#include <memory>

namespace hshfit::lighting {

/// A BRDF as spherical harmonics by elevation and, with a tangent, azimuth of wo:
///     F_{l,m}(wo) = integral over the hemisphere of f cos(theta_i) Y_{l,m}(wi)
/// in the frame turned about the normal in which wo is at azimuth 0. Light of `order` bands is then
/// reflected exactly, but for the interpolation: the radiance is the sum of F_{l,m} L_{l,m} over
/// the coefficients of light in the frame of n and wo. Texels have R, G, B. Where lobes are their
/// own mirror image (`inPlane`: F is 0 for m < 0), F_{l,m} is texel l (l + 1) / 2 + m, for m >= 0;
/// otherwise texel l (l + 1) + m.
struct HarmonicTable {
    int order = 0;
    bool inPlane = true;
    ElevationTable table = {};
};

/// The texel of (l, m >= 0).
constexpr std::size_t harmonicTexel(int l, int m) {
    return static_cast<std::size_t>(l * (l + 1) / 2 + m);
}

/// Throws UsageError for an order that is not 1 to 16; NumericError where f is not finite.
HarmonicTable fitHarmonics(const Brdf& brdf, int order, ElevationRows rows = {},
                           std::size_t azimuthSteps = AzimuthNodes::defaultSteps);

/// Radiance under light by SH coefficients in the world. Immutable.
class HarmonicShading {
public:
    /// `light`: RGB on the sphere, at least of the table's order, without the Condon-Shortley sign.
    HarmonicShading(HarmonicTable table, const LightCoefficients& light);
    /// `tangent`: unit vector across the normal; of no account for an isotropic BRDF.
    Rgb radiance(const Direction& normal, const Direction& viewer,
                 const Direction& tangent = {0, 0, 0}) const;

    const HarmonicTable& table() const { return table_; }
    const std::vector<Rgb>& light() const { return light_; }  ///< [slot]

private:
    HarmonicTable table_;
    std::vector<Rgb> light_;
    std::vector<double> planes_;  ///< [channel][slot]
    std::shared_ptr<const ShRotation> rotation_;
};

/// The axes in which a table is read: +z the normal, +x the viewer's part across it (`tangent`, or
/// any where that is 0, where the viewer's part vanishes).
struct ViewAxes {
    ViewAxes(const Direction& normal, const Direction& viewer,
             const Direction& tangent = {0, 0, 0});
    /// +y the other way, for a table whose lobe has to be mirrored.
    void mirror();
    Direction toLocal(const Direction& world) const;
    Direction toWorld(const Direction& local) const;

    Direction x, y, z;
    double cosine = 1;   ///< of the viewer
    double azimuth = 0;  ///< of +x about the tangent; 0 where that is 0
};

}  // namespace hshfit::lighting
