#include <hshfit/tradeoff/tradeoff_files.h>
#include <hshfit/wavelets/slices.h>

#include "lib/formula_brdf.h"

#include <gtest/gtest.h>

namespace hshfit::tradeoff {
namespace {

std::unique_ptr<Brdf> openNothing(const std::string& spec) {
    throw UsageError("unexpected: " + spec);
}

TEST(WaveletForms, StandBesideTheFrontWithTheirIndices) {
    // A lobe about the mirror direction over a diffuse term.
    const test::FormulaBrdf lobe([](const Direction& wi, const Direction& wo) {
        if (!(wi.z > 0) || !(wo.z > 0)) return 0.0;
        return 0.05 + 0.4 * std::pow((1 + dot(mirrored(wo), wi)) / 2, 6);
    });
    TradeoffOptions options;
    options.sweep.bases = {"hsh"};
    options.sweep.ranks = {0};
    options.sweep.precisions = {Precision::float32, Precision::half};
    options.sweep.kinds = {Representation::Kind::outgoing};
    options.sweep.outgoing = {"8"};
    options.sweep.orders = {3, 6};
    options.timing = false;
    const PairSample pairs = spreadPairs({.incoming = 16});
    const Tradeoff plain = measure(lobe, pairs, options, openNothing);
    options.wavelets = true;
    const Tradeoff made = measure(lobe, pairs, options, openNothing);
    EXPECT_EQ(plain.byteFront, made.byteFront);
    EXPECT_EQ(tradeoffJson({&plain, 1}).find("wavelets"), std::string::npos);
    EXPECT_EQ(tradeoffScript({&plain, 1}).find("wavelets"), std::string::npos);
    EXPECT_NE(tradeoffJson({&made, 1}).find("best_terms"), std::string::npos);
    EXPECT_NE(tradeoffPage({&made, 1}, {}).find("nonlinear"), std::string::npos);
    ASSERT_EQ(made.wavelets.size(), 4u);
    const auto source =
        wavelets::TermsBrdf::project(lobe, OutgoingSet::parse("8"), Quantity::brdf, 36);
    for (std::size_t k = 0; k < made.wavelets.size(); ++k) {
        const MeasuredWavelets& form = made.wavelets[k];
        EXPECT_EQ(form.bytes, 8 * form.terms * (form.valueBytes + 2));
        const wavelets::TermsBrdf g(
            source, form.terms,
            form.valueBytes == 2 ? wavelets::ValueBytes::half : wavelets::ValueBytes::single);
        double error = 0;
        for (std::size_t o = 0; o < pairs.wo.size(); ++o) {
            for (std::size_t at = pairs.first[o]; at < pairs.first[o + 1]; ++at) {
                const Direction wi{pairs.x[at], pairs.y[at], pairs.z[at]};
                const double there = evaluate(lobe, wi, pairs.wo[o])[0] * wi.z;
                const double here = std::max(evaluate(g, wi, pairs.wo[o])[0], 0.0) * wi.z;
                error += pairs.weights[at] * std::abs(std::log1p(there) - std::log1p(here));
            }
        }
        EXPECT_NEAR(made.waveletErrorOf(k), error, 1e-3 * error);
    }
    for (const std::size_t k : made.waveletFront()) {
        for (std::size_t other = 0; other < made.wavelets.size(); ++other) {
            EXPECT_FALSE(made.wavelets[other].bytes <= made.wavelets[k].bytes &&
                         made.waveletErrorOf(other) < made.waveletErrorOf(k));
        }
    }
}

}  // namespace
}  // namespace hshfit::tradeoff
