#pragma once

#include <hshfit/brdf/directions.h>
#include <hshfit/representation/content.h>

namespace hshfit::inline representation::inline halfway {

/// The place of a pair on the axes of the halfway form. With the unit vector h halfway between wi
/// and wo, m = cos(theta), and e = m^(1/3), which resolves the horizon:
///     mean    = (e_i + e_o) / 2
///     product = e_i e_o
///     gap     = e_o - e_i, changes sign when wi and wo are exchanged
///     v       = cos(theta_d) = h . wo
///     x       = ln(1 + Q) / ln(1 + max Q): the logarithm of a GGX lobe is a straight line over x,
///               so that the lobe is resolved whatever its width
///     kappa   = (m_o - m_i) / (2 sin(theta_h)) = sin(theta_d) cos(phi_d), likewise odd
///     handed  = z of wi x wo, changes sign then, and when both are mirrored at a plane
///     cosine, sine: of the azimuth of (g_x, g_y)
///     weight  = the lobe L of a unit amplitude
/// Here g is h in the frame of the lobe with g_x = h_x sqrt(1 / a^2 - 1), g_y = h_y sqrt(1 / b^2 -
/// 1) for roughnesses a and b, Q = g_x^2 + g_y^2, and
///     L = 1 / (2 pi a b (1 + Q)^2 (d + s)),
/// GGX's distribution (Walter et al. 2007) over a denominator that s, the lobe's shelf, keeps away
/// from 0 at the horizon. In it
///     d = m_i m_o + (m_i + m_o) / 2, or for a masked lobe d = m_o l_i + m_i l_o,
///     l = sqrt(m^2 + (a w_x)^2 + (b w_y)^2), w_x and w_y in the frame of the lobe,
/// Smith's masking of both directions by facets of correlated heights (Heitz 2014, eq. 99): L is
/// then GGX's BRDF without Fresnel's reflectance, but for s. No angle is formed.
struct HalfwayPoint {
    double mean, product, gap, v, x, kappa, handed, cosine, sine, weight;

    void place(double ei, double eo, double onLobe) {
        mean = (ei + eo) / 2;
        product = ei * eo;
        gap = eo - ei;
        x = onLobe;
    }
};

/// The axes for one lobe.
class HalfwayAxes {
public:
    /// Roughnesses from 1e-5 to 0.9, a shelf of at least 1e-4.
    explicit HalfwayAxes(const HalfwayLobe& lobe);

    /// The numbers of the lobe in the formula above: g_x = xx h_x + xy h_y, g_y = yx h_x + yy h_y;
    /// 1 / ln(1 + max Q); 1 / (2 pi a b); s. l^2 = m^2 + lxx w_x^2 + lxy w_x w_y + lyy w_y^2 for
    /// w_x and w_y in the frame of the surface.
    struct Constants {
        double xx, xy, yx, yy, perLog, amplitude, shelf;
        bool masked;
        double lxx, lxy, lyy;
    };
    const Constants& constants() const { return constants_; }

    /// wi and wo above the horizon.
    HalfwayPoint at(const Direction& wi, const Direction& wo) const {
        return at(constants_, wi, wo);
    }
    static HalfwayPoint at(const Constants& constants, const Direction& wi, const Direction& wo);
    /// The same without the cube roots and the logarithm, which vector code has side by side:
    /// HalfwayPoint::place sets what depends on them. `tail` is 1 + Q.
    static HalfwayPoint unplaced(const Constants& constants, const Direction& wi,
                                 const Direction& wo, double& tail);

private:
    Constants constants_;
};

/// The widths that a lobe may have, and the least shelf.
inline constexpr double narrowestLobe = 1e-5, widestLobe = 0.9, leastShelf = 1e-4;

}  // namespace hshfit::inline representation::inline halfway
