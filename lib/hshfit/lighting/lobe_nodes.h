#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/light/lights.h>

#include <array>
#include <functional>
#include <vector>

namespace hshfit::lighting {

/// f at the nodes of a quadrature over wi, for one wo. Weights are solid angles.
struct LobeNodes {
    Direction wo;
    std::vector<double> x, y, z, weights;
    std::array<std::vector<double>, 3> f;  ///< R, G, B; the same three times where f is grey

    std::size_t count() const { return weights.size(); }
};

/// Nodes that resolve functions of `order` bands, refined until the albedo changes by less than
/// 2e-4, or a million of them. `brdf` is grey or RGB. Throws NumericError where f is not finite,
/// UsageError for other channels.
LobeNodes lobeNodes(const Brdf& brdf, const Direction& wo, int order);

/// A lobe f cos(theta_i) as an even part and a rest with its first moment.
struct LobeSummary {
    Rgb albedo{};  ///< integral of f cos(theta_i)
    /// The even part of the albedo: pi times the level that f falls below on a share of the
    /// hemisphere (a quantile by projected solid angle), at most the albedo.
    Rgb even{};
    Rgb rest{};  ///< albedo - even
    /// Of the rest, the mean over channels: unit vector of its mean direction, and that vector's
    /// length, the mean cosine about it. The mirror direction and 1 where there is no rest.
    Direction axis;
    double meanCosine = 1;
};
LobeSummary summarise(const LobeNodes& nodes, double evenShare);

/// Shares to choose from: none for lobes with long tails, which would count as even; a quarter for
/// a lobe over a diffuse part that fades towards the horizon.
inline constexpr double evenShares[] = {0, 0.05, 0.25};

/// Half the integral of |f cos - even cos / pi - rest density(wi)| over the albedo, the mean over
/// channels: the share of the light that is misplaced.
double misplaced(const LobeNodes& nodes, const LobeSummary& lobe,
                 const std::function<double(const Direction&)>& density);

}  // namespace hshfit::lighting
