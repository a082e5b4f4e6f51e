#pragma once

#include <hshfit/bases/basis.h>
#include <hshfit/brdf/brdf.h>
#include <hshfit/coefficients/coefficients.h>
#include <hshfit/coefficients/outgoing.h>

#include <functional>
#include <span>
#include <string>

namespace hshfit::inline projection {

/// Measured values of f for pairs of directions, and the symmetric pairs for which each stands.
struct DirectionSamples {
    std::span<const Direction> wi, wo;
    std::span<const double> values;  ///< 1/sr, [sample * channels.count() + channel]
    Channels channels;
    Laws symmetry;     ///< isotropic, mirrorSymmetric (isotropic only), reciprocal
    std::string name;  ///< for messages and Coefficients::source
};

struct LeastSquaresOptions {
    Quantity quantity = Quantity::brdf;
    /// Tikhonov: the root of the weight of |c|^2, in units of the root mean square singular value.
    double regularisation = 0;
    /// Radians; the kernel about an outgoing direction is no wider.
    double kernel = radians(20);
    /// Called from any thread with outgoing directions done and in all.
    std::function<void(std::size_t, std::size_t)> progress = {};
};

struct LeastSquaresProjection {
    Coefficients coefficients;  ///< with `leastSquares` set
    std::size_t samples = 0;    ///< images under the symmetries included
};

/// Coefficients straight from scattered samples: for each outgoing direction w the minimum of
///     sum_k K(a_k) (q_k - sum_j c_j B_j(wi_k))^2 + X^2 s^2 |c|^2,   q = f or f cos(theta_i),
/// by column-pivoted QR. a_k is the angle between wo_k and w (isotropic: between their
/// elevations, the pair being turned to the azimuth of w); K(a) = (1 - (a/r)^2)^2, r = 1.5 times
/// the angle within which lie four times as many samples as coefficients, from 1 degree to
/// `kernel`. X is `regularisation`, s^2 the mean square singular value of the weighted system.
///
/// In `coefficients.leastSquares`: the largest condition number of the systems, before they are
/// regularised (singular values of R), and the relative residual |q - B c| / |q| over all. Where a
/// condition number is beyond 1/error of the data, coefficients are noise: regularise, or lower
/// the order. `energy` is the energy of the fit, and energy.error the residual's share of it.
///
/// Throws NumericError where a direction has fewer samples than coefficients, naming both, or where
/// a system without regularisation has no full rank. UsageError: elevations for anisotropic data.
/// Runs on all threads that oneTBB has; results do not depend on their number.
LeastSquaresProjection projectLeastSquares(const DirectionSamples& samples, const Basis& basis,
                                           const OutgoingSet& outgoing,
                                           const LeastSquaresOptions& options = {});

}  // namespace hshfit::inline projection
