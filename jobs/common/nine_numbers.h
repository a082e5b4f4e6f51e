#pragma once

#include <hshfit/coefficients/light_coefficients.h>
#include <hshfit/light/catalog.h>

#include <optional>
#include <string>
#include <vector>

namespace hshfit::jobs {

/// Light of nine coefficients in a text file of an engine's numbers,
/// `PATH:convention=NAME`, `PATH:for=NAME` from that engine's own import of a panorama, which is
/// turned back, or PATH alone for cmgen's text, which states its own
/// (irradiance/nine_numbers.h). None for any other specification. Throws UsageError and InputError.
std::optional<LightCoefficients> nineNumbers(const std::string& specification);

/// The lights of several specifications, each of them as `parseLights` takes it or nine numbers.
std::vector<Light> lightsOf(const std::vector<std::string>& specifications);

}  // namespace hshfit::jobs
