#pragma once

#include <hshfit/light/light_samples.h>
#include <hshfit/light/lights.h>

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace hshfit::inline light {

/// The part of the world that is projected, and its frame: the whole sphere with +z up, or the
/// hemisphere about a normal, in the frame of `Frame`.
struct LightDomain {
    std::optional<Orientation> normal;  ///< none: the sphere

    Frame frame() const { return Frame(normal.value_or(Orientation{})); }
};

/// Nodes of a quadrature over the light in a domain, in its frame. The sum of flux[k] B(d_k) is
/// the integral of L B d omega for functions B of a basis of the order asked for.
struct LightNodes {
    std::vector<double> x, y, z;
    std::array<std::vector<double>, 3> flux;  ///< radiance times weight, by R, G, B
    std::vector<double> weight;               ///< solid angles; 0 for light from a single direction

    std::size_t count() const { return x.size(); }
    void add(const Direction& local, const Rgb& radiance, double solidAngle);
};

/// Nodes of one light that resolve functions of `order` bands; each level has half as many again in
/// both directions. Discs and skies: rings about a pole of theirs, cut where the horizons of world
/// and domain cut them. Panels: Gauss by Gauss. Pictures: the flux of blocks of pixels, each pixel
/// with its own solid angle, spread over Gauss nodes of the block so that polynomials integrate
/// exactly; pixels on the horizon in parts.
LightNodes nodesOf(const Light& light, const LightDomain& domain, int order, int level);

}  // namespace hshfit::inline light
