#include "light.h"

#include <hshfit/bases/catalog.h>
#include <hshfit/coefficient_files/light_file.h>
#include <hshfit/light/catalog.h>
#include <hshfit/light/light_projection.h>

namespace hshfit::jobs {
namespace {

std::optional<int> orderReaching(const LightCurve& curve, double share) {
    for (const LightCurve::Point& point : curve.points)
        if (point.accuracy >= share) return point.order;
    return {};
}

}  // namespace

ProjectedLight light(const std::vector<std::string>& specs, const std::string& output,
                     const LightOptions& options) {
    const auto basis =
        bases::make(options.basis, options.order, {.condonShortley = options.condonShortley});
    std::string text;
    for (const std::string& spec : specs) text += (text.empty() ? "" : " + ") + spec;
    const LightSpecification specification = parseLights(text);
    ProjectedLight result;
    result.light =
        projectLight(specification.lights, *basis,
                     {.domain = {.normal = options.normal}, .tolerance = options.tolerance});
    result.light.source = specification.text;
    result.bands = bandEnergies(result.light);
    for (const double share : lightShares)
        result.enough.push_back(orderReaching(result.light.curves.front(), share));
    if (!output.empty()) writeLight(result.light, output);
    return result;
}

}  // namespace hshfit::jobs
