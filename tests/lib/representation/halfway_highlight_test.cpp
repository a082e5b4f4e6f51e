// The halfway form keeps the shape of highlights, and grows nowhere beyond its source.
#include "lib/formula_brdf.h"
#include "places.h"

#include <hshfit/accuracy/pair_sample.h>
#include <hshfit/pictures/picture_error.h>
#include <hshfit/representation/forms/represented_brdf.h>
#include <hshfit/representation/halfway/halfway.h>
#include <hshfit/representation/halfway/halfway_rounding.h>

#include <brdfs/catalog.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <string>
#include <tuple>
#include <vector>

namespace hshfit {
namespace {

using test::FormulaBrdf;

const std::string data = test::sharedFolder() + "/data";

std::unique_ptr<RepresentedBrdf> asBrdf(const Representation& r) {
    return reconstruct(r, [](const std::string&) { return std::unique_ptr<Brdf>(); });
}

const std::vector<HalfwayOrders> named{{5, 4, 3}, {7, 6, 5}, {9, 8, 6}, {}, {13, 12, 8}};

/// Highlights without rings, pinholes and tints, at the orders that docs and `tradeoff` name.
class HalfwayHighlight : public testing::TestWithParam<std::tuple<std::string, std::size_t>> {};

TEST_P(HalfwayHighlight, HasTheShapeOfItsSource) {
    const auto& [spec, size] = GetParam();
    const auto source = brdfs::open(spec);
    Representation form = projectHalfway(*source, named[size]);
    quantiseHalfway(form, Precision::half, *source);
    const PictureError error = pictureError(*source, *asBrdf(form));
    // The two smallest have a quarter and half of a kilobyte.
    const bool small = size < 2;
    EXPECT_LE(error.dip.value, small ? 0.06 : 0.02) << textOf(error);
    EXPECT_LE(error.peak.value, small ? 0.06 : 0.02) << textOf(error);
    EXPECT_LE(error.ridge.value, small ? 0.12 : 0.03) << textOf(error);
    EXPECT_LE(error.flip.mean, small ? 0.06 : 0.02) << textOf(error);
}

INSTANTIATE_TEST_SUITE_P(
    OfPlainMaterials, HalfwayHighlight,
    testing::Combine(testing::Values("ggx:alpha=.25,F0=.9/.6/.3",
                                     "lambert:kd=.35/.02/.03+ggx:alpha=.1,F0=.05",
                                     "disney:roughness=.35,baseColor=.2/.4/.6", "lambert"),
                     testing::Range<std::size_t>(0, 5)));

/// A masked lobe is the model of the catalog where Fresnel's reflectance is 1, but for the shelf.
TEST(HalfwayAxes, WeighAMaskedLobeLikeGgx) {
    constexpr double shelf = 1e-4, turn = 25 * pi / 180;
    const auto ggx = brdfs::open("ggx:ax=0.15,ay=0.4,F0=1");
    const HalfwayAxes axes(
        {.along = 0.15, .across = 0.4, .turn = turn, .shelf = shelf, .masked = true});
    for (const double thetaIn : {0.0, 20.0, 60.0, 85.0, 89.0}) {
        for (const double thetaOut : {1.0, 35.0, 70.0, 88.0}) {
            for (double phi = 0; phi < 360; phi += 17) {
                const Direction wi = directionFromAngles(radians(thetaIn), radians(phi));
                const Direction wo = directionFromAngles(radians(thetaOut), radians(3 * phi + 40));
                const double expected =
                    evaluate(*ggx, rotateAboutZ(wi, -turn), rotateAboutZ(wo, -turn))[0];
                const double found = axes.at(wi, wo).weight;
                // The denominator without the shelf is at least 2 m_i m_o.
                EXPECT_LE(found, expected * (1 + 1e-9));
                EXPECT_GE(found, expected * (1 - 1e-9) / (1 + shelf / (2 * wi.z * wo.z)));
            }
        }
    }
}

/// The masking of a brushed metal depends on the azimuth on its ridge, where no term does: without
/// it in the lobe the ridge was 35 % off.
TEST(HalfwayForms, KeepTheRidgeOfABrushedMetal) {
    const auto source = brdfs::open("ggx:ax=.15,ay=.4,F0=.9/.6/.3");
    Representation form = projectHalfway(*source, {});
    quantiseHalfway(form, Precision::half, *source);
    const PictureError error = pictureError(*source, *asBrdf(form));
    EXPECT_LE(error.dip.value, 0.02) << textOf(error);
    EXPECT_LE(error.peak.value, 0.02) << textOf(error);
    EXPECT_LE(error.ridge.value, 0.03) << textOf(error);
    EXPECT_LE(error.flip.mean, 0.02) << textOf(error);
}

/// At the normal the paint has 0.51, where an earlier form had 0.
TEST(HalfwayForms, HaveTheValueAtTheNormalOfACarPaint) {
    const auto source = brdfs::open("lambert:kd=.35/.02/.03+ggx:alpha=.1,F0=.05");
    const auto form = asBrdf(projectHalfway(*source, {}));
    const Direction normal{0, 0, 1};
    const auto f = evaluate(*source, normal, normal), g = evaluate(*form, normal, normal);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(g[c], f[c], 0.02 * f[c]);
}

/// Eight bits a coefficient cost the eye nothing: the coefficients make up for one another. With
/// one regularisation for all, the second of these had FLIP .28 for .07.
TEST(HalfwayForms, LookTheSameInEightBits) {
    if (!std::filesystem::exists(data)) GTEST_SKIP() << data << " is absent";
    for (const std::string name : {"rgl/cc_ibiza_sunset_rgb.bsdf", "rgl/cg_sunflower_rgb.bsdf",
                                   "merl_slices/chrome-steel.slice"}) {
        const auto source = brdfs::open(data + "/" + name);
        const Representation fitted = projectHalfway(*source, {});
        const auto flip = [&](Precision precision) {
            Representation stored = fitted;
            quantiseHalfway(stored, precision, *source);
            return pictureError(*source, *asBrdf(stored)).flip.mean;
        };
        EXPECT_LE(flip(Precision::unorm8), 1.15 * flip(Precision::float32)) << name;
    }
}

/// The lobe of obsidian lies in the first degree of its table. With albedos at one direction of
/// each stratum alone it swung between them, and its highlight had a black disc.
TEST(HalfwayForms, KeepAHighlightOfLessThanADegree) {
    if (!std::filesystem::exists(data)) GTEST_SKIP() << data << " is absent";
    const auto source = brdfs::open(data + "/merl_slices/black-obsidian.slice");
    const PictureError error = pictureError(*source, *asBrdf(projectHalfway(*source, {})));
    EXPECT_LE(error.dip.value, 0.02) << textOf(error);
    EXPECT_LE(error.peak.value, 0.03) << textOf(error);
    EXPECT_LE(error.flip.mean, 0.24) << textOf(error);
}

/// Three channels in half precision: 46 bytes hold the lobe and the ceilings.
TEST(HalfwayForms, TakeAKilobyteByDefault) {
    for (const bool isotropic : {true, false}) {
        const HalfwayOrders orders = halfwayOrdersOr({}, isotropic, true);
        EXPECT_LE(6 * HalfwayTerms(orders, {isotropic, true, true}).size() + 46, 1024U);
    }
    EXPECT_LE(6 * HalfwayTerms(halfwayOrdersOr({}, true, false), {true, true, false}).size() + 46,
              1024U);
}

double slopeSquared(const Direction& wi, const Direction& wo) {
    const double x = wi.x + wo.x, y = wi.y + wo.y, z = wi.z + wo.z;
    return (x * x + y * y) / (z * z);
}

/// Microfacets with GGX's distribution and, by `power`, (cos_i + cos_o)^power in the denominator:
/// 1 grows towards the horizon as measured metals do.
double facets(const Direction& wi, const Direction& wo, double alpha, double power) {
    const double t = 1 + slopeSquared(wi, wo) / (alpha * alpha);
    return 1 / (pi * alpha * alpha * t * t) / (4 * std::pow(wi.z + wo.z, power));
}

/// A BRDF that is isotropic and mirror symmetric by its formula.
struct Case {
    std::string name;
    std::function<double(const Direction&, const Direction&)> f;
    bool reciprocal = true;
};

const std::vector<Case>& cases() {
    static const std::vector<Case> all{
        {"lambert", [](auto&, auto&) { return 0.2; }},
        {"rough facets", [](auto& i, auto& o) { return 0.05 + facets(i, o, 0.4, 1); }},
        {"narrow facets", [](auto& i, auto& o) { return 0.02 + facets(i, o, 0.05, 1); }},
        {"without shadowing", [](auto& i, auto& o) { return facets(i, o, 0.2, 2); }},
        {"flat", [](auto& i, auto& o) { return 0.1 + facets(i, o, 0.2, 0); }},
        {"minnaert", [](auto& i, auto& o) { return 0.1 / std::sqrt(i.z * o.z); }},
        {"one-sided", [](auto& i, auto& o) { return (0.1 + facets(i, o, 0.2, 0)) / o.z; }, false},
    };
    return all;
}

/// From the normal to 89.9 degrees; equal pairs among them.
const std::vector<double>& elevations() {
    static const std::vector<double> all{0,  0.5, 3,  10, 20,   30,   40,    45,   52,
                                         60, 68,  75, 80, 84.5, 87.3, 88.88, 89.6, 89.9};
    return all;
}

/// The greatest f at two elevations over azimuths about wo, the mirror direction among them.
double greatest(const Brdf& brdf, double thetaIncoming, double thetaOutgoing) {
    std::vector<double> x, y, z;
    for (int k = 0; k <= 90; ++k) {
        const double from = pi * std::pow(k / 90.0, 3);
        for (const double phi : {pi - from, pi + from}) {
            const Direction wi = directionFromAngles(radians(thetaIncoming), phi);
            x.push_back(wi.x);
            y.push_back(wi.y);
            z.push_back(wi.z);
        }
    }
    std::vector<double> values(x.size() * brdf.channels().count());
    brdf.eval(directionFromAngles(radians(thetaOutgoing), 0),
              {x.data(), y.data(), z.data(), x.size()}, values.data());
    return *std::max_element(values.begin(), values.end());
}

class HalfwayBound : public testing::TestWithParam<std::size_t> {};

/// Within twice what the BRDF itself reaches at the same elevations, in every precision; what
/// is darker than a thousandth of the greatest albedo counts as that.
TEST_P(HalfwayBound, HoldsAtEveryPairOfElevations) {
    const Case& each = cases()[GetParam()];
    const FormulaBrdf brdf(
        [&](const Direction& wi, const Direction& wo) {
            return wi.z > 0 && wo.z > 0 ? each.f(wi, wo) : 0.0;
        },
        {},
        {.nonNegative = true,
         .reciprocal = each.reciprocal,
         .isotropic = true,
         .mirrorSymmetric = true});
    const Representation fitted = projectHalfway(brdf, {});
    for (const Precision precision :
         {Precision::float32, Precision::half, Precision::unorm16, Precision::unorm8}) {
        Representation stored = fitted;
        quantiseHalfway(stored, precision, brdf);
        const auto made = asBrdf(stored);
        for (const double i : elevations()) {
            for (const double o : elevations()) {
                EXPECT_LE(greatest(*made, i, o), 2 * greatest(brdf, i, o) + 2e-3)
                    << each.name << " at " << i << ", " << o << " in " << precisionName(precision);
            }
        }
    }
}

INSTANTIATE_TEST_SUITE_P(EveryCase, HalfwayBound, testing::Range<std::size_t>(0, 7));

}  // namespace
}  // namespace hshfit
