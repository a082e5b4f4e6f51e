#pragma once

#include <hshfit/brdf/brdf.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace hshfit::inline accuracy {

/// The health of a BRDF, measured by evaluating it. Deterministic: the same for any number of
/// threads.
struct Health {
    /// Direction pairs evaluated: half of them uniform over both hemispheres, half by half and
    /// difference angles with theta_h crowded towards 0, where lobes are.
    std::size_t pairs = 0;
    /// The share of the uniform pairs at which f rests on measured samples, to about half a per
    /// cent of all pairs; 1 for a model.
    double coverage = 1;
    /// Counts of values, of which there is one per channel and pair.
    std::uint64_t values = 0, negative = 0, notFinite = 0;

    /// Sum of |f(wi, wo) - f(wo, wi)| c over the sum of (|f(wi, wo)| + |f(wo, wi)|) c, where c =
    /// cos(theta_i) cos(theta_o), for all channels and the pairs that are covered both ways: 0 if
    /// reciprocal, 1 if one of f(wi, wo) and f(wo, wi) is always 0.
    double reciprocityDefect = 0;
    /// The covered pair with the largest difference, times c, in a channel.
    struct Exchange {
        Direction wi, wo;
        std::size_t channel = 0;
        double value = 0, exchanged = 0;  ///< f(wi, wo), f(wo, wi)
    };
    std::optional<Exchange> worstExchange;

    /// An integral over one hemisphere, with the direction that is fixed.
    struct Albedo {
        Direction at;
        std::vector<double> values = {};  ///< one per channel; empty where f is not finite
        double error = 0;                 ///< of the quadrature, absolute
        bool converged = false;           ///< to the tolerance
    };
    /// By theta and, for an anisotropic BRDF, four azimuths. Albedos are integrals over wi for a wo
    /// (estimateAlbedo), reflectances over wo for a wi (estimateReflectance): the share of light
    /// that is reflected. Both are the same numbers for a BRDF that claims reciprocity.
    std::vector<Albedo> albedos, reflectances;
    double albedoTolerance = 0;  ///< of the quadrature, relative (AlbedoOptions)
    std::size_t albedoEvaluations = 0;
    /// The largest of each.
    double largestAlbedo() const;
    double largestReflectance() const;
    /// Whether a reflectance is above 1 by more than its error and twice the tolerance: the surface
    /// reflects more than it receives.
    bool createsEnergy() const;
};

struct HealthOptions {
    std::size_t pairs = 16384;
    double albedoTolerance = 1e-3;
    /// For all albedos together, and for all reflectances together; they share them evenly. Where
    /// they do not do, the error that is left is stated. Two million take seconds where f is a
    /// search among samples.
    std::size_t albedoEvaluations = std::size_t{1} << 21;
    std::function<void(std::size_t, std::size_t)> progress = {};
};

/// Evaluates the BRDF at pairs of directions and integrates its albedos.
Health examine(const Brdf& brdf, const HealthOptions& options = {});

}  // namespace hshfit::inline accuracy
