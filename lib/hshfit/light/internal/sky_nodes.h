#pragma once

#include <hshfit/light/light_samples.h>

namespace hshfit::inline light {

/// Adds Gauss nodes of a sky and its ground above a surface: rings about the normal, in panels that
/// end where the world's horizon touches a ring; each ring in its arc of sky and its arc of ground.
/// Radiance has a kink at the sun, towards which panels and arcs shrink by factors of 4.
void addSkyNodes(const SkyLight& light, const Frame& frame, int level, LightSamples& samples);

}  // namespace hshfit::inline light
