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
    bool inPlane = false;  ///< wo.y = 0 and f is its own mirror image at the plane of incidence

    std::size_t count() const { return weights.size(); }
};

/// Nodes that resolve functions of `order` bands, refined until the albedo changes by less than
/// 2e-4, or a million of them (an eighth of that where there is a table for each azimuth). `brdf`
/// is grey or RGB. Throws NumericError where f is not finite, UsageError for other channels.
LobeNodes lobeNodes(const Brdf& brdf, const Direction& wo, int order);

/// Every lobe is its own mirror image at the plane of incidence.
constexpr bool lobesInPlane(const Laws& laws) {
    return laws.isotropic && laws.mirrorSymmetric;
}

/// The same for wo at that elevation and azimuth, turned about the normal so that wo.y = 0.
LobeNodes viewNodes(const Brdf& brdf, double cosine, double azimuth, int order);

/// About `most` of the nodes where there are more, drawn evenly by their shares of the energy and
/// of the solid angle, a half each: integrals of what varies as f does keep their values but for a
/// noise of about 1 / most.
LobeNodes thinned(const LobeNodes& nodes, std::size_t most);

/// A lobe f cos(theta_i) as an even part and a rest with its first moment.
struct LobeSummary {
    Rgb albedo{};  ///< integral of f cos(theta_i)
    /// The even part of the albedo: pi times the level that f falls below on a share of the
    /// hemisphere (a quantile by projected solid angle), at most the albedo.
    Rgb even{};
    Rgb rest{};  ///< albedo - even
    /// Mean direction of the rest, over the channels, as a unit vector, and the mean cosine about
    /// it. The mirror direction and 1 where there is no rest.
    Direction axis;
    double meanCosine = 1;
};
LobeSummary summarise(const LobeNodes& nodes, double evenShare);

/// Two directions across an axis: x and y of the frame, tilted as +z is to the axis (which is not
/// -z).
struct AcrossAxis {
    explicit AcrossAxis(const Direction& axis);
    Direction at(double angle) const;  ///< from the first, towards the second
    Direction first, second;
};

/// Second moments of the rest across its axis, by AcrossAxis: of the squares of both components
/// the sum and the difference, and twice the mean product. The lobe is widest at half the angle of
/// (difference, product).
struct LobeSpread {
    double sum = 0, difference = 0, product = 0;

    double angle() const;  ///< from AcrossAxis::first, of the widest direction
    /// Mean squares along that direction and across it; the second is at least 0.
    double widest() const;
    double narrowest() const;
};
LobeSpread spreadOf(const LobeNodes& nodes, const LobeSummary& lobe);

/// Shares to choose from: none for lobes with long tails, which would count as even; a quarter for
/// a lobe over a diffuse part that fades towards the horizon.
inline constexpr double evenShares[] = {0, 0.05, 0.25};

/// Half the integral of |f cos - even cos / pi - rest density(wi)| over the albedo, the mean over
/// channels: the share of the light that is misplaced.
double misplaced(const LobeNodes& nodes, const LobeSummary& lobe,
                 const std::function<double(const Direction&)>& density);

}  // namespace hshfit::lighting
