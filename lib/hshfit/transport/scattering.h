#pragma once

#include <hshfit/transport/surface_scene.h>

#include <optional>

namespace hshfit::inline transport {

// Reflection at a hit whose interpolated normal differs from its triangle's. Directions above the
// interpolated horizon may lie below the triangle, where light cannot go. They are mirrored at the
// triangle: a direction `world` above it stands for itself and for its mirror image, and has the
// sum of both values of f cos(theta_i) and of both densities. The integral over directions equals
// the integral of the BRDF over its own hemisphere, so that no light is lost: a surface of albedo 1
// reflects all light, whatever its normals.

/// `world`, or its mirror image at the triangle where it is below.
Direction aboveTriangle(const SurfaceHit& hit, const Direction& world);

/// f cos(theta_i) towards hit.wo for light from a direction of the world; 0 below the triangle.
Rgb reflectedShare(const SurfaceScene& scene, const SurfaceHit& hit, const Direction& world);

/// The density of `scatter`, per steradian.
double scatteringPdf(const SurfaceScene& scene, const SurfaceHit& hit, const Direction& world);

/// A direction in which a path goes on.
struct Scattered {
    Direction world;
    Rgb weight{};    ///< f cos(theta_i) / pdf
    double pdf = 0;  ///< per steradian
};

/// Draws a direction by the sampler of the hit's material; nothing where no light is reflected.
/// `u`: three independent numbers, uniform in [0, 1).
std::optional<Scattered> scatter(const SurfaceScene& scene, const SurfaceHit& hit,
                                 const std::array<double, 3>& u);

}  // namespace hshfit::inline transport
