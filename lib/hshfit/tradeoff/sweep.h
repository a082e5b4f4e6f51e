#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/representation/forms/form.h>

#include <string>
#include <vector>

namespace hshfit::tradeoff {

/// A constraint on the coefficients (constraints.h).
enum class Constraint { none, nonNegative, energyPreserving, both };
/// "none", "non-negative", "energy-preserving" or "both". Throws UsageError with the four.
Constraint parseConstraint(std::string_view name);

/// The combinations to try. The defaults make about 500 forms of an isotropic BRDF.
struct Sweep {
    std::vector<Representation::Kind> kinds = {
        Representation::Kind::outgoing, Representation::Kind::basis, Representation::Kind::halfway};
    std::vector<std::string> bases = {"hsh", "zernike", "makhotkin"};
    std::vector<int> orders = {3, 5, 7, 10};
    /// For the kind outgoing. Empty: 8, 16 and 32 elevations if isotropic, else 8x8 and 16x16.
    std::vector<std::string> outgoing = {};
    /// For the kind halfway, numbers of functions as `project --halfway` takes them; 0: its
    /// default.
    std::vector<HalfwayOrders> halfway = {{5, 4, 3}, {7, 6, 5}, {}, {13, 12, 8}};
    std::vector<int> ranks = {0, 2, 4};  ///< 0: not factored
    std::vector<Precision> precisions = {Precision::float32, Precision::half, Precision::unorm16,
                                         Precision::unorm8};
    std::vector<std::size_t> keep = {0};     ///< 0: all numbers
    std::vector<std::string> splits = {""};  ///< "diffuse", or a BRDF to take out
    std::vector<Window> windows = {Window::none};
    std::vector<Constraint> constraints = {Constraint::none};
    Quantity quantity = Quantity::brdf;
    /// Try the symmetric half of the kinds basis and halfway as well as the whole, for measured
    /// BRDFs that are reciprocal up to their noise too. Of a reciprocal one, halfway has no other.
    bool reciprocal = true;
};

/// The outgoing sets of a sweep: its own, or its default for this BRDF.
std::vector<std::string> outgoingSets(const Sweep& sweep, const Brdf& brdf);

/// Every combination that `requireConsistent` accepts, none twice: what a kind does not have does
/// not multiply it. Ranks that cannot make less of a form, and the reciprocal half of f
/// cos(theta_i), are left out. The lists give the order.
std::vector<Form> formsOf(const Sweep& sweep, const Brdf& brdf);

}  // namespace hshfit::tradeoff
