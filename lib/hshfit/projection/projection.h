#pragma once

#include <hshfit/bases/basis.h>
#include <hshfit/brdf/brdf.h>
#include <hshfit/coefficients/coefficients.h>
#include <hshfit/coefficients/outgoing.h>

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace hshfit::inline projection {

struct ProjectionOptions {
    Quantity quantity = Quantity::brdf;
    /// Relative error of the quadrature in energy and coefficients, as its levels show it;
    /// 0 takes the BRDF's own default (1e-6 for analytic models).
    double tolerance = 0;
    /// BRDF evaluations per outgoing direction after which refinement gives up: bounds the time.
    std::size_t maxEvaluations = std::size_t{1} << 26;
    /// Called from any thread with outgoing directions done and in all.
    std::function<void(std::size_t, std::size_t)> progress = {};
};

/// The coefficients in one basis, and the energy that each order captures.
struct Projection {
    Coefficients coefficients;
    /// [n - 1]: energy captured by the first n bands (numerator of Eq. 15), summed like `energy`.
    std::vector<double> captured;
    std::size_t evaluations = 0;  ///< of the BRDF, over all outgoing directions and levels
};

/// Projects `brdf` over wi onto every basis at once, for every outgoing direction:
///     c_{l,m}(wo) = integral of q(wi, wo) B_{l,m}(wi) d omega_i,    q = f or f cos(theta_i)
/// (Gautron et al. 2004, Eq. 17), in the inner product of each basis.
///
/// The grid has Gauss-Legendre nodes in u = sqrt(cos theta), graded towards the BRDF's lobes, times
/// azimuths clustered about narrow ones (azimuth_spread.h); it is refined until the error that its
/// levels show is within the tolerance (refinement.h). One azimuth transform serves all bases.
/// Isotropy and mirror symmetry leave out outgoing directions and sine terms. Runs on all threads
/// that oneTBB has; results do not depend on their number.
///
/// Throws NumericError where the coefficients do not exist or do not converge, or where f is not
/// finite; an energy alone that does not exist is reported in `coefficients.energy`.
/// UsageError: an elevation set for an anisotropic BRDF; a tolerance below 0, above 1 or NaN.
std::vector<Projection> project(const Brdf& brdf, std::span<const Basis* const> bases,
                                const OutgoingSet& outgoing, const ProjectionOptions& options = {});

}  // namespace hshfit::inline projection
