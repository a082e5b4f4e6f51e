#pragma once

#include <hshfit/light/lights.h>

#include <array>
#include <memory>
#include <span>
#include <vector>

namespace hshfit::inline transport {

/// A direction to light far away.
struct EnvironmentSample {
    Direction world;
    Rgb radiance{};      ///< of all lights together; of a directional light its irradiance
    double pdf = 0;      ///< per steradian; of a directional light the share of its choice
    bool delta = false;  ///< a directional light, which no other way of sampling meets
};

/// Densities over the sphere in proportion to the light that comes from far away: each disc and
/// panel by its own shape, each directional light by itself, and skies, pictures and coefficients
/// together by a table over elevation and azimuth, with `evenShare` of it even over the sphere so
/// that nothing is missed. Immutable; safe to use from many threads.
class EnvironmentSampler {
public:
    explicit EnvironmentSampler(std::span<const Light> lights);
    ~EnvironmentSampler();
    EnvironmentSampler(const EnvironmentSampler&) = delete;
    EnvironmentSampler& operator=(const EnvironmentSampler&) = delete;

    /// Whether there is any light.
    bool any() const;
    /// Three independent numbers, uniform in [0, 1).
    EnvironmentSample sample(const std::array<double, 3>& u) const;
    /// The density of `sample` without directional lights, per steradian.
    double pdf(const Direction& world) const;
    /// Radiance from a direction, without directional lights.
    Rgb radiance(const Direction& world) const;

    static constexpr double evenShare = 0.05;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace hshfit::inline transport
