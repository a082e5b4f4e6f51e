#include <hshfit/stability/internal/basis_change_errors.h>

#include <hshfit/bases/jacobi.h>
#include <hshfit/quadrature/quadrature.h>
#include <hshfit/rotation/basis_change.h>
#include <hshfit/stability/internal/reference.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <random>

namespace hshfit::stability {
namespace {

/// Directions and weights of d mu, by nodes in sqrt(mu).
struct Nodes {
    std::vector<Direction> directions;
    std::vector<long double> weights;
};

Nodes nodesFor(int order, Basis::Inner inner) {
    Nodes nodes;
    const GaussRule& rule = gaussLegendre(2 * order + 49);
    for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
        const double u = (1 + rule.nodes[k]) / 2, mu = u * u;
        nodes.directions.push_back({std::sqrt((1 - u) * (1 + u) * (1 + mu)), 0, mu});
        long double weight = static_cast<long double>(rule.weights[k]) * u;
        if (inner == Basis::Inner::projectedSolidAngle) weight *= mu;
        nodes.weights.push_back(weight);
    }
    return nodes;
}

std::vector<double> unitVector(std::size_t count) {
    std::mt19937_64 random(1);
    std::vector<double> values(count);
    double norm = 0;
    for (double& value : values) {
        value = static_cast<double>(random() >> 11) * 0x1p-52 - 1;
        norm += value * value;
    }
    for (double& value : values) value /= std::sqrt(norm);
    return values;
}

template <class Real>
std::vector<double> product(const std::vector<double>& matrix, const std::vector<double>& c) {
    std::vector<double> result(matrix.size() / c.size());
    for (std::size_t i = 0; i < result.size(); ++i) {
        Real sum = 0;
        for (std::size_t j = 0; j < c.size(); ++j)
            sum += static_cast<Real>(matrix[i * c.size() + j]) * static_cast<Real>(c[j]);
        result[i] = static_cast<double>(sum);
    }
    return result;
}

}  // namespace

DegreeErrors basisChangeErrors(const bases::JacobiBasis& from, const bases::JacobiBasis& to,
                               Precision precision) {
    assert(from.order() == to.order());
    const int order = from.order();
    const BasisChange change(from, to);
    const Nodes nodes = nodesFor(order, to.inner());
    const std::vector<int> orders = sampledOrders(order);
    std::vector<std::vector<double>> errors(orders.size());
    tbb::parallel_for(std::size_t{0}, orders.size(), [&](std::size_t k) {
        const int m = orders[k];
        std::vector<double> c = unitVector(static_cast<std::size_t>(order - m));
        for (int l = m; l < order; ++l)
            if (!from.has(l, m)) c[static_cast<std::size_t>(l - m)] = 0;
        const std::vector<double> block = change.block(m);
        const std::vector<double> result =
            precision == Precision::single ? product<float>(block, c) : product<double>(block, c);
        const auto fromValues = referenceTheta(from.family(), m, order, nodes.directions);
        const auto toValues = referenceTheta(to.family(), m, order, nodes.directions);
        const std::size_t count = nodes.weights.size();
        std::vector<long double> function(count, 0);
        for (std::size_t j = 0; j < c.size(); ++j)
            for (std::size_t p = 0; p < count; ++p) function[p] += c[j] * fromValues[j * count + p];
        for (std::size_t p = 0; p < count; ++p) function[p] *= nodes.weights[p];
        for (std::size_t i = 0; i < c.size(); ++i) {
            long double sum = 0;
            for (std::size_t p = 0; p < count; ++p) sum += function[p] * toValues[i * count + p];
            errors[k].push_back(static_cast<double>(std::abs(sum - result[i])));
        }
    });
    DegreeErrors result{from.name() + " to " + to.name(), precision,
                        std::vector<double>(static_cast<std::size_t>(order), 0.0)};
    for (std::size_t k = 0; k < orders.size(); ++k)
        for (std::size_t i = 0; i < errors[k].size(); ++i) {
            double& largest = result.error[static_cast<std::size_t>(orders[k]) + i];
            largest = std::max(largest, errors[k][i]);
        }
    return result;
}

}  // namespace hshfit::stability
