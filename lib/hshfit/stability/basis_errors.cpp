#include <hshfit/stability/basis_errors.h>

#include <hshfit/bases/jacobi.h>
#include <hshfit/error.h>
#include <hshfit/quadrature/quadrature.h>
#include <hshfit/stability/internal/reference.h>

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

namespace hshfit::stability {
namespace {

/// Angles from either end of [0, pi/2]: decades down to 1e-12, then equal steps.
std::vector<Direction> probes() {
    std::vector<double> distances = {0};
    for (int e = -12; e < -1; ++e)
        for (double digit : {1.0, 2.0, 5.0}) distances.push_back(digit * std::pow(10.0, e));
    std::vector<Direction> directions;
    for (double d : distances) {
        directions.push_back({std::sin(d), 0, std::cos(d)});
        if (d > 0) directions.push_back({std::cos(d), 0, std::sin(d)});
    }
    constexpr int steps = 257;
    for (int k = 1; k < steps; ++k)
        directions.push_back(directionFromAngles(0.5 * pi * k / steps, 0));
    return directions;
}

template <class Real>
std::vector<Elevation<Real>> elevationsOf(const std::vector<Direction>& directions) {
    std::vector<Elevation<Real>> points;
    for (const Direction& d : directions) {
        const Elevation<double> e = elevationOf(d);
        points.push_back({static_cast<Real>(e.mu), static_cast<Real>(e.oneMinusMu)});
    }
    return points;
}

void keepLarger(double& largest, double value) {
    if (!(largest >= value)) largest = value;
}

/// Errors of one m, by degree.
template <class Real>
std::vector<double> errorsAt(const bases::JacobiBasis& basis, int m,
                             const std::vector<Direction>& directions) {
    const auto points = elevationsOf<Real>(directions);
    const std::size_t count = points.size(), order = static_cast<std::size_t>(basis.order());
    std::vector<Real> values((order - m) * count);
    basis.theta(m, points, values.data());
    const std::vector<long double> reference =
        referenceTheta(basis.family(), m, basis.order(), directions);
    constexpr double tiny = std::is_same_v<Real, float> ? 1e-30 : 1e-250;
    std::vector<double> errors(order, unmeasured);
    for (std::size_t l = m; l < order; ++l) {
        if (!basis.has(static_cast<int>(l), m)) continue;
        long double largest = 0, difference = 0;
        for (std::size_t p = 0; p < count; ++p) {
            const std::size_t at = (l - m) * count + p;
            largest = std::max(largest, std::abs(reference[at]));
            const long double off = std::abs(static_cast<long double>(values[at]) - reference[at]);
            difference = off <= difference ? difference : off;  // NaN stays
        }
        if (largest > tiny) errors[l] = static_cast<double>(difference / largest);
    }
    return errors;
}

/// Deviations of one m from orthonormality, by degree.
template <class Real>
std::vector<double> deviationsAt(const bases::JacobiBasis& basis, int m) {
    const bool sphere = basis.family().argument == bases::JacobiFamily::Argument::cosine &&
                        !basis.family().evenOnly;
    const GaussRule& rule = gaussLegendre(basis.order() + 2);
    const auto count = static_cast<Eigen::Index>(rule.nodes.size());
    std::vector<Elevation<Real>> points;
    Eigen::VectorXd weights(count);
    for (Eigen::Index p = 0; p < count; ++p) {
        const double x = rule.nodes[static_cast<std::size_t>(p)];
        const double mu = sphere ? x : 0.5 * (1 + x), rest = sphere ? 1 - x : 0.5 * (1 - x);
        points.push_back({static_cast<Real>(mu), static_cast<Real>(rest)});
        weights(p) = rule.weights[static_cast<std::size_t>(p)] * (sphere ? 1 : 0.5);
        if (basis.inner() == Basis::Inner::projectedSolidAngle) weights(p) *= mu;
    }
    const Eigen::Index functions = basis.order() - m;
    std::vector<Real> values(static_cast<std::size_t>(functions * count));
    basis.theta(m, points, values.data());
    const Eigen::MatrixXd t = Eigen::Map<const Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>>(
                                  values.data(), count, functions)
                                  .template cast<double>();
    const Eigen::MatrixXd gram = t.transpose() * weights.asDiagonal() * t;
    std::vector<double> deviations(static_cast<std::size_t>(basis.order()), unmeasured);
    for (Eigen::Index l = 0; l < functions; ++l) {
        if (!basis.has(static_cast<int>(l) + m, m)) continue;
        double& largest = deviations[static_cast<std::size_t>(l + m)];
        for (Eigen::Index k = 0; k <= l; ++k)
            keepLarger(largest, std::abs(gram(l, k) - (l == k ? 1.0 : 0.0)));
    }
    return deviations;
}

template <class PerOrder>
DegreeErrors largestOverOrders(const bases::JacobiBasis& basis, Precision precision,
                               const PerOrder& perOrder) {
    const std::vector<int> orders = sampledOrders(basis.order());
    std::vector<std::vector<double>> each(orders.size());
    tbb::parallel_for(std::size_t{0}, orders.size(),
                      [&](std::size_t k) { each[k] = perOrder(orders[k]); });
    DegreeErrors result{basis.name(), precision,
                        std::vector<double>(static_cast<std::size_t>(basis.order()), unmeasured)};
    for (const auto& errors : each) {
        for (std::size_t l = 0; l < errors.size(); ++l)
            if (!std::isnan(errors[l])) keepLarger(result.error[l], errors[l]);
    }
    return result;
}

}  // namespace

std::string precisionName(Precision precision) {
    return precision == Precision::single ? "float" : "double";
}

int DegreeErrors::goodUntil(double bound) const {
    const auto bad = std::find_if(error.begin(), error.end(), [&](double e) { return e > bound; });
    return static_cast<int>(bad - error.begin()) - 1;
}

std::vector<int> sampledOrders(int order) {
    std::vector<int> orders = {0};
    for (int decade = 1; decade < order; decade *= 10)
        for (int digit : {1, 2, 5}) orders.push_back(digit * decade);
    orders.insert(orders.end(), {order - 2, order - 1});
    std::erase_if(orders, [&](int m) { return m < 0 || m >= order; });
    std::sort(orders.begin(), orders.end());
    orders.erase(std::unique(orders.begin(), orders.end()), orders.end());
    return orders;
}

DegreeErrors evaluationErrors(const bases::JacobiBasis& basis, Precision precision) {
    const std::vector<Direction> directions = probes();
    return largestOverOrders(basis, precision, [&](int m) {
        return precision == Precision::single ? errorsAt<float>(basis, m, directions)
                                              : errorsAt<double>(basis, m, directions);
    });
}

DegreeErrors orthonormalityErrors(const bases::JacobiBasis& basis, Precision precision) {
    return largestOverOrders(basis, precision, [&](int m) {
        return precision == Precision::single ? deviationsAt<float>(basis, m)
                                              : deviationsAt<double>(basis, m);
    });
}

}  // namespace hshfit::stability
