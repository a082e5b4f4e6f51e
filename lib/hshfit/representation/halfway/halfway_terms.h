#pragma once

#include <hshfit/representation/halfway/halfway_axes.h>
#include <hshfit/representation/representation.h>

#include <compare>
#include <cstddef>
#include <vector>

namespace hshfit::inline representation::inline halfway {

/// The symmetries that leave terms out.
struct HalfwaySymmetry {
    bool isotropic = false, bilateral = false, reciprocal = false;
};

/// One product function of the smooth exponent (`lobe` false) or of the lobe's, at a HalfwayPoint:
///     smooth: P = p_i(mean) p_j(v) p_k(product) gap^a handed^b H
///     lobe:   P = p_i(x)    p_j(v) x^m kappa^(2 k + a) handed^b H,  m = 1 if k + a > 0, else 0
/// a = 1 if `exchange`, b = 1 if `mirror`, H = 1 for q = 0, else sqrt(2) x cos(q phi), or with
/// `sine` sin(q phi); p_n(t) = sqrt(2 n + 1) P_n(2 t - 1) is orthonormal on [0, 1].
struct HalfwayTerm {
    bool lobe = false;
    int i = 0, j = 0, k = 0, q = 0;
    bool exchange = false, mirror = false, sine = false;

    /// n of the factor x kappa^n of a term of the lobe; 0: none.
    int power() const { return lobe ? 2 * k + exchange : 0; }
    auto operator<=>(const HalfwayTerm&) const = default;
};

/// A run of terms that differ in i only; i = 0 .. length - 1.
struct HalfwayRun {
    HalfwayTerm term;       ///< with i = 0
    std::size_t first = 0;  ///< into HalfwayTerms::position
    std::size_t length = 0;
};

/// The number of polynomials along each axis.
struct HalfwayCounts {
    int mean = 1, product = 1, v = 1, x = 1;
};

/// The terms of given orders (H, D, A) = (half, difference, azimuth). With Q = q, or q / 2 where
/// bilateral:
///     smooth: d = i + 2 k + 3 a + 2 b + 2 Q, those with d / A + j / ceil(D / 2) <= 6/5 and
///             j < ceil(D / 2)
///     lobe:   d = k + a + b + Q, those with i < H, j < D and i / H + j / D + 10 d / (3 A) <= 23/20
/// Sets of smaller orders are contained in sets of larger ones. Left out are: isotropic, q > 0;
/// isotropic and bilateral, b = 1; bilateral otherwise, odd q, and cosines with b = 1 and sines
/// with b = 0; reciprocal, a != b. Stored are the smooth terms, then the lobe's terms, each by
/// rising d + j (lobe: i + j + d), then j, k, i, q, exchange, mirror, sine.
class HalfwayTerms {
public:
    /// At most 65536 terms, each order from 1 to 256 (UsageError).
    HalfwayTerms(const HalfwayOrders& orders, const HalfwaySymmetry& symmetry);

    std::size_t size() const { return terms_.size(); }
    /// The number of smooth terms, which come first.
    std::size_t smooth() const { return smooth_; }
    const HalfwayOrders& orders() const { return orders_; }
    const HalfwayCounts& counts() const { return counts_; }
    const std::vector<HalfwayTerm>& list() const { return terms_; }
    /// The smooth exponent's runs first.
    const std::vector<HalfwayRun>& runs() const { return runs_; }
    /// The places in the list of the terms of the runs, one after another.
    const std::vector<std::size_t>& position() const { return position_; }
    int harmonics() const { return harmonics_; }  ///< the largest q

    /// [term] -> value at a point, in the order of the list.
    void evaluate(const HalfwayPoint& point, double* out) const;

private:
    HalfwayOrders orders_;
    HalfwayCounts counts_;
    std::vector<HalfwayTerm> terms_;
    std::size_t smooth_ = 0;
    std::vector<HalfwayRun> runs_;
    std::vector<std::size_t> position_;
    int harmonics_ = 0;
};

/// The orders asked for; where they are 0, the orders with the least picture error that keep three
/// channels in half precision within a kilobyte (docs/explanation/halfway.md): an isotropic
/// reciprocal BRDF takes 9,13,5, since its ridge wants functions along v, other isotropic ones
/// 9,8,6, and an anisotropic one 8,8,6.
HalfwayOrders halfwayOrdersOr(const HalfwayOrders& asked, bool isotropic, bool reciprocal);

/// The symmetries that the head of a representation of kind halfway states.
HalfwaySymmetry halfwaySymmetryOf(const CoefficientHead& head);

}  // namespace hshfit::inline representation::inline halfway
