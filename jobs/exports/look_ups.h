#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/lighting/lighting_shader.h>
#include <hshfit/lighting/prefiltered_lobes.h>

#include <string>
#include <string_view>

namespace hshfit::jobs {

/// A BRDF as lookups in an engine's environment, for a material that has them in its shader.
struct LookUps {
    lighting::PrefilteredTable fitted;
    lighting::LightingShader shader;
};

/// Besides the diffuse lookup two, or three for a lobe that may be long. `engine`: the name of a
/// row of lighting/prefilter.h.
LookUps lookUpsOf(const Brdf& brdf, std::string_view engine, const std::string& prefix,
                  const std::string& source);

}  // namespace hshfit::jobs
