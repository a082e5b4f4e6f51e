#pragma once

#include <hshfit/sampling/sampler.h>

namespace hshfit::inline sampling {

/// Incident directions as mirror directions of wo about visible normals h of a rough surface:
///     pdf = D(h) G1(wo, h) / (4 cos(theta_o)),   folded at the horizon.
/// The weight f cos / pdf of a microfacet model with this D is then F G / G1 <= F.

/// Smith's G1 and D of Trowbridge & Reitz (GGX), with widths ax, ay > 0 in units of slope along x
/// and y. Heitz 2018, JCGT 7(4); drawn by the spherical caps of Dupuy & Benyoub 2023,
/// 10.1111/cgf.14867.
std::shared_ptr<const Sampler> ggxSampler(double ax, double ay);

// The same for widths that change from one wo to the next; nothing is folded, wo.z > 0.

/// A direction of the sphere, of length 1 up to rounding, from two uniform numbers in [0, 1).
Direction drawGgx(const Direction& wo, double ax, double ay, double u, double v);
/// Per steradian; 0 where wo + wi is not above the horizon.
double ggxDensity(const Direction& wo, const Direction& wi, double ax, double ay);

/// Smith's G1 and D of Beckmann's Gaussian slopes exp(-(tx/ax)^2 - (ty/ay)^2). Heitz & d'Eon 2014,
/// 10.1111/cgf.12417; the slope along wo is the root of its distribution, to rounding.
std::shared_ptr<const Sampler> beckmannSampler(double ax, double ay);

/// Half vectors over the upper hemisphere, drawn from D h.z; D is even in (h.x, h.y).
class NormalDistribution {
public:
    /// A unit vector, and 1 - z without cancellation.
    struct Normal {
        double x, y, z, versine;
    };
    virtual ~NormalDistribution() = default;
    virtual std::string_view name() const = 0;
    virtual Normal draw(double u, double v) const = 0;
    /// D h.z per steradian; it integrates to 1 over the hemisphere.
    virtual double density(const Normal& h) const = 0;
};

/// G1 of V-shaped grooves, min(1, 2 h.z cos(theta_o) / (h.wo)), and any D that is unchanged by h ->
/// (-h.x, -h.y, h.z): h is drawn from D h.z, and exchanged for its groove's other side in
/// proportion to the visible areas (Heitz & d'Eon 2014, 10.1111/cgf.12417, section 4.2).
/// Exact for models with such masking; for models without masking the weight stays near its bound.
std::shared_ptr<const Sampler> grooveSampler(std::shared_ptr<const NormalDistribution> normals);

/// exp(-(tx/ax)^2 - (ty/ay)^2) / (pi ax ay h.z^4), tx, ty: slopes of h. Ward's and Beckmann's.
std::shared_ptr<const NormalDistribution> gaussianNormals(double ax, double ay);

/// D h.z = sqrt((nu + 1)(nv + 1)) / (2 pi) h.z^((nu h.x^2 + nv h.y^2) / (1 - h.z^2)); nu, nv >= 1.
/// Ashikhmin & Shirley 2000, 10.1080/10867651.2000.10487522.
std::shared_ptr<const NormalDistribution> powerNormals(double nu, double nv);

/// c / (alpha^2 cos^2 theta_h + sin^2 theta_h)^gamma, 0 < alpha <= 1, gamma > 0. Burley 2012,
/// "Physically-based shading at Disney", appendix B.
std::shared_ptr<const NormalDistribution> gtrNormals(double alpha, double gamma);

}  // namespace hshfit::inline sampling
