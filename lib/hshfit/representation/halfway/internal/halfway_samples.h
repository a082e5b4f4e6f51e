#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/representation/halfway/halfway_envelope.h>
#include <hshfit/representation/halfway/halfway_terms.h>

#include <cstddef>
#include <vector>

namespace hshfit::inline representation::inline halfway {

/// The way in which a pair was drawn: uniform on both hemispheres; uniform in arccos(1 - u), v and
/// the azimuths, the axes of the expansion; or by powers of ten of the cosines from 1 to 1e-4, wi
/// likewise or about the mirror direction, with slopes of h by powers of ten from 1e-4 to 10.
enum class HalfwaySpread : unsigned char { uniform, axes, horizon };

/// Pairs of directions with f at each.
struct HalfwaySamples {
    std::vector<HalfwayPoint> points;
    std::vector<EnvelopePoint> places;
    std::vector<double> cosines;  ///< cos(theta_i)
    std::vector<HalfwaySpread> spread;
    std::vector<double> values;  ///< f, [sample][channel]; negative values are 0

    std::size_t size() const { return cosines.size(); }
    std::size_t channels() const { return size() == 0 ? 0 : values.size() / size(); }
};

/// Two disjoint sequences of pairs. Of eight fitted pairs, two are spread over the axes and one
/// towards the horizon; all pairs held out are uniform.
enum class HalfwayPart { fitted, heldOut };

/// Appends pairs number `first` .. `last` - 1 of the sequence of a part, those below the horizon
/// left out. The sequence is Roberts' R_d, frac(1/2 + n / phi_d^j) with phi_d^{d+1} = phi_d + 1
/// (M. Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018), d = 3 for an
/// isotropic BRDF and 4 otherwise. Throws NumericError where f is not finite.
void appendSamples(const Brdf& brdf, HalfwayPart part, std::size_t first, std::size_t last,
                   HalfwaySamples& samples);

}  // namespace hshfit::inline representation::inline halfway
