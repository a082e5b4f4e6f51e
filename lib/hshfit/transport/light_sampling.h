#pragma once

#include <hshfit/transport/surface_scene.h>

#include <array>
#include <cstddef>

namespace hshfit::inline transport {

/// Direct light by samples of the lights of a scene. The scene has to outlive this.
class LightSampling {
public:
    /// whole      samples of the lights are the only way to meet them
    /// heuristic  directions of the material's sampler meet them too: both are weighted by the
    ///            power heuristic with exponent 2 (Veach 1997)
    enum class Weight { whole, heuristic };

    explicit LightSampling(const SurfaceScene& scene);

    bool any() const { return emitterShare_ > 0 || scene_.environment().any(); }
    /// Light that one sample finds and the surface reflects towards hit.wo. Four independent
    /// numbers, uniform in [0, 1); adds the rays that it traces.
    Rgb reflected(const SurfaceHit& hit, const std::array<double, 4>& u, Weight weight,
                  std::size_t& rays) const;

    /// The heuristic's weight of an emitter, and of light from far away, that a direction of the
    /// density `pdf` (per steradian) has met.
    double emitterWeight(const SurfaceHit& met, double pdf) const;
    double environmentWeight(const Direction& world, double pdf) const;

private:
    Rgb ofEmitter(const SurfaceHit& hit, const EmitterSample& light, Weight weight,
                  std::size_t& rays) const;
    Rgb ofEnvironment(const SurfaceHit& hit, const EnvironmentSample& light, Weight weight,
                      std::size_t& rays) const;

    const SurfaceScene& scene_;
    /// The share of choosing emitters where there is light far away too.
    double emitterShare_;
};

}  // namespace hshfit::inline transport
