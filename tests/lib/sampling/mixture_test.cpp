// Tables, fitted proposals and their mixtures, from formulas with known answers.

#include "sampling_laws.h"

#include <hshfit/error.h>
#include <hshfit/sampling/axis_lobes.h>
#include <hshfit/sampling/make_sampler.h>
#include <hshfit/sampling/visible_normals.h>

#include <gtest/gtest.h>
#include <lib/formula_brdf.h>

#include <limits>

namespace hshfit::test {
namespace {

FormulaBrdf lambert() {
    return FormulaBrdf(
        [](const Direction& wi, const Direction&) { return wi.z > 0 ? 0.5 / pi : 0; });
}

/// f cos(theta_i) is GGX's density of visible normals, unfolded, so that it can be fitted exactly.
FormulaBrdf visibleGgx(double alpha) {
    return FormulaBrdf([alpha](const Direction& wi, const Direction& wo) {
        const double x = wi.x + wo.x, y = wi.y + wo.y, z = wi.z + wo.z, a2 = alpha * alpha;
        const double length2 = x * x + y * y + z * z;
        const double s = ((x * x + y * y) / a2 + z * z) / length2;
        const double across2 = wo.x * wo.x + wo.y * wo.y;
        const double visible = wo.z + std::sqrt(a2 * across2 + wo.z * wo.z);
        return 1 / (2 * pi * a2 * s * s * visible) / wi.z;
    });
}

/// A lobe back towards wo, over a diffuse part.
FormulaBrdf retro() {
    return FormulaBrdf([](const Direction& wi, const Direction& wo) {
        return 0.1 + std::exp(200 * (dot(wi, wo) - 1));
    });
}

FormulaBrdf anisotropic() {
    return FormulaBrdf(
        [](const Direction& wi, const Direction& wo) {
            const double x = (wi.x + wo.x) / .05, y = (wi.y + wo.y) / .4;
            return 0.05 + std::exp(-x * x - y * y);
        },
        {}, Laws{});
}

std::vector<Direction> outgoing() {
    std::vector<Direction> all;
    for (const double theta : {0., 17., 52., 80., 89.99})
        all.push_back(directionFromAngles(radians(theta), 0.4 + theta));
    return all;
}

void expectLaws(const Sampler& sampler, const char* name, double tolerance = 3e-3) {
    std::uint64_t seed = 100;
    for (const Direction& wo : outgoing()) {
        SCOPED_TRACE(fmt::format("{}, theta_o {}", name, degrees(polarAngle(wo))));
        const SamplerLaws laws = lawsAt(sampler, wo, 20000, ++seed);
        EXPECT_NEAR(laws.integral, 1, tolerance);
        EXPECT_GT(laws.fit.probability, sidak(40)) << laws.fit.groups;
        EXPECT_EQ(laws.unequal, 0U);
        EXPECT_EQ(laws.below, 0U);
    }
}

TEST(DiscTable, SamplesFollowItsDensity) {
    expectLaws(*tabulate(lambert()), "Lambert");
    expectLaws(*tabulate(visibleGgx(1e-3)), "narrow");
    expectLaws(*tabulate(retro()), "retro");
    expectLaws(*tabulate(anisotropic(), {.elevations = 8, .azimuths = 8}), "anisotropic");
}

/// Lambert's weight has no variance under the cosine; cells of a table add little.
TEST(DiscTable, OfLambertIsCloseToTheCosine) {
    const FormulaBrdf brdf = lambert();
    const auto table = tabulate(brdf);
    for (const double theta : {0., 17., 52., 80.}) {
        const Direction wo = directionFromAngles(radians(theta), 1);
        EXPECT_LT(efficiencyAt(brdf, *table, wo, 20000).variance, 0.02) << theta;
    }
}

TEST(Mixture, SamplesFollowItsDensity) {
    expectLaws(*makeSampler(lambert()), "Lambert");
    expectLaws(*makeSampler(visibleGgx(1e-3)), "narrow");
    expectLaws(*makeSampler(retro()), "retro");
    expectLaws(*makeSampler(anisotropic(), {.tabulation = {.elevations = 8, .azimuths = 8}}),
               "anisotropic");
}

/// The fit finds the lobe that a density was made with: the second moment of a normalised f is 1
/// plus what the least share of the cosine and steps of 4 % in width cost.
TEST(Proposal, FindsTheLobeOfAModel) {
    for (const double alpha : {1e-3, .03, .3}) {
        const FormulaBrdf brdf = visibleGgx(alpha);
        const auto sampler = proposalSampler(fitProposal(brdf));
        for (const double theta : {0., 30., 60., 85.}) {
            const Direction wo = directionFromAngles(radians(theta), 1);
            EXPECT_LT(efficiencyAt(brdf, *sampler, wo, 20000).variance, 0.08)
                << alpha << " " << theta;
        }
    }
}

TEST(Proposal, FindsRetroReflection) {
    const FormulaBrdf brdf = retro();
    const auto fitted = proposalSampler(fitProposal(brdf));
    for (const double theta : {30., 60.}) {
        const Direction wo = directionFromAngles(radians(theta), 1);
        const double cosine = efficiencyAt(brdf, *cosineSampler(), wo, 20000).variance;
        EXPECT_LT(efficiencyAt(brdf, *fitted, wo, 20000).variance, 0.7 * cosine) << theta;
    }
}

/// Rows that differ in everything, so that every parameter is interpolated; mirror and retro lobes,
/// isotropic and not.
TEST(Proposal, SamplesFollowTheDensityBetweenItsRows) {
    for (const int retro : {0, 1})
        for (const int aside : {0, 40}) {
            Proposal proposal;
            for (int row = 0; row < 4; ++row) {
                const auto code = [&](int value) { return static_cast<std::uint8_t>(value); };
                proposal.rows.push_back({ProposalLobe{code(30 + 30 * row), code(150 + 15 * row),
                                                      code(150 + 15 * row + aside), 0},
                                         ProposalLobe{code(100 - 20 * row), code(210 - 10 * row),
                                                      code(210 - 10 * row - aside), code(retro)}});
            }
            EXPECT_EQ(proposal.isotropic(), aside == 0);
            expectLaws(*proposalSampler(proposal),
                       fmt::format("retro {}, aside {}", retro, aside).c_str());
        }
}

/// Between rows, shares and widths are means of both rows; at a row they are the row's own.
TEST(Proposal, IsInterpolatedBetweenRowsAndContinuous) {
    const Proposal proposal = fitProposal(visibleGgx(.1));
    const std::size_t rows = proposal.rows.size();
    for (std::size_t row = 0; row < rows; ++row) {
        const Direction wo = directionOfRow(row, rows);
        EXPECT_NEAR(dot(wo, wo), 1, 1e-14);
        EXPECT_NEAR(proposalPlace(wo, rows), static_cast<double>(row), 1e-9);
        EXPECT_NEAR(mixAt(proposal, wo).share[0], proposal.rows[row][0].share / 255., 1e-9);
        EXPECT_NEAR(mixAt(proposal, wo).widthX[1], proposalWidth(proposal.rows[row][1].widthX),
                    1e-9);
    }
    EXPECT_EQ(proposalPlace({0, 0, 1}, rows), 0);
    EXPECT_EQ(proposalPlace({1, 0, 0}, rows), static_cast<double>(rows - 1));
    const auto sampler = proposalSampler(proposal);
    const Direction wi = directionFromAngles(radians(50), pi);
    double before = 0;
    for (int k = 0; k < 90000; ++k) {
        const double pdf = sampler->pdf(directionFromAngles(radians(k * 1e-3), 0), wi);
        if (k > 0) {
            EXPECT_NEAR(pdf, before, 0.01 * std::max(pdf, before)) << k;
        }
        before = pdf;
    }
}

TEST(Proposal, HasEightBytesPerElevation) {
    const Proposal proposal = fitProposal(lambert(), {.elevations = 5});
    EXPECT_EQ(proposal.bytes(), 40U);
    EXPECT_THROW(proposalSampler({}), UsageError);
    Proposal full = proposal;
    full.rows[0][0].share = full.rows[0][1].share = 128;
    EXPECT_THROW(proposalSampler(full), UsageError);
    Proposal turned = proposal;
    turned.rows[2][1].retro = turned.rows[2][1].retro == 0;
    EXPECT_THROW(proposalSampler(turned), UsageError);
    turned = proposal;
    for (Proposal::Row& row : turned.rows) row[0].retro = 1;
    EXPECT_THROW(proposalSampler(turned), UsageError);
    turned.rows.assign(mostProposalRows + 1, {});
    EXPECT_THROW(checkProposal(turned), UsageError);
}

/// A closed form: with the cosine alone, f = 1/2 / pi + a has weight pi f, variance 0 where f is
/// constant; and the albedo of a lobe cos^n about the normal is 2 pi / (n + 2).
TEST(Efficiency, HasTheMomentsOfAPowerOfTheCosine) {
    const double n = 4;
    const FormulaBrdf brdf(
        [&](const Direction& wi, const Direction&) { return std::pow(wi.z, n); });
    const Direction wo = directionFromAngles(.3, 0);
    const Efficiency found = efficiencyAt(brdf, *cosineSampler(), wo, 200000, 7);
    EXPECT_NEAR(found.mean, 2 * pi / (n + 2), 5 * found.standardError);
    // Second moment: integral of z^(2 n + 1) pi d omega = 2 pi^2 / (2 n + 2).
    const double variance = 2 * pi * pi / (2 * n + 2) / std::pow(2 * pi / (n + 2), 2) - 1;
    EXPECT_NEAR(found.variance, variance, 0.02);
    EXPECT_LE(found.largest, pi / (2 * pi / (n + 2)) * 1.02);
    EXPECT_EQ(found.wasted, 0);
    EXPECT_NEAR(efficiencyAt(lambert(), *cosineSampler(), wo, 1000).variance, 0, 1e-12);
}

TEST(Efficiency, WeightsAreBoundedByTheShareOfTheCosine) {
    const FormulaBrdf brdf = retro();
    const auto sampler = makeSampler(brdf);
    UniformNumbers numbers(3);
    for (const Direction& wo : outgoing())
        for (int k = 0; k < 20000; ++k) {
            const Sample s = sampler->sample(wo, numbers.next());
            ASSERT_TRUE(std::isfinite(s.pdf));
            ASSERT_GE(s.pdf, s.wi.z / pi / 32 * (1 - 1e-12));
        }
}

TEST(Mixture, ABrdfThatIsZeroGetsTheCosineAndSaysSo) {
    const FormulaBrdf zero([](const Direction&, const Direction&) { return 0.0; });
    const auto sampler = makeSampler(zero);
    for (const Direction& wo : outgoing()) {
        EXPECT_FALSE(sampler->reflects(wo));
        const Sample s = sampler->sample(wo, {.2, .3, .4});
        EXPECT_EQ(s.pdf, s.wi.z / pi);
    }
    EXPECT_TRUE(makeSampler(lambert())->reflects({}));
    EXPECT_FALSE(makeSampler(lambert())->reflects({.6, 0, -.8}));
}

TEST(Mixture, ValuesThatAreNotFiniteCountAsZero) {
    const FormulaBrdf holes([](const Direction& wi, const Direction&) {
        if (wi.x > .3) return std::nan("");
        return wi.y > .5 ? std::numeric_limits<double>::infinity() : 1 / pi;
    });
    const auto sampler = makeSampler(holes);
    expectLaws(*sampler, "holes");
    EXPECT_TRUE(std::isfinite(efficiencyAt(holes, *sampler, {}, 1000).mean));
}

TEST(Mixture, TheCosineAlwaysHasItsShare) {
    const auto sampler = makeSampler(visibleGgx(.01));
    for (const MixtureRow& row : sampler->rows()) {
        EXPECT_GE(row.shares[0], 1. / 32 - 1e-12);
        double sum = 0;
        for (const double share : row.shares) sum += share;
        EXPECT_NEAR(sum, 1, 1e-12);
    }
}

}  // namespace
}  // namespace hshfit::test
