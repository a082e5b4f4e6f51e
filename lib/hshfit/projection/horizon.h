#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/coefficients/coefficients.h>

namespace hshfit::inline projection {

/// The limit of q = f or f cos(theta_i) as wi goes down to the horizon, for one wo.
struct HorizonBehaviour {
    /// Largest a, over azimuths and channels, with q ~ cos(theta_i)^-a; 0 where q stays bounded.
    double exponent = 0;
    double azimuth = 0;  ///< where, radians

    /// The integral of q^2 d omega exists for a < 1/2; weighted by cos(theta_i), for a < 1.
    bool energyExists(Basis::Inner inner) const;
    /// The integral of |q| B d omega exists for a < 1.
    bool coefficientsExist() const;
};

/// Measures the exponent from the growth of q between cos(theta_i) = 1e-10 and 1e-14. A power law
/// is found wherever q is above zero in double precision; the tolerance on a is 0.01.
HorizonBehaviour horizonBehaviour(const Brdf& brdf, const Direction& wo, Quantity quantity);

/// The reason why an energy does not exist, for reports: the law, and the remedy.
std::string divergenceReason(const HorizonBehaviour& behaviour, const Direction& wo,
                             Quantity quantity);

}  // namespace hshfit::inline projection
