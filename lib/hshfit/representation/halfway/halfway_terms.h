#pragma once

#include <hshfit/brdf/directions.h>
#include <hshfit/representation/representation.h>

#include <cstddef>
#include <vector>

namespace hshfit::inline representation::inline halfway {

/// The symmetries that leave terms out.
struct HalfwaySymmetry {
    bool isotropic = false, bilateral = false, reciprocal = false;
};

/// The place of a pair on the axes of the halfway form. With h = (wi + wo) / |wi + wo| and
/// mu = cos(theta):
///     u     = (1 - cos(theta_h))^(1/4): lobes about the normal are spread out
///     v     = cos(theta_d)
///     w     = (4 mu_i mu_o / (mu_i + mu_o)^2)^(1/4): 1 at equal elevations, 0 at the horizon
///     tau   = (mu_o - mu_i) / (mu_o + mu_i), changes sign when wi and wo are exchanged
///     kappa = z of wi x wo, changes sign then, and when both are mirrored at a plane
/// and the azimuth of h. No angle is formed, and all are smooth or continuous in both directions
/// over the whole domain mu_i, mu_o > 0, at the poles of h and of the difference vector too.
struct HalfwayPoint {
    double u, v, w, tau, kappa, cosine, sine;
};
HalfwayPoint halfwayPoint(const Direction& wi, const Direction& wo);

/// One product function:
///     P = p_i(u) p_j(v) p_k(w) tau^a kappa^b H,
/// a = 1 if `exchange`, b = 1 if `mirror`, H = 1 for q = 0, else sqrt(2) u^2 cos(q phi_h), or with
/// `sine` sin(q phi_h); p_n(x) = sqrt(2 n + 1) P_n(2 x - 1) is orthonormal on [0, 1].
struct HalfwayTerm {
    int i = 0, j = 0, k = 0, q = 0;
    bool exchange = false, mirror = false, sine = false;
};

/// A run of terms that differ in i only; i = 0 .. length - 1.
struct HalfwayRun {
    HalfwayTerm term;       ///< with i = 0
    std::size_t first = 0;  ///< into HalfwayTerms::position
    std::size_t length = 0;
};

/// The terms of given orders (H, D, A) = (half, difference, azimuth): with
///     d = k + a + b + q    (bilateral: q / 2 in place of q),
/// those with i < H, j < D, d < A and i/H + j/D + d/A <= 1.4. Sets of smaller orders are contained
/// in those of larger ones. Left out are: isotropic, q > 0; isotropic and bilateral, b = 1;
/// bilateral otherwise, odd q, and cosines with b = 1 and sines with b = 0; reciprocal, a != b.
/// Stored by rising i + j + d, then d, j, i, q, exchange, mirror, sine.
class HalfwayTerms {
public:
    /// At most 65536 terms, each order from 1 to 256 (UsageError).
    HalfwayTerms(const HalfwayOrders& orders, const HalfwaySymmetry& symmetry);

    std::size_t size() const { return terms_.size(); }
    const HalfwayOrders& orders() const { return orders_; }
    const std::vector<HalfwayTerm>& list() const { return terms_; }
    const std::vector<HalfwayRun>& runs() const { return runs_; }
    /// Where the terms of the runs, one after another, are in the list.
    const std::vector<std::size_t>& position() const { return position_; }
    int harmonics() const { return harmonics_; }  ///< the largest q

    /// [term] -> value at a point, in the order of the list.
    void evaluate(const HalfwayPoint& point, double* out) const;

private:
    HalfwayOrders orders_;
    std::vector<HalfwayTerm> terms_;
    std::vector<HalfwayRun> runs_;
    std::vector<std::size_t> position_;
    int harmonics_ = 0;
};

/// The symmetries that the head of a representation of kind halfway states.
HalfwaySymmetry halfwaySymmetryOf(const CoefficientHead& head);

}  // namespace hshfit::inline representation::inline halfway
