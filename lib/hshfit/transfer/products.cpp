#include <hshfit/transfer/products.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/transfer/internal/ring_transform.h>

#include <fmt/format.h>

#include <Eigen/Core>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>

namespace hshfit::inline transfer {
namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

void requireFamily(const Basis& one, const Basis& other) {
    requireOrthonormal(one);
    if (one.name() == other.name()) return;
    throw UsageError(
        fmt::format("a product of coefficients of '{}' and '{}'; both have to be in "
                    "one basis",
                    one.name(), other.name()));
}

void requireSize(const Basis& basis, std::span<const double> c) {
    if (c.size() == static_cast<std::size_t>(basis.slots())) return;
    throw UsageError(fmt::format("{} coefficients in a basis of order {}; it has {} slots",
                                 c.size(), basis.order(), basis.slots()));
}

}  // namespace

std::vector<double> transferMatrix(const Basis& basis, const Basis& factorBasis,
                                   std::span<const double> factor) {
    requireFamily(basis, factorBasis);
    requireSize(factorBasis, factor);
    const int order = basis.order(), factorOrder = factorBasis.order();
    const RingGrid grid = RingGrid::exactFor(
        basis, 2 * bases::highestDegree(basis) + bases::highestDegree(factorBasis), 0);
    const RingTransform rows(basis, grid), parts(factorBasis, grid);
    const std::size_t rings = grid.elevations.size();
    const auto width = static_cast<std::size_t>(2 * factorOrder - 1);
    std::vector<double> azimuthal(rings * width);
    parts.ringParts(factor.data(), azimuthal.data());

    const auto slots = static_cast<std::size_t>(basis.slots());
    std::vector<double> matrix(slots * slots, 0.0);
    Eigen::VectorXd weights(static_cast<Eigen::Index>(rings));
    const auto thetaOf = [&](int m) {
        return Eigen::Map<const Matrix>(rows.theta(m).data(), order - m,
                                        static_cast<Eigen::Index>(rings));
    };
    for (int m1 = 1 - order; m1 < order; ++m1) {
        for (int m2 = m1; m2 < order; ++m2) {
            // f takes part by the m that are the sum and the difference of these.
            const int sum = std::abs(m1) + std::abs(m2);
            const int difference = std::abs(std::abs(m1) - std::abs(m2));
            const int sign = (m1 < 0) != (m2 < 0) ? -1 : 1;
            weights.setZero();
            bool present = false;
            for (const int m : {sum, difference}) {
                const double product = azimuthProduct(m1, m2, sign * m);
                if (m >= factorOrder || product == 0) continue;
                if (m == difference && difference == sum && present) continue;
                present = true;
                const double* part = azimuthal.data() + (factorOrder - 1 + sign * m);
                for (std::size_t r = 0; r < rings; ++r) {
                    weights(static_cast<Eigen::Index>(r)) +=
                        product * grid.weights[r] * part[r * width];
                }
            }
            if (!present) continue;
            const Matrix block =
                thetaOf(std::abs(m1)) * weights.asDiagonal() * thetaOf(std::abs(m2)).transpose();
            for (int l1 = std::abs(m1); l1 < order; ++l1) {
                for (int l2 = std::abs(m2); l2 < order; ++l2) {
                    const auto i = static_cast<std::size_t>(slotOf(l1, m1));
                    const auto j = static_cast<std::size_t>(slotOf(l2, m2));
                    const double value = block(l1 - std::abs(m1), l2 - std::abs(m2));
                    matrix[i * slots + j] = matrix[j * slots + i] = value;
                }
            }
        }
    }
    return matrix;
}

Multiplied multiplied(const Basis& result, const Basis& first, std::span<const double> a,
                      const Basis& second, std::span<const double> b) {
    requireFamily(result, first);
    requireFamily(result, second);
    requireSize(first, a);
    requireSize(second, b);
    // Degrees and harmonics of (a b) B, and of (a b)^2.
    const int degree = bases::highestDegree(first) + bases::highestDegree(second);
    const int harmonics = first.order() + second.order() - 2;
    const RingGrid grid =
        RingGrid::exactFor(result, std::max(degree + bases::highestDegree(result), 2 * degree),
                           std::max(harmonics + result.order() - 1, 2 * harmonics));
    std::vector<double> values(grid.points()), other(grid.points());
    RingTransform(first, grid).synthesise(a.data(), values.data());
    RingTransform(second, grid).synthesise(b.data(), other.data());
    Multiplied product;
    for (std::size_t k = 0; k < values.size(); ++k) {
        values[k] *= other[k];
        product.energy += grid.weight(k / grid.azimuths) * values[k] * values[k];
    }
    product.coefficients.resize(static_cast<std::size_t>(result.slots()));
    const RingTransform transform(result, grid);
    transform.analyse(values.data(), product.coefficients.data());
    // The rest is summed point by point: the difference of two energies would lose half of the
    // digits.
    transform.synthesise(product.coefficients.data(), other.data());
    double left = 0;
    for (std::size_t k = 0; k < values.size(); ++k) {
        const double rest = values[k] - other[k];
        left += grid.weight(k / grid.azimuths) * rest * rest;
    }
    product.truncation = product.energy > 0 ? std::sqrt(left / product.energy) : 0;
    return product;
}

}  // namespace hshfit::inline transfer
