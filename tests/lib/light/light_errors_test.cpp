// Stated errors of coefficients of light hold, in bases whose Gram system enlarges them, too.

#include <hshfit/bases/catalog.h>
#include <hshfit/light/catalog.h>
#include <hshfit/light/light_projection.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

using namespace hshfit;

namespace {

LightCoefficients above(const std::vector<Light>& lights, std::string_view basis, int order,
                        double tolerance) {
    return projectLight(lights, *bases::make(basis, order),
                        {.domain = {.normal = Orientation{}}, .tolerance = tolerance});
}

/// By roots of sums of squares.
double relativeDifference(const std::vector<double>& a, const std::vector<double>& b) {
    double missed = 0, all = 0;
    for (std::size_t k = 0; k < a.size(); ++k) {
        missed += std::pow(a[k] - b[k], 2);
        all += b[k] * b[k];
    }
    return std::sqrt(missed / all);
}

/// The reference has nodes at more levels. A stated error is the difference of two levels.
TEST(LightErrors, HoldInEveryBasisOfTheHemisphere) {
    const std::vector<Light> sky = parseLights("sky:type=12,elevation=20,radiance=1").lights;
    for (const bases::Entry& info : bases::catalog()) {
        for (const int order : {3, 8, 14, 20}) {
            if (order > info.maxOrder) continue;
            const LightCoefficients fine = above(sky, info.name, order, 1e-9);
            const LightCoefficients coarse = above(sky, info.name, order, 1e-1);
            EXPECT_LE(relativeDifference(coarse.values, fine.values),
                      3 * (coarse.error + fine.error))
                << info.name << " " << order;
        }
    }
}

/// The best fit of a polynomial by one of a higher degree is the polynomial.
TEST(LightErrors, OfPolynomialsAreRoundingEnlarged) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> value(-1, 1);
    auto harmonics = std::make_shared<LightCoefficients>();
    harmonics->basis = "sh";
    harmonics->order = 4;
    for (int k = 0; k < 48; ++k) harmonics->values.push_back(value(random));
    const CoefficientLight light{.file = "",
                                 .coefficients = harmonics,
                                 .basis = bases::make("sh", 4),
                                 .tangent = {1, 0, 0},
                                 .bitangent = {0, 1, 0},
                                 .normal = {0, 0, 1}};
    for (const int order : {4, 8, 12}) {
        const LightCoefficients found = above({light}, "lsosh", order, 1e-12);
        std::vector<double> expected(found.values.size(), 0.0);
        for (std::size_t c = 0; c < 3; ++c)
            std::copy_n(harmonics->at(c), 16,
                        expected.begin() + static_cast<long>(c * found.slots()));
        const double off = relativeDifference(found.values, expected);
        EXPECT_LE(off, found.error) << order;
        EXPECT_LE(found.error, 1e-3) << order;
    }
}

}  // namespace
