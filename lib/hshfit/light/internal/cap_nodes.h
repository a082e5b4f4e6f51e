#pragma once

#include <hshfit/brdf/directions.h>

#include <functional>
#include <optional>

namespace hshfit::inline light {

/// The part of a cap about `axis` that lies above the plane across `above`, if there is one.
struct Cap {
    Direction axis;
    double radius = pi;
    std::optional<Direction> above = {};
};

/// Receives a node and the solid angle that it stands for.
using EmitNode = std::function<void(const Direction&, double solidAngle)>;

/// Nodes over a cap that resolve functions of `order` bands; each level has half as many again in
/// both directions.
void addCapNodes(const Cap& cap, int order, int level, const EmitNode& emit);

}  // namespace hshfit::inline light
