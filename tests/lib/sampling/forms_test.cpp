// Samplers of every form that a coefficient file can have.

#include "sampling_laws.h"

#include <hshfit/representation/forms/form.h>
#include <hshfit/representation/forms/represented_brdf.h>
#include <hshfit/sampling/make_sampler.h>

#include <gtest/gtest.h>
#include <lib/formula_brdf.h>

namespace hshfit::test {
namespace {

/// A diffuse part and a lobe of the half vector, 0.2 wide in slopes, without singularities.
std::unique_ptr<Brdf> glossy(double diffuse = 0.1) {
    return std::make_unique<FormulaBrdf>(
        [diffuse](const Direction& wi, const Direction& wo) {
            const double x = wi.x + wo.x, y = wi.y + wo.y, z = wi.z + wo.z;
            return diffuse + std::exp(-(x * x + y * y) / (z * z) / 0.04);
        },
        FormulaBrdf::Predicate{},
        Laws{.nonNegative = true, .reciprocal = true, .isotropic = true, .mirrorSymmetric = true});
}

struct Case {
    const char* name;
    Form form;
};

std::vector<Case> cases() {
    using Kind = Representation::Kind;
    const std::string set = "8";
    return {{"outgoing", {.order = 6, .outgoing = set}},
            {"outgoing, f cos", {.order = 6, .quantity = Quantity::brdfCosine, .outgoing = set}},
            {"basis", {.kind = Kind::basis, .order = 5}},
            {"halfway", {.kind = Kind::halfway, .halfway = {8, 4, 1}}},
            {"sparse", {.order = 6, .outgoing = set, .keep = 12}},
            {"factored", {.kind = Kind::basis, .order = 5, .rank = 4}},
            {"split", {.order = 6, .outgoing = set, .split = "added"}},
            {"8 bits", {.order = 6, .outgoing = set, .precision = Precision::unorm8}}};
}

class SamplingForms : public testing::TestWithParam<Case> {};

/// Coefficients go below 0; |f| is sampled, and estimates of the albedo stay right.
TEST_P(SamplingForms, SamplesFollowTheDensityAndGiveTheAlbedo) {
    const BrdfOpener open = [](const std::string&) { return glossy(0); };
    const auto source = glossy();
    const Representation form =
        represent(*source, GetParam().form, open, {.tolerance = 3e-2, .maxEvaluations = 1 << 18});
    const auto brdf = reconstruct(form, open);
    const auto sampler =
        makeSampler(*brdf, {.elevations = 8, .tabulation = {.elevations = 8}, .fit = {4}});
    std::uint64_t seed = 1;
    for (const double theta : {0., 40., 75.}) {
        const Direction wo = directionFromAngles(radians(theta), 1.3);
        const SamplerLaws laws = lawsAt(*sampler, wo, 10000, ++seed);
        EXPECT_NEAR(laws.integral, 1, 3e-3);
        EXPECT_GT(laws.fit.probability, sidak(3 * cases().size()));
        EXPECT_EQ(laws.unequal + laws.below, 0U);
        // The albedo on a grid of its own, 200 x 200 midpoints of the projected disc.
        double albedo = 0;
        constexpr int n = 200;
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) {
                const double r = std::sqrt((i + .5) / n), phi = (j + .5) * 2 * pi / n;
                const Direction wi{r * std::cos(phi), r * std::sin(phi), std::sqrt(1 - r * r)};
                albedo += evaluate(*brdf, wi, wo)[0] * pi / (n * n);
            }
        const Efficiency found = efficiencyAt(*brdf, *sampler, wo, 20000, 5);
        EXPECT_NEAR(found.albedo[0], albedo, 5 * found.albedoError[0] + 1e-3 * albedo) << theta;
        EXPECT_LT(found.variance, 0.5) << theta;
    }
}

INSTANTIATE_TEST_SUITE_P(Forms, SamplingForms, testing::ValuesIn(cases()), [](const auto& form) {
    std::string name = form.param.name;
    std::erase_if(name, [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); });
    return name;
});

}  // namespace
}  // namespace hshfit::test
