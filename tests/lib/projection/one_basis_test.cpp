// One basis of a projection, and the share of the energy that it captures.

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/projection/one_basis.h>

#include <lib/formula_brdf.h>

#include <gtest/gtest.h>

#include <cmath>

namespace hshfit {
namespace {

Projection projected(const test::FormulaBrdf& brdf, const char* name, int order) {
    return project(brdf, *bases::make(name, order), OutgoingSet::elevations(4));
}

TEST(OneBasis, HasTheNumbersOfAProjectionOntoSeveral) {
    const test::FormulaBrdf brdf(
        [](const Direction& wi, const Direction& wo) { return wi.z * wi.z + wi.x * wo.x; });
    const auto first = bases::make("hsh", 5), second = bases::make("zernike", 4);
    const Basis* const both[] = {first.get(), second.get()};
    const OutgoingSet outgoing = OutgoingSet::elevations(4);
    const ProjectionOptions options{.quantity = Quantity::brdfCosine};
    const std::vector<Projection> several = project(brdf, both, outgoing, options);
    for (const std::size_t b : {0u, 1u}) {
        const Projection one = project(brdf, *both[b], outgoing, options);
        EXPECT_EQ(one.coefficients.quantity, Quantity::brdfCosine);
        EXPECT_EQ(one.coefficients.basis, several[b].coefficients.basis);
        ASSERT_EQ(one.coefficients.values.size(), several[b].coefficients.values.size());
        for (std::size_t i = 0; i < one.coefficients.values.size(); ++i)
            EXPECT_NEAR(one.coefficients.values[i], several[b].coefficients.values[i], 1e-12);
    }
}

/// The energy of f = cos(theta_i) is 2 pi / 3. The constant function 1 / sqrt(2 pi) captures
/// (integral of f / sqrt(2 pi))^2 = pi / 2 of it, and band 1 the rest.
TEST(OneBasis, CapturesTheShareOfTheEnergyThatTheIntegralsGive) {
    const test::FormulaBrdf cosine([](const Direction& wi, const Direction&) { return wi.z; });
    EXPECT_NEAR(capturedShare(projected(cosine, "hsh", 1)).value(), 0.75, 1e-9);
    EXPECT_NEAR(capturedShare(projected(cosine, "hsh", 2)).value(), 1, 1e-9);
}

/// The square of cos(theta_i)^-1/2 has no integral over the hemisphere, although f has one.
TEST(OneBasis, HasNoShareOfAnEnergyThatDoesNotExistOrIsZero) {
    const test::FormulaBrdf steep(
        [](const Direction& wi, const Direction&) { return 1 / std::sqrt(wi.z); });
    EXPECT_FALSE(capturedShare(projected(steep, "hsh", 3)));
    const test::FormulaBrdf black([](const Direction&, const Direction&) { return 0.0; });
    EXPECT_FALSE(capturedShare(projected(black, "hsh", 3)));
}

TEST(OneBasis, RefusesTolerancesThatAreNone) {
    const test::FormulaBrdf cosine([](const Direction& wi, const Direction&) { return wi.z; });
    const auto basis = bases::make("hsh", 2);
    for (const double tolerance : {-1.0, -1e-9, 1.5, HUGE_VAL, std::nan("")})
        EXPECT_THROW(project(cosine, *basis, OutgoingSet::elevations(4), {.tolerance = tolerance}),
                     UsageError)
            << tolerance;
    EXPECT_NO_THROW(project(cosine, *basis, OutgoingSet::elevations(4), {.tolerance = 0}));
}

TEST(OneBasis, HasNoShareOfLeastSquares) {
    const test::FormulaBrdf cosine([](const Direction& wi, const Direction&) { return wi.z; });
    Projection fitted = projected(cosine, "hsh", 2);
    ASSERT_TRUE(capturedShare(fitted));
    fitted.coefficients.leastSquares.emplace();
    EXPECT_FALSE(capturedShare(fitted));
}

}  // namespace
}  // namespace hshfit
