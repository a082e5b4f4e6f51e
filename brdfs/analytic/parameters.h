#pragma once

#include <brdfs/rows/spec.h>

#include <algorithm>
#include <utility>

namespace hshfit::brdfs {

// Parameters that many models have. `most` is 1 for albedos. Other values may go to 1e6, so
// that fits to data in other units stay representable.

inline Parameter fitted(Parameter parameter, std::vector<FitRange> fit) {
    parameter.fit = std::move(fit);
    return parameter;
}

inline Parameter linearIf(Parameter parameter, bool (*linear)(const Parameters& stated)) {
    parameter.linear = linear;
    return parameter;
}

inline Parameter inRole(Parameter parameter, Parameter::Role role) {
    parameter.role = role;
    return parameter;
}

/// Parameter::linear of a scale.
inline bool alwaysLinear(const Parameters&) {
    return true;
}

/// Parameter::linear of a reflectance that ks scales: linear in their product, and Schlick's form
/// in the reflectance.
inline bool linearUnderStatedScale(const Parameters& stated) {
    const std::vector<double>& ks = stated.numbers.find("ks")->second;
    const auto fresnel = stated.words.find("fresnel");
    return stated.given("ks") && std::ranges::any_of(ks, [](double k) { return k > 0; }) &&
           (fresnel == stated.words.end() || fresnel->second == "schlick");
}

inline Parameter kdParameter(double fallback, double most) {
    return {.name = "kd",
            .help = "diffuse albedo",
            .kind = Parameter::Kind::colour,
            .fallback = fallback,
            .min = 0,
            .max = most,
            .fit = {{.low = 0, .high = 1}},
            .linear = alwaysLinear,
            .role = Parameter::Role::weight};
}

inline Parameter ksParameter(std::string_view help, double most = 1e6) {
    return {.name = "ks",
            .help = help,
            .kind = Parameter::Kind::colour,
            .fallback = 1,
            .min = 0,
            .max = most,
            .fit = {{.low = 0, .high = 1}},
            .linear = alwaysLinear,
            .role = Parameter::Role::weight};
}

inline Parameter f0Parameter() {
    return {.name = "F0",
            .help = "Fresnel reflectance at normal incidence",
            .kind = Parameter::Kind::colour,
            .fallback = 1,
            .min = 0,
            .max = 1,
            .linear = linearUnderStatedScale,
            .role = Parameter::Role::weight};
}

inline Parameter exponentParameter(std::string_view name, std::string_view help, FitRange fit) {
    fit.logarithmic = true;
    return {.name = name, .help = help, .min = 0, .max = 1e7, .fit = {fit}};
}

/// RMS slope and the like; the least value gives a lobe 0.006 degrees wide. Fits start from the
/// widths of the materials of Ngan et al. 2005 and from sharper ones.
inline Parameter roughnessParameter(std::string_view name, std::string_view help,
                                    FitRange fit = {}) {
    fit.low = 3e-3, fit.high = 0.7, fit.logarithmic = true;
    return {.name = name, .help = help, .min = 1e-4, .max = 10, .fit = {fit}};
}

inline Parameter switchParameter(std::string_view name, std::string_view help) {
    return {
        .name = name, .help = help, .kind = Parameter::Kind::choice, .choices = {"false", "true"}};
}

}  // namespace hshfit::brdfs
