// The principled BRDF, generalised Trowbridge-Reitz, sheen, spherical Gaussians and facets with
// exact Fresnel reflectance, against the formulas as they are printed.

#include "models_angles.h"

#include <brdfs/analytic/fresnel.h>
#include <fmt/format.h>

#include <gtest/gtest.h>
#include <hshfit/error.h>

namespace hshfit::brdfs {
namespace {

using std::cos, std::sin, std::tan, std::exp, std::pow, std::sqrt, std::log;

double mix(double a, double b, double t) {
    return a * (1 - t) + b * t;
}
double schlick(double c) {
    return pow(1 - c, 5);
}

/// Burley's D for gamma other than 1, and for 1.
double gtrDensity(double theta, double alpha, double gamma) {
    const double a2 = alpha * alpha;
    const double c = gamma == 1 ? (a2 - 1) / (pi * log(a2))
                                : (gamma - 1) * (a2 - 1) / (pi * (1 - pow(a2, 1 - gamma)));
    return c / pow(a2 * square(cos(theta)) + square(sin(theta)), gamma);
}

/// G1 that the BRDF has: its lobe for wi at the normal, where Lambda is 0, over D / (4 cos).
double maskingOf(const Brdf& brdf, double alpha, double gamma, const Direction& wo) {
    const double theta = polarAngle(wo) / 2;  // of the half vector
    return evaluate(brdf, {0, 0, 1}, wo)[0] * 4 * wo.z / gtrDensity(theta, alpha, gamma);
}

// Normalised, and masked so that exactly the projected area is seen:
// integral max(0, h.wo) D = cos(theta_o)/G1.
TEST(Formulas, GtrIsADistributionWithItsOwnMasking) {
    for (const double gamma : {.5, 1., 3., 10.})
        for (const double alpha : {.05, .6}) {
            SCOPED_TRACE(fmt::format("gamma {} alpha {}", gamma, alpha));
            EXPECT_NEAR(overHalfVectors([&](double theta, double) {
                            return gtrDensity(theta, alpha, gamma) * cos(theta);
                        }),
                        1, 1e-6);
            const auto brdf = open(fmt::format("gtr:alpha={},gamma={}", alpha, gamma));
            for (const double thetaO : {.2, 1., 1.4, 1.55}) {
                const Direction wo = directionFromAngles(thetaO, .4);
                const double area = overHalfVectors([&](double theta, double phi) {
                    return std::max(0., cos(theta) * wo.z + sin(theta) * sin(thetaO) * cos(phi)) *
                           gtrDensity(theta, alpha, gamma);
                });
                EXPECT_NEAR(wo.z / maskingOf(*brdf, alpha, gamma, wo), area, 2e-4 * area);
            }
        }
}

TEST(Formulas, GtrOfGamma2IsGgx) {
    for (const std::string alpha : {"1e-4", ".05", ".4", "1"})
        for (const std::string rest : {"", ",masking=separable", ",F0=.1,kd=.2"}) {
            const auto gtr = open("gtr:gamma=2,alpha=" + alpha + rest);
            const auto ggx = open("ggx:alpha=" + alpha + rest);
            for (const Pair& p : ordinaryPairs(42)) {
                const double expected = evaluate(*ggx, p.wi, p.wo)[0];
                EXPECT_NEAR(evaluate(*gtr, p.wi, p.wo)[0], expected, 1e-11 * expected);
            }
        }
}

TEST(Formulas, GtrLimitsAreSmooth) {
    const Direction wi = directionFromAngles(.5, 1), wo = directionFromAngles(.7, 3.5);
    const auto value = [&](double gamma, double alpha) {
        return evaluate(*open(fmt::format("gtr:gamma={},alpha={}", gamma, alpha)), wi, wo)[0];
    };
    EXPECT_NEAR(value(1 + 1e-7, .3) / value(1, .3), 1, 1e-6);
    EXPECT_NEAR(value(1.5, 1 - 1e-9) / value(1.5, 1), 1, 1e-8);
    EXPECT_NEAR(value(1, 1 - 1e-9) / value(1, 1), 1, 1e-8);
    // alpha = 1 is D = 1/pi for every gamma.
    EXPECT_NEAR(value(.5, 1) / value(5, 1), 1, 1e-9);
}

TEST(Formulas, SphericalGaussian) {
    expectFormula("sg:kd=.1,ks=.6,sharpness=30",
                  [](const Angles& a) { return .1 / pi + .6 * exp(30 * (a.cosAlpha() - 1)); });
    expectFormula("sg:ks=.6,sharpness=30,axis=normal,normalized=true", [](const Angles& a) {
        return .6 * 30 / (2 * pi * (1 - exp(-60.))) / 4 * exp(30 * (cos(a.thetaH) - 1));
    });
    expectFormula("sg:sharpness=0,normalized=true", [](const Angles&) { return 1 / (4 * pi); });
}

/// Table of Estevez & Kulla 2017 and their interpolation between its rows.
double sheenLambda(double theta, double r) {
    const double p0[] = {25.3245, 3.32435, .16801, -1.27393, -4.85967};
    const double p1[] = {21.5473, 3.82987, .19823, -1.97760, -4.32054};
    double p[5];
    for (int i = 0; i < 5; ++i) p[i] = mix(p1[i], p0[i], square(1 - r));
    const auto l = [&](double x) { return p[0] / (1 + p[1] * pow(x, p[2])) + p[3] * x + p[4]; };
    const double x = cos(theta);
    return x < .5 ? exp(l(x)) : exp(2 * l(.5) - l(1 - x));
}

TEST(Formulas, Charlie) {
    for (const double r : {.15, .5, 1.})
        for (const bool soft : {false, true}) {
            const std::string spec =
                fmt::format("charlie:ks=.6,r={}{}", r, soft ? ",terminator=soft" : "");
            expectFormula(spec, [&](const Angles& a) {
                const double d = (2 + 1 / r) * pow(sin(a.thetaH), 1 / r) / (2 * pi);
                double li = sheenLambda(a.thetaI, r);
                if (soft) li = pow(li, 1 + 2 * pow(1 - cos(a.thetaI), 8));
                const double g = 1 / (1 + li + sheenLambda(a.thetaO, r));
                return .6 * d * g / (4 * cos(a.thetaI) * cos(a.thetaO));
            });
        }
}

// D is normalised, and the fitted Lambda is near the Smith masking of D.
TEST(Formulas, CharlieFitsItsDistribution) {
    for (const double r : {.1, .3, .6, 1.}) {
        const auto density = [&](double theta) {
            return (2 + 1 / r) * pow(sin(theta), 1 / r) / (2 * pi);
        };
        EXPECT_NEAR(overHalfVectors([&](double t, double) { return density(t) * cos(t); }), 1,
                    1e-5);
        for (const double thetaO : {.3, .8, 1.2}) {
            const double area = overHalfVectors([&](double t, double phi) {
                return std::max(0., cos(t) * cos(thetaO) + sin(t) * sin(thetaO) * cos(phi)) *
                       density(t);
            });
            EXPECT_NEAR(cos(thetaO) * (1 + sheenLambda(thetaO, r)) / area, 1, .1)
                << r << " " << thetaO;
        }
    }
}

/// Burley's, channel by channel, in angles.
struct Principled {
    std::vector<double> base{.8, .5, .2};
    double subsurface = 0, metallic = 0, specular = .5, specularTint = 0, roughness = .5,
           anisotropic = 0, sheen = 0, sheenTint = .5, clearcoat = 0, clearcoatGloss = 1;
    bool first = false;  ///< masking of 2012

    std::string spec() const {
        return fmt::format(
            "disney:baseColor={}/{}/{},subsurface={},metallic={},specular={},specularTint={},"
            "roughness={},anisotropic={},sheen={},sheenTint={},clearcoat={},clearcoatGloss={}{}",
            base[0], base[1], base[2], subsurface, metallic, specular, specularTint, roughness,
            anisotropic, sheen, sheenTint, clearcoat, clearcoatGloss, first ? ",masking=2012" : "");
    }

    static double smith(double theta, double alpha) {  // G1
        return 2 / (1 + sqrt(1 + square(alpha * tan(theta))));
    }

    double value(const Angles& a, std::size_t c) const {
        const double ci = cos(a.thetaI), co = cos(a.thetaO), fh = schlick(a.cosHO);
        const double luminance = .3 * base[0] + .6 * base[1] + .1 * base[2];
        const double tint = base[c] / luminance;
        const double c0 = mix(.08 * specular * mix(1, tint, specularTint), base[c], metallic);
        const auto both = [&](double f90) {
            return mix(1, f90, schlick(ci)) * mix(1, f90, schlick(co));
        };
        const double diffuse = both(.5 + 2 * roughness * square(a.cosHO));
        const double ss = 1.25 * (both(roughness * square(a.cosHO)) * (1 / (ci + co) - .5) + .5);
        const double aspect = sqrt(1 - .9 * anisotropic);
        const double ax = std::max(.001, square(roughness) / aspect);
        const double ay = std::max(.001, square(roughness) * aspect);
        const double sh = sin(a.thetaH), x = sh * cos(a.phiH) / ax, y = sh * sin(a.phiH) / ay;
        const double ds = 1 / (pi * ax * ay * square(x * x + y * y + square(cos(a.thetaH))));
        const auto alpha = [&](double phi) {
            return first ? square(.5 + roughness / 2) : std::hypot(ax * cos(phi), ay * sin(phi));
        };
        const double gs = smith(a.thetaI, alpha(a.phiI)) * smith(a.thetaO, alpha(a.phiO));
        const double coat = gtrDensity(a.thetaH, mix(.1, .001, clearcoatGloss), 1) *
                            smith(a.thetaI, .25) * smith(a.thetaO, .25);
        return (1 - metallic) * (base[c] / pi * mix(diffuse, ss, subsurface) +
                                 sheen * fh * mix(1, tint, sheenTint)) +
               (mix(c0, 1, fh) * ds * gs + .25 * clearcoat * mix(.04, 1, fh) * coat) /
                   (4 * ci * co);
    }
};

TEST(Formulas, Disney) {
    const Principled cases[] = {
        {},
        {.roughness = 1},
        {.subsurface = .7, .roughness = .8},
        {.metallic = 1, .roughness = .3},
        {.metallic = .4, .specular = 1, .specularTint = .6, .roughness = .3, .anisotropic = .7},
        {.sheen = 1, .sheenTint = .2},
        {.roughness = .4, .clearcoat = 1, .clearcoatGloss = .3},
        {.roughness = .4, .anisotropic = .5, .clearcoat = .5, .clearcoatGloss = 1, .first = true},
        {.roughness = 0, .anisotropic = 1},
    };
    for (const Principled& p : cases)
        for (const std::size_t c : {0, 1, 2})
            expectFormula(
                p.spec(), [&](const Angles& a) { return p.value(a, c); }, c);
}

// tests/brdfs/models_fresnel.cpp holds the reflectances to Snell's law.
TEST(Formulas, ExactFresnelOnFacets) {
    const auto mirror = [](const std::string& model) { return model + ":alpha=.3"; };
    for (const std::string model : {"ggx", "beckmann"}) {
        const auto full = open(mirror(model));  // F = 1
        const auto glass = open(mirror(model) + ",fresnel=dielectric,ior=1.5");
        const auto dense = open(mirror(model) + ",fresnel=dielectric,ior=.7");
        const auto gold = open(mirror(model) + ",fresnel=conductor,ior=.2/.4/1.3,k=3.3");
        ASSERT_EQ(gold->channels().kind, Channels::Kind::rgb);
        for (const Pair& p : ordinaryPairs(43)) {
            const double f = evaluate(*full, p.wi, p.wo)[0];
            const double c = sqrt((1 + dot(p.wi, p.wo)) / 2);
            EXPECT_NEAR(evaluate(*glass, p.wi, p.wo)[0], f * dielectricReflectance(c, 1.5),
                        1e-12 * f);
            EXPECT_NEAR(evaluate(*dense, p.wi, p.wo)[0], f * dielectricReflectance(c, .7),
                        1e-6 * f);  // steep at the critical angle
            const std::vector<double> colour = evaluate(*gold, p.wi, p.wo);
            const double ior[] = {.2, .4, 1.3};
            for (int k = 0; k < 3; ++k)
                EXPECT_NEAR(colour[k], f * conductorReflectance(c, ior[k], 3.3), 1e-12 * f);
        }
    }
}

TEST(Formulas, CookTorranceOfMetals) {
    const auto full = open("cook-torrance:m=.3");
    const auto copper = open("cook-torrance:m=.3,fresnel=conductor,ior=.2/.9/1.1,k=3.9/2.5/2.1");
    const auto dense = open("cook-torrance:m=.3,ior=.7");
    const double ior[] = {.2, .9, 1.1}, k[] = {3.9, 2.5, 2.1};
    for (const Pair& p : ordinaryPairs(44)) {
        const double f = evaluate(*full, p.wi, p.wo)[0], c = sqrt((1 + dot(p.wi, p.wo)) / 2);
        const std::vector<double> colour = evaluate(*copper, p.wi, p.wo);
        for (int i = 0; i < 3; ++i)
            EXPECT_NEAR(colour.at(i), f * conductorReflectance(c, ior[i], k[i]), 1e-12 * f);
        EXPECT_NEAR(evaluate(*dense, p.wi, p.wo)[0], f * dielectricReflectance(c, .7), 1e-6 * f);
    }
    for (const std::string rest : {"fresnel=conductor,ior=1", "fresnel=conductor,k=1", "k=1",
                                   "fresnel=schlick,k=1", "F0=.5,ior=1.5"})
        EXPECT_THROW(open("cook-torrance:m=.3," + rest), UsageError) << rest;
}

TEST(Formulas, FresnelKeysThatDoNotBelongTogetherAreNamed) {
    const auto expectRefused = [](const std::string& rest, const std::string& part) {
        const std::string spec = "ggx:alpha=.3," + rest;
        try {
            open(spec);
            ADD_FAILURE() << spec << " opened";
        } catch (const UsageError& error) {
            EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
        }
    };
    expectRefused("ior=1.5", "fresnel=schlick takes no ior");
    expectRefused("k=3", "fresnel=schlick takes no k");
    expectRefused("fresnel=dielectric", "fresnel=dielectric needs ior");
    expectRefused("fresnel=dielectric,ior=1.5,F0=1", "fresnel=dielectric takes no F0");
    expectRefused("fresnel=dielectric,ior=1.5,k=1", "fresnel=dielectric takes no k");
    expectRefused("fresnel=conductor,ior=1.5", "fresnel=conductor needs k");
    expectRefused("fresnel=conductor,k=1.5", "fresnel=conductor needs ior");
    expectRefused("fresnel=conductor,ior=1,k=1,F0=.5", "fresnel=conductor takes no F0");
    EXPECT_EQ(open("ggx:alpha=.3,F0=1")->name(), "ggx:alpha=0.3");
}

}  // namespace
}  // namespace hshfit::brdfs
