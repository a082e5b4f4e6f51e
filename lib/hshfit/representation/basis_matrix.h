#pragma once

#include <hshfit/projection.h>
#include <hshfit/representation/representation.h>

#include <vector>

namespace hshfit {

/// One orthonormal product function of both directions, with B the basis functions:
///     P = s [ A(wi) B(wo) ± … ] over the symmetries that hold, s making its norm 1 over both
/// hemispheres in the basis' inner product. In full, (l, m) belongs to wi and (k, p) to wo:
///     anisotropic   B_{l,m}(wi) B_{k,p}(wo)
///     isotropic     p = m >= 0: [B_{l,m} B_{k,m} + B_{l,-m} B_{k,-m}] / sqrt 2 (m > 0), or with
///                   `sine`: [B_{l,m} B_{k,-m} - B_{l,-m} B_{k,m}] / sqrt 2
///     reciprocal    the above plus (sine: minus) itself with wi and wo exchanged, over sqrt 2
///                   unless they are the same; one of each such pair of terms is listed
struct ProductTerm {
    int l = 0, m = 0, k = 0, p = 0;
    bool sine = false;
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

/// [term] -> value of every product function at one pair, from the basis values at wi and wo
/// (Basis::evaluate).
void evaluateProducts(const std::vector<ProductTerm>& terms, const ProductSymmetry& symmetry,
                      const double* atWi, const double* atWo, double* out);

/// Projects q over both hemispheres:
///     c_t = integral integral q(wi, wo) P_t(wi, wo) d omega_i d omega_o
/// (cos-weighted on both sides for a basis of Inner::projectedSolidAngle). Over wi by `project`;
/// over wo by Gauss-Legendre nodes in sqrt(cos theta_o) times equispaced azimuths, refined until
/// the coefficients agree to the tolerance. `reciprocal` asks for the symmetric half only and, if q
/// itself is not symmetric, projects the mean of q(wi, wo) and q(wo, wi); quantity brdf only
/// (UsageError). Head's energy is that of q over both hemispheres.
Representation projectBoth(const Brdf& brdf, const Basis& basis, bool reciprocal,
                           const ProjectionOptions& options = {});

/// Coefficients of `order` bands from those of more.
Representation truncated(const Representation& matrix, int order);

}  // namespace hshfit
