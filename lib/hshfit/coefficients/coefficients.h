#pragma once

#include <hshfit/bases/basis.h>
#include <hshfit/brdf/channels.h>
#include <hshfit/coefficients/outgoing.h>

#include <optional>
#include <string>
#include <vector>

namespace hshfit::inline coefficients {

/// The function that was projected over wi: f, or f cos(theta_i).
enum class Quantity { brdf, brdfCosine };

/// "brdf" or "brdf_cosine", as in files.
std::string quantityName(Quantity quantity);

/// An energy integral with its error; `finite` is false where it does not exist.
struct Energy {
    double value = 0;  ///< NaN where it does not exist
    double error = 0;  ///< absolute, estimated from quadrature levels
    bool finite = true;
    std::string reason;  ///< why it does not exist
};

/// The least-squares fit of coefficients to scattered samples (least_squares.h).
struct LeastSquaresNote {
    double regularisation = 0;
    double kernelDegrees = 0;
    double condition = 0;  ///< the largest of the systems, before they were regularised
    double residual = 0;   ///< relative, over all of them
    std::size_t samples = 0;
};

/// Everything that coefficients say of themselves but their values. Coefficients, compressed
/// representations and texels carry one and hand it on as a whole.
struct CoefficientHead {
    std::string basis;
    int order = 0;
    bool condonShortley = false;
    Quantity quantity = Quantity::brdf;
    Channels channels;
    OutgoingSet outgoing;
    bool isotropic = false, bilateral = false, reciprocal = false;

    /// Energy in the inner product of the basis, summed over channels and, with their solid angles,
    /// over the outgoing directions (Eq. 15's denominator).
    Energy energy;
    /// Estimated relative error, the largest over the outgoing directions, of coefficients and of
    /// energy (refinement.h).
    double error = 0;

    std::string source;     ///< the specification that was projected
    std::string generator;  ///< "hshfit 0.1.0"
    double tolerance = 0;   ///< what the quadrature was asked for
    /// Present where samples were fitted and no quadrature was made.
    std::optional<LeastSquaresNote> leastSquares = {};

    std::size_t slots() const { return static_cast<std::size_t>(order) * order; }
};

/// Basis coefficients of one BRDF for a set of outgoing directions: what a coefficient file holds.
struct Coefficients : CoefficientHead {
    /// [outgoing][channel][slot]; slot l(l+1)+m, order^2 of them.
    std::vector<double> values = {};

    const double* at(std::size_t outgoingIndex, std::size_t channel) const {
        return values.data() + (outgoingIndex * channels.count() + channel) * slots();
    }
    double* at(std::size_t outgoingIndex, std::size_t channel) {
        return values.data() + (outgoingIndex * channels.count() + channel) * slots();
    }
};

/// The first `order` bands, at most `c.order`. Where the basis is nested, these are its
/// coefficients of that order.
Coefficients truncated(const Coefficients& c, int order);

}  // namespace hshfit::inline coefficients
