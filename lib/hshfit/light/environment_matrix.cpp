#include <hshfit/light/environment_matrix.h>

#include <hshfit/bases/sh.h>
#include <hshfit/quadrature/quadrature.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace hshfit::inline light {
namespace {

constexpr double smallestElement = 1e-9;

struct Nodes {
    std::vector<Elevation<double>> elevations;
    std::vector<double> weights;  ///< of d mu
};

/// In u = sqrt(mu). The integrand has degree 2 (bands) + 3 at most, besides (1 + u^2)^{m/2}, whose
/// branch points at +-i cost 25 more nodes at double precision.
Nodes nodesFor(int bands, Quantity quantity) {
    const GaussRule& rule = gaussLegendre(bands + 40);
    Nodes nodes;
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
        const double u = 0.5 * (1 + rule.nodes[i]), mu = u * u;
        nodes.elevations.push_back({mu, (1 - u) * (1 + u)});
        const double cosine = quantity == Quantity::brdf ? mu : 1;
        nodes.weights.push_back(rule.weights[i] * u * cosine);
    }
    return nodes;
}

}  // namespace

std::vector<EnvironmentElement> environmentMatrix(const Basis& basis, int environmentOrder,
                                                  Quantity quantity) {
    const auto harmonics = bases::makeSh(environmentOrder, {});
    const Nodes nodes = nodesFor(basis.order() + environmentOrder, quantity);
    const std::size_t count = nodes.elevations.size();
    std::vector<double> rows(static_cast<std::size_t>(basis.order()) * count);
    std::vector<double> columns(static_cast<std::size_t>(environmentOrder) * count);
    std::vector<EnvironmentElement> elements;
    for (int m = 0; m < std::min(basis.order(), environmentOrder); ++m) {
        basis.theta(m, nodes.elevations, rows.data());
        harmonics->theta(m, nodes.elevations, columns.data());
        for (int l = m; l < basis.order(); ++l) {
            for (int j = m; j < environmentOrder; ++j) {
                const double* b = rows.data() + static_cast<std::size_t>(l - m) * count;
                const double* y = columns.data() + static_cast<std::size_t>(j - m) * count;
                double sum = 0;
                for (std::size_t i = 0; i < count; ++i) sum += nodes.weights[i] * b[i] * y[i];
                if (std::abs(sum) < smallestElement) continue;
                elements.push_back({slotOf(l, m), slotOf(j, m), sum});
                if (m > 0) elements.push_back({slotOf(l, -m), slotOf(j, -m), sum});
            }
        }
    }
    std::sort(elements.begin(), elements.end(), [](const auto& a, const auto& b) {
        return a.slot != b.slot ? a.slot < b.slot : a.environment < b.environment;
    });
    return elements;
}

}  // namespace hshfit::inline light
