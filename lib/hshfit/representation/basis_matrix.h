#pragma once

#include <hshfit/projection/projection.h>
#include <hshfit/representation/representation.h>

#include <vector>

namespace hshfit::inline representation {

/// One orthonormal product function of both directions, with B the basis functions:
/// of norm 1 over both hemispheres in the basis' inner product, (l, m) for wi and (k, p) for wo:
///     anisotropic   B_{l,m}(wi) B_{k,p}(wo)
///     isotropic     p = m >= 0: [B_{l,m} B_{k,m} + B_{l,-m} B_{k,-m}] / sqrt 2 (m > 0), or with
///                   `sine`: [B_{l,m} B_{k,-m} - B_{l,-m} B_{k,m}] / sqrt 2
///     reciprocal    the above plus itself with wi and wo exchanged, over sqrt 2 (over 2 where both
///                   are the same); one of each pair of terms is listed, and none that would be 0
/// Bilateral leaves out `sine` where isotropic; otherwise it asks that m and p be both cosines or
/// both sines, and m + p even.
struct ProductTerm {
    int l = 0, m = 0, k = 0, p = 0;
    bool sine = false;

    friend bool operator==(const ProductTerm&, const ProductTerm&) = default;
};

/// The symmetries that leave terms out.
struct ProductSymmetry {
    bool isotropic = false, bilateral = false, reciprocal = false;
};

/// The terms of both directions in one basis, in the order in which coefficients are stored: by
/// rising max(l, k), so that the terms of a lower order are a prefix, then by k, l, m, p, sine.
/// Functions that the basis lacks are left out. Counts for Zernike, isotropic, bilateral and
/// reciprocal, N = order - 1 = 0 .. 12: 1 2 5 8 14 20 30 40 55 70 91 112 140.
std::vector<ProductTerm> productTerms(const Basis& basis, const ProductSymmetry& symmetry);

/// The number of terms, without listing them.
std::size_t productTermCount(const Basis& basis, const ProductSymmetry& symmetry);

/// [term] -> value of every product function at one pair, from the basis values at wi and wo
/// (Basis::evaluate).
void evaluateProducts(const std::vector<ProductTerm>& terms, const ProductSymmetry& symmetry,
                      const double* atWi, const double* atWo, double* out);

/// Adds to out[slot] the coefficients over wi that `values`, one per term, have at one wo.
void contractWithOutgoing(const std::vector<ProductTerm>& terms, const ProductSymmetry& symmetry,
                          const double* values, const double* atWo, double* out);

/// [channel][term], multiplied out where factored.
std::vector<double> matrixValues(const Representation& matrix);

/// Projects q over both hemispheres:
///     c_t = integral integral q(wi, wo) P_t(wi, wo) d omega_i d omega_o
/// (cos-weighted on both sides for a basis of Inner::projectedSolidAngle). Over wi by `project`;
/// over wo by Gauss-Legendre nodes in sqrt(cos theta_o) times equispaced azimuths, refined until
/// the coefficients agree to the tolerance (default: the larger of 1e-4 and the BRDF's own).
/// `reciprocal` asks for the symmetric half only, which is the projection of the mean of q(wi, wo)
/// and q(wo, wi); quantity brdf only. The head's energy is the energy of q over both hemispheres,
/// and its `reciprocal` says whether the terms are the symmetric ones.
///
/// Throws UsageError for a basis that is not orthonormal, or f cos(theta_i) with `reciprocal`;
/// NumericError where the coefficients do not exist or do not converge.
Representation projectBoth(const Brdf& brdf, const Basis& basis, bool reciprocal,
                           const ProjectionOptions& options = {});

/// The symmetries whose terms a matrix has.
ProductSymmetry symmetryOf(const Representation& matrix);

/// The prefix of the coefficients that `order` bands have. Throws UsageError for a basis whose
/// functions depend on the order, or a factored matrix.
Representation truncated(const Representation& matrix, int order);

}  // namespace hshfit::inline representation
