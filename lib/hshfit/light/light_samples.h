#pragma once

#include <hshfit/light/lights.h>
#include <hshfit/light/views.h>

#include <span>
#include <vector>

namespace hshfit::inline light {

/// The axes of a surface in the world.
struct Frame {
    explicit Frame(const Orientation& orientation);
    Direction toWorld(const Direction& local) const;
    Direction toLocal(const Direction& world) const;

    Direction tangent, bitangent, normal;
};

/// Lighting as directions above a surface, in its own frame, each with the integral of radiance
/// over the part of the lights that it stands for:
///     L(wo) = sum over k of flux[k] f(wi_k, wo) cos(theta_k)
struct LightSamples {
    std::vector<double> x, y, z;
    std::array<std::vector<double>, 3> flux;  ///< W / m^2 on a surface across it, per R, G, B

    std::size_t count() const { return x.size(); }
    DirectionBatch directions() const { return {x.data(), y.data(), z.data(), x.size()}; }
    void add(const Direction& local, const Rgb& radiance, double solidAngle);
    /// Adds the samples of `world`, whose directions are in the world, that are above the surface.
    void addAbove(const LightSamples& world, const Frame& frame);
};

/// Radiance that comes from a direction of the world, all lights together. Directional lights,
/// whose radiance no number is, are left out.
Rgb radianceFrom(std::span<const Light> lights, const Direction& world);

/// Nodes that follow each light's own shape: Gauss-Legendre by equispaced nodes over discs, Gauss
/// over panels and over the arcs of sky and ground above the surface, finer around the sun, parts
/// of pictures by their flux, one node for a directional light. Each level has 1.5 times as many
/// nodes again in both directions.
LightSamples sampleLights(std::span<const Light> lights, const Frame& frame, int level);

/// The same integral in another way, to check the first with: points of a lattice (Roberts 2018,
/// the plastic number) in equal-area maps of each disc, of each panel's plane and of the hemisphere
/// for sky and pictures, `points` for each light.
LightSamples latticeSamples(std::span<const Light> lights, const Frame& frame, std::size_t points);

}  // namespace hshfit::inline light
