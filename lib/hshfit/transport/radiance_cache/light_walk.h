#pragma once

#include <hshfit/transport/light_sampling.h>
#include <hshfit/transport/random_numbers.h>
#include <hshfit/transport/surface_scene.h>

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

namespace hshfit::inline transport::inline radiance_cache {

/// The source of direct light.
enum class DirectLight {
    sampled,   ///< samples of the lights at each meeting; records hold what surfaces reflect
    gathered,  ///< the rays of records meet the lights: without noise under even skies
};

/// Materials of which f is one number for each colour: Lambert's.
class DiffuseMaterials {
public:
    explicit DiffuseMaterials(const SurfaceScene& scene);

    /// f of a hit's material; none for the others.
    const std::optional<Rgb>& at(std::size_t material) const { return f_[material]; }

private:
    std::vector<std::optional<Rgb>> f_;
};

/// Irradiance at a hit on a diffuse surface, beside the light that is sampled there; none where it
/// is better that a walk goes on, which it can unless `last`.
using KnownLight = std::function<std::optional<Rgb>(const SurfaceHit& hit, bool last)>;

/// Reflected radiance as a walk finds it: the light that was sampled on it, met by it and known at
/// its end.
struct Walk {
    Rgb radiance{};
    /// With less noise, for differences: without what a walk finds that goes on beyond a diffuse
    /// surface, whose points give that light instead.
    Rgb smooth{};
    Rgb endWeight{};  ///< times irradiance at the end: radiance at the walk's start
    /// The length of its first ray, infinite where that met nothing; 0 without one.
    double firstLength = 0;
};

/// Walks from surfaces by their materials' samplers up to the first diffuse surface of known light,
/// at most four reflections further than to the first. The scene has to outlive this.
class LightWalk {
public:
    LightWalk(const SurfaceScene& scene, DirectLight direct);

    /// Reflected radiance towards start.wo; adds the rays traced.
    Walk from(const SurfaceHit& start, const KnownLight& known, RandomNumbers& random,
              std::size_t& rays) const;
    /// Reflected direct light alone, by a sample of the lights and one of the material.
    Rgb direct(const SurfaceHit& hit, RandomNumbers& random, std::size_t& rays) const;
    /// The light that one direction of the material's sampler finds; direct light, which is
    /// weighted against samples of `lights()`, only if `direct`.
    Walk sampled(const SurfaceHit& start, const KnownLight& known, bool direct,
                 RandomNumbers& random, std::size_t& rays) const;

    const SurfaceScene& scene() const { return scene_; }
    const LightSampling& lights() const { return lights_; }
    const DiffuseMaterials& diffuse() const { return diffuse_; }
    DirectLight directLight() const { return direct_; }

private:
    struct Going;
    bool step(Going& going, bool direct, Walk& walk) const;
    bool ends(Going& going, const KnownLight& known, Walk& walk) const;

    const SurfaceScene& scene_;
    LightSampling lights_;
    DiffuseMaterials diffuse_;
    DirectLight direct_;
};

}  // namespace hshfit::inline transport::inline radiance_cache
