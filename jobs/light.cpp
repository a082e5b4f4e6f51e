#include "light.h"

#include "nine_numbers.h"

#include <hshfit/bases/catalog.h>
#include <hshfit/coefficient_files/light_file.h>
#include <hshfit/light/catalog.h>
#include <hshfit/light/light_energy.h>
#include <hshfit/light/light_projection.h>
#include <hshfit/light/light_wavelets.h>
#include <hshfit/light/picture_light.h>
#include <hshfit/wavelets/slices.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace hshfit::jobs {
namespace {

std::optional<int> orderReaching(const LightCurve& curve, double share) {
    for (const LightCurve::Point& point : curve.points)
        if (point.accuracy >= share) return point.order;
    return {};
}

void addWavelets(ProjectedLight& result, const std::vector<Light>& lights,
                 const LightDomain& domain, const Basis& basis) {
    // Wavelets are orthonormal over solid angle.
    Energy energy = result.light.energy;
    if (basis.inner() != Basis::Inner::solidAngle)
        energy =
            lightEnergy(lights, domain, false, std::vector<std::optional<double>>(lights.size()));
    if (!energy.finite || !(energy.value > 0)) return;
    const LightTerms terms = lightTerms(lights, domain, static_cast<std::size_t>(basis.slots()));
    result.waveletError = terms.error;
    result.wavelets = LightCurve{.basis = std::string(wavelets::sohoName), .points = {}};
    for (int order = 1; order <= basis.order(); ++order) {
        const int count = order * order;
        result.wavelets->points.push_back(
            {order, count, terms.captured[static_cast<std::size_t>(count)] / energy.value});
    }
    for (const double share : lightShares) {
        const auto order = orderReaching(*result.wavelets, share);
        result.enoughWavelets.push_back(order ? std::optional(*order * *order) : std::nullopt);
    }
}

}  // namespace

ProjectedLight light(const std::vector<std::string>& specs, const std::string& output,
                     const LightOptions& options) {
    const auto basis =
        bases::make(options.basis, options.order, {.condonShortley = options.condonShortley});
    const LightSpecification specification{.text = fmt::format("{}", fmt::join(specs, " + ")),
                                           .lights = lightsOf(specs)};
    ProjectedLight result;
    result.light =
        projectLight(specification.lights, *basis,
                     {.domain = {.normal = options.normal}, .tolerance = options.tolerance});
    result.light.source = specification.text;
    result.remarks = remarksOf(specification.lights);
    result.bands = bandEnergies(result.light);
    for (const double share : lightShares)
        result.enough.push_back(orderReaching(result.light.curves.front(), share));
    if (options.wavelets)
        addWavelets(result, specification.lights, {.normal = options.normal}, *basis);
    if (!output.empty()) writeLight(result.light, output);
    return result;
}

}  // namespace hshfit::jobs
