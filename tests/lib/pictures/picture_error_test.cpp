// The picture error against closed forms: scaled and tinted materials, and dips and peaks that are
// put into a highlight.

#include <hshfit/pictures/internal/false_extrema.h>
#include <hshfit/pictures/internal/highlight_lines.h>
#include <hshfit/pictures/internal/picture_lights.h>
#include <hshfit/pictures/picture_error.h>
#include <hshfit/pictures/poor.h>
#include <hshfit/pictures/sphere_albedo.h>
#include <hshfit/representation/forms/form.h>
#include <hshfit/representation/forms/represented_brdf.h>

#include "lib/formula_brdf.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace hshfit {
namespace {

using test::FormulaBrdf;

double tanHalf(const Direction& wi, const Direction& wo) {
    return std::hypot(wi.x + wo.x, wi.y + wo.y) / (wi.z + wo.z);
}

/// A Lambert surface below a Gaussian lobe about the half vector, times `factor` of the tangent of
/// theta_h and theta_o.
template <class Factor>
FormulaBrdf glossy(const Factor& factor) {
    return FormulaBrdf([factor](const Direction& wi, const Direction& wo) {
        const double t = tanHalf(wi, wo);
        return (0.1 / pi + std::exp(-t * t / 0.02)) * factor(t, polarAngle(wo));
    });
}

FormulaBrdf scaled(double factor) {
    return glossy([factor](double, double) { return factor; });
}

/// A dip of relative depth `depth` at the middle of the highlight; a peak if it is negative.
FormulaBrdf dotted(double depth) {
    return glossy([depth](double t, double) { return 1 - depth * std::exp(-t * t / 0.0005); });
}

/// R, G and B as three multiples of one function.
class Tinted : public FormulaBrdf {
public:
    Tinted(const FormulaBrdf& grey, std::array<double, 3> tint)
        : FormulaBrdf([](const Direction&, const Direction&) { return 0.0; }, {},
                      {.isotropic = true}, Channels::rgb()),
          grey_(grey),
          tint_(tint) {}
    void eval(const Direction& wo, DirectionBatch wi, double* out) const override {
        grey_.eval(wo, wi, out);
        for (std::size_t c = 3; c-- > 0;)  // the first channel, which the others come from, last
            for (std::size_t k = 0; k < wi.count; ++k) out[c * wi.count + k] = out[k] * tint_[c];
    }

private:
    FormulaBrdf grey_;
    std::array<double, 3> tint_;
};

TEST(PictureError, OfABrdfAgainstItselfIsZero) {
    const PictureError error = pictureError(scaled(1), scaled(1));
    EXPECT_EQ(error.flip.mean, 0);
    EXPECT_EQ(error.colour.largest, 0);
    EXPECT_EQ(error.dip.value, 0);
    EXPECT_EQ(error.peak.value, 0);
    EXPECT_EQ(error.ridge.value, 0);
    EXPECT_EQ(error.albedo, std::vector<double>{0});
    EXPECT_EQ(error.channels, std::vector<std::string>{"grey"});
    EXPECT_FALSE(poorReason(1, error));
}

TEST(PictureError, OfAScaledBrdfIsItsFactorInAlbedoAndRidgeAndNoExtremum) {
    const PictureReference source(scaled(1));
    double flip = 0, colour = 0;
    for (const double factor : {1.02, 1.05, 1.25}) {
        const PictureError error = source.errorOf(scaled(factor));
        EXPECT_NEAR(error.albedo[0], factor - 1, 1e-9);
        EXPECT_NEAR(error.lastAlbedo[0], factor - 1, 1e-9);
        EXPECT_NEAR(error.ridge.value, factor - 1, 1e-9);
        // The floor of the logarithm scales with f but for 1e-3.
        EXPECT_LT(error.dip.value, 0.03 * (factor - 1));
        EXPECT_LT(error.peak.value, 0.03 * (factor - 1));
        EXPECT_GT(error.flip.mean, flip);
        EXPECT_GT(error.colour.mean, colour);
        EXPECT_GE(error.flip.largest, error.flip.mean);
        flip = error.flip.mean;
        colour = error.colour.mean;
    }
    EXPECT_LT(source.errorOf(scaled(0.9)).albedo[0], 0);
}

TEST(PictureError, SeesADotInTheHighlightOnEitherSide) {
    const PictureReference source(scaled(1));
    for (const double depth : {0.2, 0.5, 0.95}) {
        const PictureError dip = source.errorOf(dotted(depth));
        // The shoulder is the highest f about the dot, of which f at the normal lacks this share.
        double shoulder = 0;
        for (double t = 0; t < 1; t += 1e-4)
            shoulder = std::max(shoulder, (0.1 / pi + std::exp(-t * t / 0.02)) *
                                              (1 - depth * std::exp(-t * t / 0.0005)));
        const double middle = (0.1 / pi + 1) * (1 - depth);
        const double floor = 1e-3;  // and a twentieth of each, in the logarithm
        EXPECT_NEAR(dip.dip.value, 1 - (1.05 * middle + floor) / (1.05 * shoulder + floor), 2e-3);
        EXPECT_LT(dip.peak.value, 0.02);
        EXPECT_NEAR(tanHalf(dip.dip.at.wi, dip.dip.at.wo), 0, 1e-9);
        EXPECT_NEAR(dip.ridge.value, depth, 1e-9);
        EXPECT_TRUE(poorReason(1, dip));
        // The other way round the source has a dip where the form has none: no false dip; a peak
        // within the dip's width of a highlight that is a peak itself is not false.
        const PictureError none = pictureError(dotted(depth), scaled(1));
        EXPECT_LT(none.dip.value, 0.02);
    }
}

TEST(PictureError, ADipThatTheSourceHasIsNotFalse) {
    const auto ringed = [](double depth) {
        return glossy([depth](double t, double) {
            return 1 - depth * std::exp(-(t - 0.2) * (t - 0.2) / 0.002);
        });
    };
    EXPECT_LT(pictureError(ringed(0.3), ringed(0.35)).dip.value, 0.02);
    EXPECT_GT(pictureError(scaled(1), ringed(0.95)).dip.value, 0.4);
    // Beyond twice the source's own depth it is.
    EXPECT_GT(pictureError(ringed(0.05), ringed(0.95)).dip.value, 0.2);
}

TEST(PictureError, NamesTheChannelAndTheLight) {
    const FormulaBrdf grey = scaled(1);
    const PictureError error =
        pictureError(Tinted(grey, {0.8, 0.7, 0.6}), Tinted(grey, {0.8, 0.7, 0.66}));
    ASSERT_EQ(error.channels, (std::vector<std::string>{"R", "G", "B"}));
    EXPECT_NEAR(error.albedo[0], 0, 1e-9);
    EXPECT_NEAR(error.albedo[2], 0.1, 1e-9);
    EXPECT_EQ(error.ridge.channel, "B");
    EXPECT_NEAR(error.ridge.value, 0.1, 1e-9);
    EXPECT_GT(error.colour.mean, 0.5);
    bool known = false;
    for (const PictureLight& light : pictureLights()) known |= light.name == error.flip.light;
    EXPECT_TRUE(known) << error.flip.light;
    // A grey BRDF has its value in each channel.
    EXPECT_NEAR(pictureError(grey, Tinted(grey, {1, 1, 1})).flip.mean, 0, 1e-9);
}

TEST(PictureError, ValuesThatAreNotFiniteCountAsZero) {
    const PictureError error =
        pictureError(scaled(1), glossy([](double t, double) { return t < 0.01 ? NAN : 1.0; }));
    EXPECT_EQ(error.ridge.value, 1);
    EXPECT_GT(error.dip.value, 0.9);
    for (const double value : {error.flip.mean, error.colour.mean, error.albedo[0]})
        EXPECT_TRUE(std::isfinite(value));
    EXPECT_TRUE(std::isfinite(pictureError(scaled(0), scaled(0)).flip.mean));
}

/// The albedo for one outgoing direction by the midpoint rule, even in cos(theta_i) and azimuth.
double albedoByMidpoints(const Brdf& brdf, const Direction& wo) {
    constexpr int rings = 900, azimuths = 1800;
    std::vector<double> x(azimuths), y(azimuths), z(azimuths), f(azimuths);
    double sum = 0;
    for (int r = 0; r < rings; ++r) {
        const double mu = (r + 0.5) / rings, s = std::sqrt(1 - mu * mu);
        for (std::size_t a = 0; a < azimuths; ++a) {
            const double phi = 2 * pi * (static_cast<double>(a) + 0.5) / azimuths;
            x[a] = s * std::cos(phi);
            y[a] = s * std::sin(phi);
            z[a] = mu;
        }
        brdf.eval(wo, {x.data(), y.data(), z.data(), azimuths}, f.data());
        for (const double value : f) sum += mu * value;
    }
    return sum * 2 * pi / (double{rings} * azimuths);
}

TEST(PictureError, AlbedoTablesOfTheHalfwayFormResolveItsHighlights) {
    const FormulaBrdf narrow([](const Direction& wi, const Direction& wo) {
        const double t = tanHalf(wi, wo);
        return 0.02 + 20 * std::exp(-t * t / 0.005);
    });
    const auto form = reconstruct(
        represent(narrow, {.kind = Representation::Kind::halfway, .halfway = {12, 4, 1}},
                  [](const std::string&) { return std::unique_ptr<Brdf>(); }),
        [](const std::string&) { return std::unique_ptr<Brdf>(); });
    const AlbedoTable table(*form);
    for (const double theta : {0.0, 20.0, 45.0, 70.0}) {
        const Direction wo = directionFromAngles(radians(theta), 0);
        double albedo = 0;
        table.at(wo, {&albedo, 1});
        EXPECT_NEAR(albedo, albedoByMidpoints(*form, wo), 0.02 * albedo) << theta;
    }
}

TEST(PictureError, TheSameWhateverTheThreads) {
    std::vector<PictureError> errors;
    for (const int threads : {1, 4}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        errors.push_back(pictureError(scaled(1), dotted(0.4)));
    }
    EXPECT_EQ(errors[0].flip.mean, errors[1].flip.mean);
    EXPECT_EQ(errors[0].colour.mean, errors[1].colour.mean);
    EXPECT_EQ(errors[0].albedo, errors[1].albedo);
}

TEST(PictureLights, AreOneLambertSurfaceEach) {
    // The irradiance of a light, as the brightness that a white sphere has at most.
    for (const PictureLight& light : pictureLights()) {
        double strength = light.rig.dome;
        for (const SphereLight& each : light.rig.lights) {
            strength += each.strength;
            EXPECT_NEAR(dot(each.towards, each.towards), 1, 1e-12) << light.name;
        }
        EXPECT_GE(strength, 1 - 1e-12) << light.name;
        EXPECT_LE(strength, 1.7 + 1e-12) << light.name;
    }
    // Every point of a disc 20 degrees wide is within 10 degrees of its middle.
    for (std::size_t k = 0; k < 8; k += 2)
        for (const SphereLight& each : pictureLights()[k + 1].rig.lights)
            EXPECT_GE(dot(each.towards, pictureLights()[k].rig.lights[0].towards),
                      std::cos(radians(10)));
}

TEST(HighlightLines, HoldWhatTheyName) {
    for (const bool isotropic : {true, false}) {
        std::size_t atNormal = 0;
        for (const HighlightLine& line : highlightLines(isotropic)) {
            ASSERT_EQ(line.angles.size(), line.pairs.size());
            ASSERT_GT(line.angles.size(), 30u);
            bool middle = false;
            for (std::size_t k = 0; k < line.pairs.size(); ++k) {
                const DirectionPair& pair = line.pairs[k];
                if (k > 0) {
                    EXPECT_GT(line.angles[k], line.angles[k - 1]);
                }
                EXPECT_LE(polarAngle(pair.wi), radians(85.001));
                EXPECT_LE(polarAngle(pair.wo), radians(85.001));
                middle |= tanHalf(pair.wi, pair.wo) < 1e-9;
            }
            atNormal += middle ? 1 : 0;
        }
        EXPECT_EQ(atNormal, highlightLines(isotropic).size());
        for (const HighlightLine& line : mirrorRidges(isotropic))
            for (const DirectionPair& pair : line.pairs)
                EXPECT_LT(tanHalf(pair.wi, pair.wo), 1e-12);
    }
}

/// Lights that are left out can only add to the mean.
TEST(PictureError, ABoundOnFlipIsDecidedAsByAllLights) {
    const FormulaBrdf f = scaled(1);
    const PictureReference reference(f);
    for (const FormulaBrdf& g : {scaled(1), scaled(1.02), scaled(0.5), dotted(0.9), dotted(-3)}) {
        const OverLights all = reference.errorOf(g).flip;
        for (const double most : {all.mean * 1.0001 + 1e-9, 1.0}) {
            const std::optional<OverLights> within = reference.flipWithin(g, most);
            ASSERT_TRUE(within);
            EXPECT_NEAR(within->mean, all.mean, 1e-12);
            EXPECT_EQ(within->largest, all.largest);
            EXPECT_EQ(within->light, all.light);
        }
        for (const double most : {all.mean * 0.9999 - 1e-9, all.mean / 20 - 1e-9})
            EXPECT_FALSE(reference.flipWithin(g, most));
    }
}

TEST(FalseDip, IsTheDepthBelowItsOwnShoulders) {
    std::vector<double> angles, flat, notch, skirt;
    for (int k = 0; k <= 60; ++k) {
        angles.push_back(k);
        flat.push_back(0);
        notch.push_back(k == 30 ? -0.7 : 0);
        skirt.push_back(-0.1 * k);  // monotone: no shoulders on one side
    }
    EXPECT_DOUBLE_EQ(falseDip(flat, notch, angles).depth, 0.7);
    EXPECT_EQ(falseDip(flat, notch, angles).at, 30u);
    EXPECT_EQ(falseDip(notch, notch, angles).depth, 0);
    EXPECT_EQ(falseDip(flat, skirt, angles).depth, 0);
    EXPECT_EQ(falseDip(skirt, flat, angles).depth, 0);
    // The form is flat where the source has a peak: lower than the source, but no dip.
    EXPECT_EQ(falseDip(flat, flat, angles).depth, 0);
    // A shallow dip of the source near the same place counts twice; a far one does not.
    std::vector<double> near = flat, far = flat;
    near[27] = far[5] = -0.2;
    EXPECT_NEAR(falseDip(near, notch, angles).depth, 0.7 - 2 * 0.2, 1e-12);
    EXPECT_NEAR(falseDip(far, notch, angles).depth, 0.7, 1e-12);
    EXPECT_NEAR(relativeDepth(std::log(2)), 0.5, 1e-12);
}

TEST(Poor, ByEachOfItsBoundsWithOneReason) {
    const PictureError good{.flip = {.mean = 0.09, .largest = 0.3, .light = "room"},
                            .dip = {.value = 0.09},
                            .peak = {.value = 0.08}};
    EXPECT_FALSE(poorReason(0.91, good));
    // 1 - (relative error)^2 is captured: an error of 1.5 of f captures nothing.
    EXPECT_EQ(poorReason(1 - 1.5 * 1.5, good), "the error is 150 % of f (relative L2)");
    EXPECT_FALSE(poorReason({}, good));
    EXPECT_FALSE(poorReason({}, {}));
    EXPECT_NE(poorReason(0.89, good)->find("89 % of the energy"), std::string::npos);
    PictureError bad = good;
    bad.peak.value = 0.123;
    EXPECT_NE(poorReason(1, bad)->find("false peak of 12 %"), std::string::npos);
    bad = good;
    bad.flip.mean = 0.21;
    EXPECT_NE(poorReason(1, bad)->find("FLIP 0.21"), std::string::npos);
}

}  // namespace
}  // namespace hshfit
