#pragma once

#include <brdfs/fit/gaussian_mixture.h>

#include <memory>
#include <string>
#include <string_view>

namespace hshfit::brdfs {

/// The JSON of a mixture (docs/schemas/gaussians.schema.json): angles in degrees, every number
/// exact but for what degrees cost.
std::string gaussianMixtureJson(const GaussianMixture& mixture);

/// Whether the text is JSON that says it is a mixture.
bool isGaussianMixture(std::string_view text);

/// Reads it back; errors and albedos are taken as they stand. `where` (a path) is the BRDF's name
/// and starts every message. Throws InputError: not JSON, another format or version, a field
/// absent, of the wrong type or out of its range, elevations that do not ascend, uneven numbers of
/// lobes or amplitudes.
std::unique_ptr<GaussianMixture> openGaussianMixture(std::string_view text,
                                                     const std::string& where);

}  // namespace hshfit::brdfs
