#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/representation/halfway/halfway_terms.h>

#include <cstddef>
#include <vector>

namespace hshfit::inline representation::inline halfway {

/// Pairs of directions with f at each.
struct HalfwaySamples {
    std::vector<HalfwayPoint> points;
    std::vector<double> cosines;      ///< cos(theta_i)
    std::vector<unsigned char> lobe;  ///< 1 for pairs spread over the axes of the expansion
    std::vector<double> values;       ///< f, [sample][channel]; negative values are 0

    std::size_t size() const { return cosines.size(); }
    std::size_t channels() const { return size() == 0 ? 0 : values.size() / size(); }
};

/// Which pairs: every fourth that is fitted is spread over the axes (uniform in arccos(1 - u), v
/// and the azimuths), the others and all that are held out are uniform on both hemispheres.
enum class HalfwayPart { fitted, heldOut };

/// Appends pairs number `first` .. `last` - 1 of the sequence of a part, those below the horizon
/// left out. The sequence is Roberts' R_d, frac(1/2 + n / phi_d^j) with phi_d^{d+1} = phi_d + 1
/// (M. Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018), d = 3 for an
/// isotropic BRDF and 4 otherwise. Throws NumericError where f is not finite.
void appendSamples(const Brdf& brdf, HalfwayPart part, std::size_t first, std::size_t last,
                   HalfwaySamples& samples);

}  // namespace hshfit::inline representation::inline halfway
