#include <hshfit/representation/constraints/constraints.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/representation/basis_matrix.h>
#include <hshfit/representation/change.h>

#include <fmt/format.h>

#include <cassert>
#include <cmath>
#include <functional>

namespace hshfit::inline representation::inline constraints {
namespace {

/// Share of the squared Laplacian that bending leaves.
constexpr double keptBending = 0.5;

/// A number that a window multiplies, with the bands that it belongs to.
struct BandedNumber {
    double* value;
    int l, k;       ///< k = 0 for kind outgoing
    double weight;  ///< in the squared norm
};

std::vector<BandedNumber> numbersOfOutgoing(Representation& representation) {
    StoredArray& array = representation.as<CoefficientArray>()->coefficients;
    const std::vector<double>& solidAngles = representation.head.outgoing.solidAngles;
    const std::size_t columns = array.columns(), channels = representation.head.channels.count();
    std::vector<BandedNumber> numbers;
    for (std::size_t i = 0; i < array.values.size(); ++i) {
        const int l = static_cast<int>(std::sqrt(representation.slots[i % columns] + 0.5));
        numbers.push_back({&array.values[i], l, 0, solidAngles[i / columns / channels]});
    }
    return numbers;
}

std::vector<BandedNumber> numbersOfMatrix(Representation& representation) {
    const CoefficientHead& head = representation.head;
    const auto basis = bases::make(head.basis, head.order, {.condonShortley = head.condonShortley});
    const std::vector<ProductTerm> terms = productTerms(*basis, symmetryOf(representation));
    StoredArray& array = representation.as<MatrixArray>()->matrix;
    std::vector<BandedNumber> numbers;
    for (std::size_t i = 0; i < array.values.size(); ++i) {
        const ProductTerm& term = terms[i % terms.size()];
        numbers.push_back({&array.values[i], term.l, term.k, 1});
    }
    return numbers;
}

double squared(double x) {
    return x * x;
}

/// The squared Laplacian that is left, over wi and over wo.
double bendingLeft(const std::vector<BandedNumber>& numbers, const std::vector<double>& factors) {
    double sum = 0;
    for (const BandedNumber& n : numbers) {
        const double laplacian = squared(n.l * (n.l + 1.0)) + squared(n.k * (n.k + 1.0));
        sum += n.weight * laplacian * squared(*n.value * factors[n.l] * factors[n.k]);
    }
    return sum;
}

/// By bisection on a logarithmic scale: what is left falls with lambda.
double bendingLambda(const std::vector<BandedNumber>& numbers, int order) {
    const auto left = [&](double lambda) {
        return bendingLeft(numbers, windowFactors(Window::bending, order, lambda));
    };
    const double target = keptBending * left(0);
    if (target == 0) return 0;
    double low = std::log(1e-15), high = std::log(1e3);
    for (int step = 0; step < 80; ++step) {
        const double middle = 0.5 * (low + high);
        (left(std::exp(middle)) > target ? low : high) = middle;
    }
    return std::exp(0.5 * (low + high));
}

}  // namespace

Representation windowed(Representation representation, Window window) {
    const bool outgoing = representation.as<CoefficientArray>() != nullptr;
    if (!outgoing && !representation.as<MatrixArray>()) {
        throw UsageError(
            "a window is for coefficients per outgoing direction or of both, not factored");
    }
    if (window == Window::none) return representation;
    const Representation before = representation;
    const std::vector<BandedNumber> numbers =
        outgoing ? numbersOfOutgoing(representation) : numbersOfMatrix(representation);
    const int order = representation.head.order;
    const double lambda = window == Window::bending ? bendingLambda(numbers, order) : 0;
    const std::vector<double> factors = windowFactors(window, order, lambda);
    for (const BandedNumber& n : numbers) *n.value *= factors[n.l] * factors[n.k];
    addStep(representation, before, fmt::format("window {}", windowName(window)));
    return representation;
}

}  // namespace hshfit::inline representation::inline constraints
