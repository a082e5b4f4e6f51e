// Maps of materials: distances and coordinates of materials made of known numbers, places of discs,
// and the looks of formulas whose integrals are known.

#include "lib/formula_brdf.h"

#include <hshfit/brdf/vectors.h>
#include <hshfit/material_library/basis.h>
#include <hshfit/material_library/log_terms.h>
#include <hshfit/material_library/material_look.h>
#include <hshfit/material_library/similarity.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace hshfit::material_library {
namespace {

using Place = std::array<double, 2>;

const LogSpace& space() {
    static const LogSpace one;
    return one;
}

LogMaterial withTerms(std::size_t channels, const std::vector<double>& first) {
    LogMaterial material{std::vector<double>(channels * logTerms().size(), 0.0),
                         std::vector<double>(channels, 3.0)};
    for (std::size_t c = 0; c < channels; ++c)
        std::ranges::copy(first, material.exponents.begin() +
                                     static_cast<std::ptrdiff_t>(c * logTerms().size() + 40));
    return material;
}

double between(const Place& a, const Place& b) {
    return std::hypot(a[0] - b[0], a[1] - b[1]);
}

std::vector<Place> randomPlaces(std::size_t count, double spread, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> number(0, spread);
    std::vector<Place> places(count);
    for (Place& place : places) place = {number(random), number(random)};
    return places;
}

TEST(Similarity, DistancesAreThoseOfTheLibraryForGreyAndColouredMaterials) {
    std::mt19937 random(3);
    std::normal_distribution<double> number;
    std::vector<LogMaterial> materials;
    for (std::size_t m = 0; m < 6; ++m) {
        LogMaterial material = withTerms(m % 2 == 0 ? 1 : 3, {});
        for (double& value : material.exponents) value = number(random);
        materials.push_back(std::move(material));
    }
    const Similarity similarity = similarityOf(space(), materials);
    ASSERT_EQ(similarity.distances.size(), 36u);
    for (std::size_t i = 0; i < 6; ++i)
        for (std::size_t k = 0; k < 6; ++k)
            EXPECT_NEAR(similarity.distances[6 * i + k],
                        distance(space(), materials[i], materials[k]), 1e-9);
    EXPECT_LT(similarity.kept, 0.9);  // six random points have five directions
}

TEST(Similarity, CoordinatesOfAFamilyOfTwoNumbersKeepItsDistances) {
    std::mt19937 random(4);
    std::uniform_real_distribution<double> number(-1, 1);
    std::vector<LogMaterial> materials;
    for (int m = 0; m < 9; ++m) materials.push_back(withTerms(1, {number(random), number(random)}));
    const Similarity similarity = similarityOf(space(), materials);
    EXPECT_NEAR(similarity.kept, 1, 1e-9);
    double first = 0, second = 0;
    for (std::size_t i = 0; i < materials.size(); ++i) {
        first += std::pow(similarity.coordinates[i][0], 2);
        second += std::pow(similarity.coordinates[i][1], 2);
        for (std::size_t k = 0; k < i; ++k)
            EXPECT_NEAR(between(similarity.coordinates[i], similarity.coordinates[k]),
                        distance(space(), materials[i], materials[k]), 1e-7);
    }
    EXPECT_GE(first, second);
}

TEST(Similarity, OneMaterialLiesAtTheOrigin) {
    const Similarity one = similarityOf(space(), std::vector{withTerms(3, {0.4})});
    EXPECT_EQ(one.distances, std::vector<double>{0});
    EXPECT_EQ(one.coordinates, (std::vector<Place>{{0, 0}}));
    EXPECT_EQ(one.kept, 1);
}

/// Places do not overlap, begin at 1/2 and do not waste room.
void expectSpread(const std::vector<Place>& from) {
    const std::vector<Place> places = spreadPlaces(from);
    ASSERT_EQ(places.size(), from.size());
    Place least{1e9, 1e9}, most{};
    for (std::size_t i = 0; i < places.size(); ++i) {
        for (std::size_t axis = 0; axis < 2; ++axis) {
            least[axis] = std::min(least[axis], places[i][axis]);
            most[axis] = std::max(most[axis], places[i][axis] + 0.5);
        }
        for (std::size_t k = 0; k < i; ++k) ASSERT_GE(between(places[i], places[k]), 1 - 1e-9);
    }
    EXPECT_NEAR(least[0], 0.5, 1e-12);
    EXPECT_NEAR(least[1], 0.5, 1e-12);
    EXPECT_LE(most[0] * most[1], 6.0 * static_cast<double>(from.size()) + 3);
}

TEST(SpreadPlaces, NoTwoDiscsOverlap) {
    expectSpread({{0, 0}});
    expectSpread({{2, 2}, {2, 2}});
    expectSpread(std::vector<Place>(50, {1, -1}));
    expectSpread(randomPlaces(300, 1e-3, 1));
    expectSpread(randomPlaces(300, 1e3, 2));
    std::vector<Place> line, clusters = randomPlaces(100, 0.01, 3);
    for (int k = 0; k < 40; ++k) line.push_back({k * k * 0.1, 0});
    for (Place place : randomPlaces(100, 0.01, 4)) clusters.push_back({place[0] + 5, place[1] + 3});
    expectSpread(line);
    expectSpread(clusters);
    EXPECT_TRUE(spreadPlaces({}).empty());
}

TEST(SpreadPlaces, ClustersStayApart) {
    std::vector<Place> places = randomPlaces(30, 0.1, 5);
    for (Place place : randomPlaces(30, 0.1, 6)) places.push_back({place[0] + 4, place[1] + 2});
    const std::vector<Place> spread = spreadPlaces(places);
    const auto before = [](const Place& a, const Place& b) { return a[0] < b[0]; };
    const auto firstEnds = std::max_element(spread.begin(), spread.begin() + 30, before);
    const auto secondBegins = std::min_element(spread.begin() + 30, spread.end(), before);
    EXPECT_LT((*firstEnds)[0], (*secondBegins)[0]);
}

// Over a cone of half angle a about m, the integral of the cosine is pi sin(a)^2 times m's cosine;
// Lambert's albedo is its number, and the mean is over all directions.
TEST(MaterialLook, LambertHasItsAlbedoAndTheCosineOfTheCone) {
    const test::FormulaBrdf lambert([](const Direction&, const Direction&) { return 0.3 / pi; });
    const MaterialLook look = lookOf(lambert, 16);
    for (const double value : look.albedo) EXPECT_NEAR(value, 0.3, 1e-4);
    EXPECT_NEAR(look.luminance, 0.3, 1e-4);
    EXPECT_EQ(look.hue, 0);
    EXPECT_NEAR(look.chroma, 0, 1e-3);
    EXPECT_NEAR(look.gloss, std::pow(std::sin(radians(10)), 2) * std::cos(pi / 4), 1e-4);
    EXPECT_EQ(look.picture.size, 16);
}

/// A lobe exp((cos - 1) / width^2) / cos(theta_i) about the mirror direction, and nothing else.
class MirrorLobe final : public Brdf {
public:
    explicit MirrorLobe(double width) : width_(width) {
        laws_.nonNegative = laws_.isotropic = true;
    }
    std::string name() const override { return "lobe"; }
    const Channels& channels() const override { return channels_; }
    const Laws& laws() const override { return laws_; }
    void eval(const Direction& wo, DirectionBatch wi, double* out) const override {
        for (std::size_t k = 0; k < wi.count; ++k) {
            const double cosine = dot({wi.x[k], wi.y[k], wi.z[k]}, mirrored(wo));
            out[k] = std::exp((cosine - 1) / (width_ * width_)) / wi.z[k];
        }
    }
    std::vector<Lobe> lobes(const Direction& wo) const override {
        return {{.about = Lobe::About::axis, .width = width_, .axis = mirrored(wo)}};
    }

private:
    double width_;
    Channels channels_ = Channels::grey();
    Laws laws_;
};

// The integral of exp((cos - 1) / w^2) over a cone of half angle a is proportional to
// 1 - exp((cos(a) - 1) / w^2).
TEST(MaterialLook, GlossIsTheShareOfTheLobeWithinTenDegrees) {
    for (const double width : {0.03, 0.07, 0.1, 0.2}) {
        const double share = 1 - std::exp((std::cos(radians(10)) - 1) / (width * width));
        EXPECT_NEAR(lookOf(MirrorLobe(width), 8).gloss, share, 0.005) << width;
    }
}

/// A surface of one albedo in R, G and B.
class Coloured final : public Brdf {
public:
    explicit Coloured(LinearRgb albedo) : albedo_(albedo) {
        laws_.nonNegative = laws_.isotropic = true;
    }
    std::string name() const override { return "coloured"; }
    const Channels& channels() const override { return channels_; }
    const Laws& laws() const override { return laws_; }
    void eval(const Direction&, DirectionBatch wi, double* out) const override {
        for (std::size_t k = 0; k < 3 * wi.count; ++k) out[k] = albedo_[k / wi.count] / pi;
    }

private:
    LinearRgb albedo_;
    Channels channels_ = Channels::rgb();
    Laws laws_;
};

TEST(MaterialLook, HuesOfThePrimariesAreThoseOfCieLab) {
    // Lindbloom's calculator, sRGB without adaptation: L*C*h of red, green and blue.
    const struct {
        LinearRgb albedo;
        double luminance, chroma, hue;
    } known[] = {{{1, 0, 0}, 0.2126, 104.55, 40.0},
                 {{0, 1, 0}, 0.7152, 119.78, 136.0},
                 {{0, 0, 1}, 0.0722, 133.81, 306.3}};
    for (const auto& one : known) {
        const MaterialLook look = lookOf(Coloured(one.albedo), 8);
        EXPECT_NEAR(look.luminance, one.luminance, 1e-3);
        EXPECT_NEAR(look.chroma, one.chroma, 0.2);
        EXPECT_NEAR(look.hue, one.hue, 0.2);
    }
}

}  // namespace
}  // namespace hshfit::material_library
