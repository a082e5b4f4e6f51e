#pragma once

#include <brdfs/catalog.h>

namespace hshfit::brdfs {

// Parameters that many models have. `most` is 1 where the value is an albedo and a larger one has
// no meaning, else 1e6: fits to data in other units are to stay representable.

inline Parameter kdParameter(double fallback, double most) {
    return {.name = "kd",
            .help = "diffuse albedo",
            .kind = Parameter::Kind::colour,
            .fallback = fallback,
            .min = 0,
            .max = most};
}

inline Parameter ksParameter(std::string_view help, double most = 1e6) {
    return {.name = "ks",
            .help = help,
            .kind = Parameter::Kind::colour,
            .fallback = 1,
            .min = 0,
            .max = most};
}

inline Parameter f0Parameter() {
    return {.name = "F0",
            .help = "Fresnel reflectance at normal incidence",
            .kind = Parameter::Kind::colour,
            .fallback = 1,
            .min = 0,
            .max = 1};
}

inline Parameter exponentParameter(std::string_view name, std::string_view help) {
    return {.name = name, .help = help, .min = 0, .max = 1e7};
}

/// RMS slope and the like; the lobe of the least one is 0.006 degrees wide.
inline Parameter roughnessParameter(std::string_view name, std::string_view help) {
    return {.name = name, .help = help, .min = 1e-4, .max = 10};
}

inline Parameter switchParameter(std::string_view name, std::string_view help) {
    return {
        .name = name, .help = help, .kind = Parameter::Kind::choice, .choices = {"false", "true"}};
}

}  // namespace hshfit::brdfs
