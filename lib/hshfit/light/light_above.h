#pragma once

#include <hshfit/light/light_samples.h>

#include <span>
#include <vector>

namespace hshfit::inline light {

/// The samples of sampleLights above any normal: parts of pictures are cut once, in the world.
class LightAbove {
public:
    LightAbove(std::span<const Light> lights, int level);

    /// The parts of pictures alone, and the other lights.
    LightSamples pictures(const Frame& frame) const;
    LightSamples others(const Frame& frame) const { return sampleLights(others_, frame, level_); }
    LightSamples at(const Frame& frame) const;
    std::size_t pictureParts() const { return parts_.count(); }
    bool hasOthers() const { return !others_.empty(); }

private:
    int level_;
    LightSamples parts_;  ///< in the world
    std::vector<Light> others_;
};

}  // namespace hshfit::inline light
