#pragma once

#include <hshfit/brdf/brdf.h>

#include <cmath>
#include <cstddef>
#include <vector>

namespace hshfit::inline quadrature {

/// The azimuths of a ring. With squeeze = 0 they are equispaced: phi_j = t_j = (j + 1/2) 2 pi /
/// azimuths. Otherwise they cluster about a centre, where a lobe is narrow:
///     tan((phi_j - centre) / 2) = kappa tan(t_j / 2),   kappa = 2^-squeeze,
/// a map of the unit circle onto itself, which keeps functions periodic and analytic. A singularity
/// that lies i delta off the centre moves away to i delta / kappa, and lobes of width w need of the
/// order of w^-1/2 azimuths, not w^-1.
struct AzimuthSpacing {
    std::size_t azimuths = 0;  ///< a multiple of 4
    int squeeze = 0;
    double kappa() const { return std::ldexp(1.0, -squeeze); }
};

/// The spacing and, for clustered azimuths, the cosine and sine of their centre.
struct AzimuthSpread {
    AzimuthSpacing spacing = {};
    double centreX = 1, centreY = 0;
};

/// Cosine and sine of the azimuth at t, from the centre, and d phi / dt; none of them cancels.
struct SpreadAzimuth {
    double cosine, sine, weight;
};
SpreadAzimuth spreadAzimuth(double t, const AzimuthSpacing& spacing);

struct SpreadOptions {
    int order = 7;          ///< azimuth functions that have to be resolved exactly
    double refinement = 1;  ///< number of azimuths, relative to that which just resolves lobes
    bool squeezed = false;  ///< whether azimuths may be clustered
    bool even = false;      ///< only about a centre on the x axis
};

/// Singularities along phi of a BRDF with these lobes, on rings with u = sqrt(cos theta) in [a, b]:
/// points in the complex plane of phi, `scale` off the real axis, at azimuths given by cosine and
/// sine.
class AzimuthPeaks {
public:
    struct Peak {
        double x, y, scale;
    };

    AzimuthPeaks(const std::vector<Lobe>& lobes, const Direction& wo, double a, double b);

    /// The narrowest peak; null where there are no lobes, or with `even`, no lobes on the x axis.
    const Peak* narrowest(bool even) const;
    /// The least of the scales; at most the scale assumed for a BRDF without lobes.
    double scale() const;
    /// The least scale for azimuths clustered about `centre`, in t.
    double scaleAbout(const Peak& centre, double kappa) const;

private:
    void add(double x, double y, double scale);
    void addLobe(const Lobe& lobe, const Direction& wo, double s, double mu);
    bool addAnisotropic(const Lobe& lobe, const Direction& wo, double s, double mu);
    void addRoot(double re, double im);

    std::vector<Peak> peaks_;  ///< the narrowest at each azimuth
};

/// Azimuths for rings with these peaks. Trapezoid sums over t converge like exp(-azimuths *
/// distance), where a lobe is a singularity at that distance from the real axis. The squeeze is the
/// one with the fewest azimuths among those that are nowhere sparser than without lobes.
AzimuthSpread spreadAzimuths(const AzimuthPeaks& peaks, const SpreadOptions& options);

}  // namespace hshfit::inline quadrature
