#pragma once

#include <hshfit/bases/basis.h>
#include <hshfit/brdf/channels.h>
#include <hshfit/coefficients/coefficients.h>

#include <string>
#include <vector>

namespace hshfit::inline coefficients {

/// Captured energy by order (Eq. 15), as in a report.
struct LightCurve {
    struct Point {
        int order = 1;
        int coefficients = 1;  ///< functions that can be non-zero; slots are order^2
        double accuracy = 0;   ///< captured / whole energy; NaN where that does not exist
    };
    std::string basis;
    std::vector<Point> points;
};

/// Coefficients of incident radiance L, W / (m^2 sr), linear Rec. 709 or grey:
///     c_{l,m} = integral over the domain of L B_{l,m} d omega
/// in the inner product of the basis (for LSOSH after its Gram solve).
/// sphere      the world, right-handed with +z up; SH only
/// hemisphere  about a normal, in the frame whose +z it is and whose +x is the world's +x, carried
///             from +z to the normal along the great circle between them
struct LightCoefficients {
    enum class Domain { sphere, hemisphere };

    std::string basis;
    int order = 0;
    bool condonShortley = false;
    Domain domain = Domain::sphere;
    /// The normal of the hemisphere in the world, radians; not used for the sphere.
    double normalTheta = 0, normalPhi = 0;
    Channels channels = Channels::rgb();
    std::vector<double> values = {};  ///< [channel][slot]; slot l(l+1)+m, order^2 of them

    /// Integral of L^2 over the domain, in the inner product of the basis, summed over channels.
    /// Not finite for lights that are points.
    Energy energy = {};
    /// Estimated relative error of the coefficients, by roots of sums of squares.
    double error = 0;
    std::vector<LightCurve> curves = {};

    std::string source = {};     ///< the specification of the light
    std::string generator = {};  ///< "hshfit 0.1.0"

    std::size_t slots() const {
        return static_cast<std::size_t>(order) * static_cast<std::size_t>(order);
    }
    const double* at(std::size_t channel) const { return values.data() + channel * slots(); }
    double* at(std::size_t channel) { return values.data() + channel * slots(); }
};

}  // namespace hshfit::inline coefficients
