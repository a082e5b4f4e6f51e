// Analysis on a grid against sums written out over basis functions at every point, and against what
// Gauss quadrature promises: coefficients of a function of the basis come back.

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/projection/analysis.h>

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace hshfit {
namespace {

Direction at(const Elevation<double>& e, double phi) {
    const double s = std::sqrt(e.oneMinusMu * (1 + e.mu));
    return {s * std::cos(phi), s * std::sin(phi), e.mu};
}

double azimuthAt(const AnalysisGrid& grid, std::size_t j) {
    return (static_cast<double>(j) + 0.5) * 2 * pi / static_cast<double>(grid.azimuths);
}

std::vector<double> noise(std::size_t count) {
    std::mt19937_64 random(7);
    std::normal_distribution<double> normal;
    std::vector<double> values(count);
    for (double& value : values) value = normal(random);
    return values;
}

/// sum over the grid of weight f B, function by function and point by point.
std::vector<double> directSums(const Basis& basis, const AnalysisGrid& grid,
                               const std::vector<double>& samples, std::size_t functions) {
    const auto slots = static_cast<std::size_t>(basis.slots());
    std::vector<double> sums(functions * slots), values(slots);
    for (std::size_t r = 0; r < grid.elevations.size(); ++r) {
        for (std::size_t j = 0; j < grid.azimuths; ++j) {
            basis.evaluate(at(grid.elevations[r], azimuthAt(grid, j)), values.data());
            const bool projected = basis.inner() == Basis::Inner::projectedSolidAngle;
            const double weight = grid.weights[r] * 2 * pi / static_cast<double>(grid.azimuths) *
                                  (projected ? grid.elevations[r].mu : 1);
            for (std::size_t f = 0; f < functions; ++f)
                for (std::size_t k = 0; k < slots; ++k)
                    sums[f * slots + k] +=
                        weight * samples[(f * grid.elevations.size() + r) * grid.azimuths + j] *
                        values[k];
        }
    }
    return sums;
}

/// Every orthonormal basis, rings odd and even, and more functions than go side by side.
TEST(Analysis, EqualsSumsWrittenOut) {
    for (const bases::Entry& entry : bases::catalog()) {
        if (!entry.orthonormal) continue;
        for (const std::size_t rings : {9u, 12u}) {
            const auto basis = bases::make(entry.name, std::min(6, entry.maxOrder),
                                           {.condonShortley = rings == 9});
            const Analysis analysis(*basis, AnalysisGrid::gauss(rings, 20));
            const std::size_t functions = rings == 9 ? 31 : 3;
            const std::vector<double> samples = noise(functions * analysis.grid().points());
            const auto slots = static_cast<std::size_t>(basis->slots());
            std::vector<double> out(functions * slots);
            analysis.run(samples.data(), functions, out.data());
            const std::vector<double> sums =
                directSums(*basis, analysis.grid(), samples, functions);
            for (std::size_t k = 0; k < out.size(); ++k)
                ASSERT_NEAR(out[k], sums[k], 2e-14) << entry.name << " " << rings << " " << k;
        }
    }
}

TEST(Analysis, FoldsWhereThetaFunctionsAreEvenOrOdd) {
    const auto folded = [](const char* name, bool sphere) {
        return Analysis(*bases::make(name, 8), AnalysisGrid::gauss(9, 16, sphere)).folded();
    };
    EXPECT_TRUE(folded("hsh", false));
    EXPECT_TRUE(folded("sh", true));
    EXPECT_FALSE(folded("sh", false));
    EXPECT_FALSE(folded("zernike", false));
}

/// n rings are exact for polynomials of degree 2 n - 1 in cos(theta): products of two functions of
/// order n.
TEST(Analysis, GivesBackTheCoefficientsOfAFunction) {
    for (const bool sphere : {false, true}) {
        const int order = 20;
        const auto basis = bases::make(sphere ? "sh" : "hsh", order);
        const AnalysisGrid grid = AnalysisGrid::gauss(order, 2 * order, sphere);
        const std::vector<double> exact = noise(static_cast<std::size_t>(basis->slots()));
        std::vector<double> samples, values(exact.size()), out(exact.size());
        for (const auto& elevation : grid.elevations) {
            for (std::size_t j = 0; j < grid.azimuths; ++j) {
                basis->evaluate(at(elevation, azimuthAt(grid, j)), values.data());
                double sum = 0;
                for (std::size_t k = 0; k < exact.size(); ++k) sum += exact[k] * values[k];
                samples.push_back(sum);
            }
        }
        Analysis(*basis, grid).run(samples.data(), 1, out.data());
        for (std::size_t k = 0; k < exact.size(); ++k) EXPECT_NEAR(out[k], exact[k], 1e-12) << k;
    }
}

TEST(Analysis, RefusesAzimuthsThatDoNotFold) {
    EXPECT_THROW(AnalysisGrid::gauss(4, 10), UsageError);
    EXPECT_THROW(AnalysisGrid::gauss(4, 0), UsageError);
    EXPECT_THROW(AnalysisGrid::gauss(0, 8), UsageError);
}

}  // namespace
}  // namespace hshfit
