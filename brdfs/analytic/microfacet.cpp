#include <brdfs/analytic/microfacet.h>

#include <brdfs/analytic/parameters.h>
#include <brdfs/rows/spec.h>
#include <hshfit/error.h>

#include <fmt/format.h>

namespace hshfit::brdfs {

std::vector<Parameter> microfacetParameters() {
    constexpr double notGiven = 0;
    constexpr FitRange both{.data = FitRange::Data::isotropic, .unless = "ax"};
    constexpr FitRange single{.data = FitRange::Data::anisotropic, .unless = "alpha"};
    Parameter alpha = roughnessParameter("alpha", "roughness, the same along x and y", both);
    Parameter ax = roughnessParameter("ax", "roughness along x, in place of alpha", single);
    Parameter ay = roughnessParameter("ay", "roughness along y, in place of alpha", single);
    for (Parameter* parameter : {&alpha, &ax, &ay}) parameter->fallback = notGiven;
    std::vector<Parameter> parameters{kdParameter(0, 1), facetScaleParameter()};
    for (const Parameter& parameter : facetFresnelParameters()) parameters.push_back(parameter);
    parameters.insert(parameters.end(), {alpha, ax, ay, maskingParameter()});
    return parameters;
}

Parameter facetScaleParameter() {
    return ksParameter("scale of the lobe; 1 for facets that are as bright as F says");
}

Parameter maskingParameter() {
    return {.name = "masking",
            .help = "Smith's, with heights correlated or each direction by itself",
            .kind = Parameter::Kind::choice,
            .choices = {"correlated", "separable"}};
}

Roughness roughnessOf(const Model& model, const Parameters& p) {
    const double alpha = p.number("alpha"), ax = p.number("ax"), ay = p.number("ay");
    if (alpha > 0 && ax == 0 && ay == 0) return {alpha, alpha};
    if (alpha == 0 && ax > 0 && ay > 0) return {ax, ay};
    const std::string valid = validValues(roughnessParameter("alpha", ""));
    throw UsageError(
        fmt::format("{}: give either alpha or both ax and ay; valid: {}", model.name, valid));
}

/// The facets reflect at most ks F <= 1 of the light; a diffuse term adds to that.
Laws microfacetLaws(const Parameters& p, const Roughness& roughness) {
    Laws laws = microfacetClaims;
    laws.isotropic = roughness.ax == roughness.ay;
    laws.energyConserving = largest(p.colour("kd")) == 0 && largest(p.colour("ks")) <= 1;
    return laws;
}

}  // namespace hshfit::brdfs
