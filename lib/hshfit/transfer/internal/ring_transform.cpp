#include <hshfit/transfer/internal/ring_transform.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/quadrature/quadrature.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

namespace hshfit::inline transfer {

void requireOrthonormal(const Basis& basis) {
    if (bases::find(basis.name()).orthonormal) return;
    throw UsageError(fmt::format(
        "the functions of basis '{}' are not orthonormal; products take an orthonormal basis",
        basis.name()));
}

RingGrid RingGrid::exactFor(const Basis& basis, int degree, int harmonics) {
    RingGrid grid;
    grid.azimuths = static_cast<std::size_t>(harmonics) + 1;
    const bool projected = basis.inner() == Basis::Inner::projectedSolidAngle;
    if (basis.name() == "sh") {
        const GaussRule& rule = gaussLegendre(degree / 2 + 1);
        const std::size_t count = rule.nodes.size();
        for (std::size_t k = 0; k < count; ++k) {
            grid.elevations.push_back({rule.nodes[k], 1 + rule.nodes[count - 1 - k]});
            grid.weights.push_back(rule.weights[k]);
        }
        return grid;
    }
    // In u = sqrt(mu): twice the degree, the root factors of at most four makhotkin functions (of
    // degree 4), d mu = 2 u d u, and mu of the inner product.
    const GaussRule& rule = gaussLegendre(degree + 4);
    for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
        const double u = 0.5 * (1 + rule.nodes[k]);
        const double rest = 0.5 * (1 + rule.nodes[rule.nodes.size() - 1 - k]);
        grid.elevations.push_back({u * u, rest * (1 + u)});
        grid.weights.push_back(rule.weights[k] * u * (projected ? u * u : 1));
    }
    return grid;
}

RingTransform::RingTransform(const Basis& basis, const RingGrid& grid)
    : order_(basis.order()), grid_(grid), width_(static_cast<std::size_t>(2 * order_ - 1)) {
    for (int m = 0; m < order_; ++m) {
        std::vector<double>& rows =
            theta_.emplace_back(grid.elevations.size() * static_cast<std::size_t>(order_ - m));
        basis.theta(m, grid.elevations, rows.data());
        const double sign = azimuthSign(m, basis.condonShortley());
        for (double& value : rows) value *= sign;
    }
    azimuths_.resize(grid.azimuths * width_);
    for (std::size_t j = 0; j < grid.azimuths; ++j) {
        const double phi = 2 * pi * static_cast<double>(j) / static_cast<double>(grid.azimuths);
        azimuthParts(directionFromAngles(0.5 * pi, phi), order_, false,
                     azimuths_.data() + j * width_);
    }
}

void RingTransform::ringParts(const double* c, double* out) const {
    const std::size_t rings = grid_.elevations.size();
    std::fill(out, out + rings * width_, 0.0);
    for (int m = 1 - order_; m < order_; ++m) {
        const int least = std::abs(m);
        const double* row = theta(least).data();
        double* to = out + (order_ - 1 + m);
        for (int l = least; l < order_; ++l, row += rings) {
            const double value = c[slotOf(l, m)];
            for (std::size_t r = 0; r < rings; ++r) to[r * width_] += value * row[r];
        }
    }
}

void RingTransform::synthesise(const double* c, double* values) const {
    const std::size_t rings = grid_.elevations.size();
    std::vector<double> parts(rings * width_);
    ringParts(c, parts.data());
    for (std::size_t r = 0; r < rings; ++r) {
        for (std::size_t j = 0; j < grid_.azimuths; ++j) {
            const double* azimuth = azimuths_.data() + j * width_;
            const double* part = parts.data() + r * width_;
            double sum = 0;
            for (std::size_t k = 0; k < width_; ++k) sum += part[k] * azimuth[k];
            values[r * grid_.azimuths + j] = sum;
        }
    }
}

void RingTransform::analyse(const double* values, double* moments) const {
    const std::size_t rings = grid_.elevations.size();
    std::vector<double> parts(rings * width_, 0.0);
    for (std::size_t r = 0; r < rings; ++r) {
        double* part = parts.data() + r * width_;
        for (std::size_t j = 0; j < grid_.azimuths; ++j) {
            const double value = values[r * grid_.azimuths + j] * grid_.weight(r);
            const double* azimuth = azimuths_.data() + j * width_;
            for (std::size_t k = 0; k < width_; ++k) part[k] += value * azimuth[k];
        }
    }
    for (int m = 1 - order_; m < order_; ++m) {
        const int least = std::abs(m);
        const double* row = theta(least).data();
        const double* part = parts.data() + (order_ - 1 + m);
        for (int l = least; l < order_; ++l, row += rings) {
            double sum = 0;
            for (std::size_t r = 0; r < rings; ++r) sum += row[r] * part[r * width_];
            moments[slotOf(l, m)] = sum;
        }
    }
}

double azimuthProduct(int m1, int m2, int m3) {
    std::array<int, 3> m{m1, m2, m3};
    std::sort(m.begin(), m.end(), [](int a, int b) { return std::abs(a) < std::abs(b); });
    const int negative = (m1 < 0) + (m2 < 0) + (m3 < 0);
    if (negative % 2 != 0 || std::abs(m[2]) != std::abs(m[0]) + std::abs(m[1])) return 0;
    if (m[0] == 0) return 1 / std::sqrt(2 * pi);
    // sin a sin b has the part -cos(a + b) / 2, all the others are positive.
    const double sign = m[0] < 0 && m[1] < 0 ? -1 : 1;
    return sign / (2 * std::sqrt(pi));
}

}  // namespace hshfit::inline transfer
