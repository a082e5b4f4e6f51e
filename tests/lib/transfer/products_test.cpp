#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/transfer/products.h>
#include <hshfit/transfer/triple_products.h>

#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "quadrature_rules.h"

namespace hshfit {
namespace {

std::vector<double> randomVector(const Basis& basis, unsigned seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    std::vector<double> c(static_cast<std::size_t>(basis.slots()), 0.0);
    for (int l = 0; l < basis.order(); ++l) {
        for (int m = -l; m <= l; ++m) {
            if (basis.has(l, m)) c[static_cast<std::size_t>(slotOf(l, m))] = normal(random);
        }
    }
    return c;
}

/// visit(values of all functions, weight in the inner product), by rules of GSL.
template <class Visit>
void eachPoint(const Basis& basis, Visit&& visit) {
    std::vector<double> values(static_cast<std::size_t>(basis.slots()));
    const bool projected = basis.inner() == Basis::Inner::projectedSolidAngle;
    rules::eachPoint(64, 48, basis.name() == "sh", [&](const Direction& d, double weight) {
        basis.evaluate(d, values.data());
        visit(values, projected ? weight * d.z : weight);
    });
}

class Products : public testing::TestWithParam<const bases::Entry*> {
protected:
    std::unique_ptr<Basis> basis(int order, bool phase = false) const {
        return GetParam()->make(std::min(order, GetParam()->maxOrder), {.condonShortley = phase});
    }
};

std::vector<const bases::Entry*> orthonormal() {
    std::vector<const bases::Entry*> rows;
    for (const bases::Entry& entry : bases::catalog()) {
        if (entry.orthonormal) rows.push_back(&entry);
    }
    return rows;
}

std::string parameterName(const testing::TestParamInfo<const bases::Entry*>& row) {
    std::string name(row.param->name);
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}

TEST_P(Products, EveryEntryOfTheTensorIsItsIntegral) {
    for (const bool phase : {false, true}) {
        const auto functions = basis(5, phase);
        const auto slots = static_cast<std::size_t>(functions->slots());
        const TripleProducts tensor(*functions);
        EXPECT_EQ(tensor.entries().size(), TripleProducts::count(*functions));
        std::vector<double> exact(slots * slots * slots);
        eachPoint(*functions, [&](const std::vector<double>& b, double weight) {
            for (std::size_t i = 0; i < slots; ++i) {
                for (std::size_t j = i; j < slots; ++j) {
                    for (std::size_t k = j; k < slots; ++k) {
                        exact[(i * slots + j) * slots + k] += weight * b[i] * b[j] * b[k];
                    }
                }
            }
        });
        for (std::size_t i = 0; i < slots; ++i) {
            for (std::size_t j = i; j < slots; ++j) {
                for (std::size_t k = j; k < slots; ++k) {
                    const double value = exact[(i * slots + j) * slots + k];
                    ASSERT_NEAR(tensor.at(i, j, k), value, 2e-13) << i << " " << j << " " << k;
                    ASSERT_EQ(tensor.at(k, i, j), tensor.at(i, j, k));
                }
            }
        }
    }
}

TEST_P(Products, VectorsMultiplyAlikeByTensorMatrixAndGrid) {
    const auto functions = basis(6), factorBasis = basis(8);
    const auto slots = static_cast<std::size_t>(functions->slots());
    const std::vector<double> a = randomVector(*functions, 1), b = randomVector(*functions, 2);
    std::vector<double> byTensor(slots);
    TripleProducts(*functions).multiply(a, b, byTensor.data());
    const Multiplied byGrid = multiplied(*functions, *functions, a, *functions, b);
    const std::vector<double> matrix = transferMatrix(*functions, *functions, a);
    const double scale = std::sqrt(byGrid.energy);
    for (std::size_t k = 0; k < slots; ++k) {
        double byMatrix = 0;
        for (std::size_t j = 0; j < slots; ++j) {
            byMatrix += matrix[k * slots + j] * b[j];
            EXPECT_EQ(matrix[k * slots + j], matrix[j * slots + k]);
        }
        EXPECT_NEAR(byGrid.coefficients[k], byTensor[k], 1e-13 * scale);
        EXPECT_NEAR(byMatrix, byTensor[k], 1e-13 * scale);
    }
    // A factor of more bands than the matrix.
    const std::vector<double> factor = randomVector(*factorBasis, 3);
    const std::vector<double> wide = transferMatrix(*functions, *factorBasis, factor);
    const Multiplied expected = multiplied(*functions, *factorBasis, factor, *functions, b);
    for (std::size_t k = 0; k < slots; ++k) {
        const double value = std::inner_product(b.begin(), b.end(),
                                                wide.begin() + static_cast<long>(k * slots), 0.0);
        EXPECT_NEAR(value, expected.coefficients[k], 1e-13 * std::sqrt(expected.energy));
    }
}

TEST_P(Products, EnergyAndTruncationAreThoseOfThePointwiseProduct) {
    const auto functions = basis(4);
    const std::vector<double> a = randomVector(*functions, 4), b = randomVector(*functions, 5);
    const Multiplied product = multiplied(*functions, *functions, a, *functions, b);
    double energy = 0, left = 0;
    eachPoint(*functions, [&](const std::vector<double>& values, double weight) {
        const double f = std::inner_product(a.begin(), a.end(), values.begin(), 0.0);
        const double g = std::inner_product(b.begin(), b.end(), values.begin(), 0.0);
        const double kept = std::inner_product(product.coefficients.begin(),
                                               product.coefficients.end(), values.begin(), 0.0);
        energy += weight * f * f * g * g;
        left += weight * (f * g - kept) * (f * g - kept);
    });
    EXPECT_NEAR(product.energy, energy, 1e-12 * energy);
    EXPECT_NEAR(product.truncation, std::sqrt(left / energy), 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Bases, Products, testing::ValuesIn(orthonormal()), parameterName);

TEST(ProductsOfHarmonics, AllBandsOfTheProductHoldIt) {
    const auto first = bases::make("sh", 5), second = bases::make("sh", 8);
    const std::vector<double> a = randomVector(*first, 6), b = randomVector(*second, 7);
    const Multiplied whole = multiplied(*bases::make("sh", 12), *first, a, *second, b);
    EXPECT_LE(whole.truncation, 1e-14);
    const auto& c = whole.coefficients;
    EXPECT_NEAR(std::inner_product(c.begin(), c.end(), c.begin(), 0.0), whole.energy,
                1e-13 * whole.energy);
    EXPECT_GT(multiplied(*bases::make("sh", 11), *first, a, *second, b).truncation, 1e-3);
}

TEST(ProductsOfHarmonics, SizesAndRefusals) {
    // Distinct non-zero Gaunt coefficients, counted by quadrature in the test above to order 5.
    const auto lsosh = bases::make("lsosh", 3), sh = bases::make("sh", 3),
               hsh = bases::make("hsh", 3);
    const std::vector<double> c(9, 1.0);
    EXPECT_THROW(TripleProducts{*lsosh}, UsageError);
    EXPECT_THROW(transferMatrix(*lsosh, *lsosh, c), UsageError);
    EXPECT_THROW(transferMatrix(*sh, *hsh, c), UsageError);
    EXPECT_THROW(multiplied(*sh, *hsh, c, *hsh, c), UsageError);
    EXPECT_THROW(multiplied(*sh, *sh, std::vector<double>(4), *sh, c), UsageError);
    EXPECT_THROW(TripleProducts(*bases::make("sh", 300)), UsageError);
    EXPECT_THROW(TripleProducts(*sh, 3), UsageError);
    const auto one = bases::make("sh", 1);
    EXPECT_NEAR(TripleProducts(*one).at(0, 0, 0), 1 / std::sqrt(4 * pi), 1e-16);
}

TEST(ProductsOfHarmonics, TensorOfOrder30HasTheMatrixOfAFactor) {
    const auto basis = bases::make("sh", 30);
    const std::vector<double> a = randomVector(*basis, 8), b = randomVector(*basis, 9);
    std::vector<double> c(900);
    TripleProducts(*basis).multiply(a, b, c.data());
    const Multiplied byGrid = multiplied(*basis, *basis, a, *basis, b);
    for (std::size_t k = 0; k < c.size(); ++k) {
        EXPECT_NEAR(c[k], byGrid.coefficients[k], 1e-13 * std::sqrt(byGrid.energy));
    }
}

}  // namespace
}  // namespace hshfit
