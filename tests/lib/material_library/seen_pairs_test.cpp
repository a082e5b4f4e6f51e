// Weights of lit pixels and of their colours, against colours and fits by other ways.

#include <lib/formula_brdf.h>

#include <hshfit/brdf/vectors.h>
#include <hshfit/material_library/basis.h>
#include <hshfit/material_library/internal/log_samples.h>
#include <hshfit/material_library/library.h>
#include <hshfit/material_library/log_space.h>
#include <hshfit/material_library/log_terms.h>
#include <hshfit/pictures/lab.h>
#include <hshfit/pictures/picture_error.h>
#include <hshfit/pictures/rgb_picture.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

namespace hshfit::material_library {
namespace {

const LogSpace& space() {
    static const LogSpace one;
    return one;
}

/// Hunt-adjusted L*a*b* (flip.cpp).
Eigen::Vector3d hunt(const LinearRgb& rgb) {
    const Lab lab = labOf(rgb);
    return {lab.lightness, 0.01 * lab.lightness * lab.a, 0.01 * lab.lightness * lab.b};
}

/// ln(f + logOffset) of a matte surface under the lamps, a little different at each pair.
Eigen::MatrixXd matte(const std::array<double, 3>& f, Eigen::Index channels) {
    const SeenPairs& seen = space().samples().seen;
    std::mt19937 random(3);
    std::uniform_real_distribution<double> factor(0.9, 1.1);
    Eigen::MatrixXd logs(seen.cosines.size(), channels);
    for (Eigen::Index k = 0; k < logs.rows(); ++k)
        for (Eigen::Index c = 0; c < channels; ++c)
            logs(k, c) = std::log(f[static_cast<std::size_t>(c)] * factor(random) + logOffset);
    return logs;
}

/// The exposure that shows half of the pixels of a lamp below 0.8, of their largest channels.
double exposureOf(const SeenPairs& seen, const Eigen::MatrixXd& logs, std::size_t lamp) {
    std::vector<double> largest;
    for (std::size_t k = seen.first[lamp]; k < seen.first[lamp + 1]; ++k) {
        const auto row = static_cast<Eigen::Index>(k);
        largest.push_back((std::exp(logs.row(row).maxCoeff()) - logOffset) * seen.cosines[row]);
    }
    std::ranges::sort(largest);
    return shownAsWhite / largest[largest.size() / 2];
}

class ColoursOfPairs : public testing::TestWithParam<Eigen::Index> {};

TEST_P(ColoursOfPairs, AreSquaresOfDifferencesInHuntAdjustedLab) {
    const Eigen::Index channels = GetParam();
    const SeenPairs& seen = space().samples().seen;
    const Eigen::MatrixXd logs = matte({0.25, 0.12, 0.03}, channels), metric = seen.colours(logs);
    const Eigen::Vector3d error = Eigen::Vector3d(1, -2, 0.5) * 1e-4;
    std::size_t shown = 0;
    for (std::size_t lamp = 0; lamp + 1 < seen.first.size(); ++lamp) {
        const double exposure = exposureOf(seen, logs, lamp);
        for (std::size_t k = seen.first[lamp]; k < seen.first[lamp + 1]; ++k) {
            const auto row = static_cast<Eigen::Index>(k);
            LinearRgb before, after;
            double found = 0;
            for (Eigen::Index c = 0; c < 3; ++c) {
                const Eigen::Index own = channels == 1 ? 0 : c;
                const auto at = static_cast<std::size_t>(c);
                before[at] = exposure * (std::exp(logs(row, own)) - logOffset) * seen.cosines[row];
                after[at] = before[at] * std::exp(error[own]);
            }
            if (*std::ranges::max_element(before) >= 1) continue;  // a shorter exposure shows it
            for (Eigen::Index c = 0; c < channels; ++c)
                for (Eigen::Index d = 0; d < channels; ++d)
                    found += metric(row, c * channels + d) * error[c] * error[d];
            const double expected = (hunt(after) - hunt(before)).squaredNorm() / 1600 /
                                    static_cast<double>(seen.pairs.size());
            EXPECT_NEAR(found, expected, 0.01 * expected) << k;
            ++shown;
        }
    }
    EXPECT_GT(shown, seen.pairs.size() / 2);
}

INSTANTIATE_TEST_SUITE_P(GreyAndRgb, ColoursOfPairs, testing::Values(1, 3));

TEST(SeenPairs, ColoursOfBlackAreFinite) {
    const SeenPairs& seen = space().samples().seen;
    const Eigen::MatrixXd black =
        Eigen::MatrixXd::Constant(seen.cosines.size(), 3, std::log(logOffset));
    EXPECT_TRUE(seen.colours(black).allFinite());
}

/// A coloured material whose terms are normal numbers of falling spread, some of them common to all
/// channels.
LogMaterial coloured(std::mt19937& random) {
    std::normal_distribution<double> number;
    const auto terms = static_cast<std::size_t>(logTerms().size());
    LogMaterial material{std::vector<double>(3 * terms, 0.0), {3, 3, 3}};
    for (std::size_t n = 0; n < 12; ++n) {
        const double common = number(random);
        for (std::size_t c = 0; c < 3; ++c)
            material.exponents[c * terms + 20 + 11 * n] =
                (0.3 * common + 0.1 * number(random)) / static_cast<double>(n + 1);
    }
    return material;
}

/// The mean square of colour differences, in the metric of the material, of its stored form.
double colourError(const LogMaterial& material, const LogMaterial& stored) {
    const SeenPairs& seen = space().samples().seen;
    const Eigen::MatrixXd logs = seen.logs(material), metric = seen.colours(logs),
                          off = seen.logs(stored) - logs;
    double sum = 0;
    for (Eigen::Index c = 0; c < 3; ++c)
        for (Eigen::Index d = 0; d < 3; ++d)
            sum += metric.col(3 * c + d).dot(off.col(c).cwiseProduct(off.col(d)));
    return sum;
}

LogMaterial channelOf(const LogMaterial& material, std::size_t c) {
    const auto terms = static_cast<std::ptrdiff_t>(logTerms().size());
    const auto from = material.exponents.begin() + static_cast<std::ptrdiff_t>(c) * terms;
    return {{from, from + terms}, {material.tops[c]}};
}

TEST(Codes, OfThreeChannelsTogetherKeepColoursBetterThanThreeOfOne) {
    std::mt19937 random(5);
    std::vector<Measured> all;
    for (int n = 0; n < 30; ++n)
        all.push_back(space().project(LogBrdf(coloured(random), "made"),
                                      fmt::format("m{}", 100 + n), "made"));
    const Library library = learn(space(), std::move(all), {}, {.components = 8, .bytes = 15},
                                  {.log = 10, .maximum = 10, .flip = 1});
    const Encoder encoder(library.basis, space());
    // Single materials differ by factors, and the mean of their logarithms by a few percent from
    // one library to another.
    constexpr int materials = 40;
    double logOfRatio = 0;
    for (int n = 0; n < materials; ++n) {
        const LogMaterial material = coloured(random);
        const auto codes = encoder.encode(material, library.basis.size());
        std::vector<std::uint8_t> single;
        for (std::size_t c = 0; c < 3; ++c) {
            const auto one = encoder.encode(channelOf(material, c), library.basis.size());
            single.insert(single.end(), one.begin(), one.end());
        }
        logOfRatio += std::log(colourError(material, decode(library.basis, codes)) /
                               colourError(material, decode(library.basis, single)));
    }
    EXPECT_LT(std::exp(logOfRatio / materials), 0.9);
}

TEST(LogSpace, ProjectionsSeeMoreOfWhatPicturesShowThanLeastSquaresOverPairs) {
    // A rim that is brighter towards the lamp, and finer than the terms.
    const test::FormulaBrdf brdf(
        [](const Direction& wi, const Direction& wo) {
            const double between = std::acos(std::clamp(dot(wi, wo), -1.0, 1.0));
            return 0.1 + 0.05 * std::cos(9 * between) +
                   0.1 * std::exp(-40 * wi.z) * std::exp(-40 * wo.z);
        },
        {}, {.reciprocal = true, .isotropic = true});
    const LogSamples& samples = space().samples();
    Eigen::VectorXd logs(static_cast<Eigen::Index>(samples.pairs.size()));
    for (std::size_t k = 0; k < samples.pairs.size(); ++k)
        logs[static_cast<Eigen::Index>(k)] = std::log(
            evaluate(brdf, samples.pairs.incoming(k), samples.pairs.outgoing(k))[0] + logOffset);
    const Eigen::VectorXd plain =
        samples.solve(samples.terms.transpose() * samples.weights.cwiseProduct(logs));
    const LogBrdf fitted({{plain.begin(), plain.end()}, {logs.maxCoeff()}}, "fitted"),
        projected(space().project(brdf, "a", "made").material(), "projected");
    const PictureReference seen(brdf);
    EXPECT_LT(seen.errorOf(projected).flip.mean, 0.9 * seen.errorOf(fitted).flip.mean);
}

}  // namespace
}  // namespace hshfit::material_library
