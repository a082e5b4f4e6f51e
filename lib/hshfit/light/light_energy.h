#pragma once

#include <hshfit/coefficients/coefficients.h>
#include <hshfit/light/light_nodes.h>
#include <hshfit/light/lights.h>

#include <optional>
#include <span>

namespace hshfit::inline light {

/// Integral of L^2 over the domain, summed over R, G, B; `projected` with cos(theta). Discs,
/// panels and pictures by themselves exactly, all else and what overlaps by nodes at two levels,
/// whose difference is the error. It does not exist for light from a single direction.
/// `known` has one entry for each light: the energy of that light alone, if the caller has it.
Energy lightEnergy(std::span<const Light> lights, const LightDomain& domain, bool projected,
                   std::span<const std::optional<double>> known);

}  // namespace hshfit::inline light
