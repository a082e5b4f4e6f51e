// A picture as a sun and the rest: the sum, the place and size of the sun, pictures without one.
#include "temporary_file.h"
#include "temporary_folder.h"

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/files/exr_picture.h>
#include <hshfit/light/catalog.h>
#include <hshfit/light/light_projection.h>
#include <hshfit/light/picture_layout.h>
#include <hshfit/light/sun_split.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

namespace hshfit {
namespace {

using test::expectInputError;
using Radiance = std::function<Rgb(const Direction&)>;

double angleTo(const Direction& a, const Direction& b) {
    return 2 * std::asin(std::min(std::hypot(a.x - b.x, a.y - b.y, a.z - b.z) / 2, 1.0));
}

/// Brighter towards the horizon, never 0.
Rgb sky(const Direction& d) {
    return {1 - 0.3 * d.z, 1.2 - 0.2 * d.z, 1.5 + 0.1 * d.x};
}

Radiance withDisc(const Direction& centre, double radius, const Rgb& radiance,
                  const Radiance& rest = sky) {
    return [=](const Direction& d) {
        Rgb sum = rest(d);
        for (std::size_t c = 0; c < 3 && angleTo(d, centre) < radius; ++c) sum[c] += radiance[c];
        return sum;
    };
}

class SunSplits : public testing::Test {
protected:
    /// A picture of means over `across` x `across` places a pixel.
    std::string write(const std::string& name, const PictureGeometry& geometry,
                      const Radiance& radiance, std::size_t across = 8) const {
        ExrPicture picture{
            .width = geometry.width, .height = geometry.height, .channels = {"R", "G", "B"}};
        picture.values.resize(3 * geometry.width * geometry.height);
        const auto n = static_cast<double>(across);
        for (std::size_t row = 0; row < geometry.height; ++row)
            for (std::size_t column = 0; column < geometry.width; ++column)
                for (std::size_t k = 0; k < across * across; ++k) {
                    const double x = (static_cast<double>(k % across) + 0.5) / n;
                    const double y = (static_cast<double>(k / across) + 0.5) / n;
                    const Rgb value = radiance(geometry.direction(static_cast<double>(column) + x,
                                                                  static_cast<double>(row) + y));
                    for (std::size_t c = 0; c < 3; ++c)
                        picture.at(row, column, c) += static_cast<float>(value[c] / (n * n));
                }
        const std::string path = folder_ / name;
        AtomicFile file(path);
        writeExrPicture(picture, ExrPixels::single, file);
        file.commit();
        return path;
    }
    std::string writeRestOf(const PictureLight& picture, const SunSplit& split) const {
        const std::string path = folder_ / "rest.exr";
        AtomicFile file(path);
        writeRest(picture, split, file);
        file.commit();
        return path;
    }
    static PictureLight read(const std::string& spec) {
        return std::get<PictureLight>(parseLights(spec).lights.front());
    }
    static std::vector<double> coefficients(const std::string& spec, int order) {
        const auto basis = bases::make("sh", order);
        const LightCoefficients light = projectLight(parseLights(spec).lights, *basis);
        EXPECT_EQ(light.channels.count(), 3U);
        return light.values;
    }
    test::TemporaryFolder folder_;
};

/// Bands 0 agree to rounding. A function of band l changes by at most half of its largest second
/// derivative, l^2 sqrt((2 l + 1) / 4 pi) by Bernstein's inequality, times the square of the angle
/// from the sun's centre, for the disc and for the pixels; bands 1 of one colour agree to rounding.
TEST_F(SunSplits, TheSumHasTheCoefficientsOfThePicture) {
    constexpr int order = 10;
    for (const Rgb& colour : {Rgb{5e4, 5e4, 5e4}, Rgb{6e4, 5e4, 3e4}}) {
        for (const double elevation : {3.0, 41.0, 88.9}) {
            const Direction centre = directionFromAngles(radians(90 - elevation), 2.1);
            const std::string path = write("sun.exr", {.width = 256, .height = 128},
                                           withDisc(centre, radians(1.5), colour));
            const PictureLight picture = read(path);
            const SunSplit split = splitSun(picture);
            EXPECT_LT(angleTo(split.sun.towards, centre), radians(0.2)) << elevation;
            // Coverage of pixels and pixels themselves widen the disc by their sides each way.
            const double across = radians(180.0 / 128);
            const double along = across * std::cos(radians(elevation));
            const double widened =
                std::sqrt(std::pow(radians(1.5), 2) + (across * across + along * along) / 3);
            EXPECT_NEAR(split.sun.radius, widened, 0.12 * widened) << elevation;
            const std::string rest = writeRestOf(picture, split);
            const auto whole = coefficients(path, order);
            const auto sum = coefficients(rest + " + " + sunSpecification(split), order);
            constexpr std::size_t slots = order * order;
            const double farthest = split.sun.radius + radians(3);
            for (std::size_t c = 0; c < 3; ++c) {
                const double flux = split.irradiance[c];
                const double scale = whole[c * slots];
                EXPECT_NEAR(sum[c * slots], scale, 1e-6 * scale);
                for (int l = 0; l < order; ++l) {
                    const double bound =
                        l * l * std::sqrt((2 * l + 1) / (4 * pi)) * flux * farthest * farthest;
                    for (int k = l * l; k < (l + 1) * (l + 1); ++k) {
                        const std::size_t at = c * slots + static_cast<std::size_t>(k);
                        // The sky about the sun is not of the sun's colour, which moves the
                        // centres of the channels a little apart.
                        const double limit = l < 2 ? 3e-6 * scale : bound;
                        EXPECT_NEAR(sum[at], whole[at], limit) << l << " " << c;
                    }
                }
            }
        }
    }
}

/// For any surface with the whole sun above its horizon, the irradiance that the rest of the
/// picture lacks is the irradiance by the sun that was split off.
TEST_F(SunSplits, IrradiancesOfBothPartsAddUp) {
    const Direction centre = directionFromAngles(radians(50), -0.7);
    const PictureGeometry geometry{.width = 128, .height = 64};
    const std::string path =
        write("sun.exr", geometry, withDisc(centre, radians(4), {900, 900, 900}));
    const PictureLight picture = read(path);
    const SunSplit split = splitSun(picture);
    const PictureLight rest = read(writeRestOf(picture, split));
    for (const Direction& n : {Direction{0, 0, 1}, centre, Direction{0.6, 0, 0.8}}) {
        // Nodes of 40 x 40 in each pixel, independent of the library's moments.
        double difference = 0, whole = 0;
        for (const FilledPixel& pixel : split.rest)
            for (int k = 0; k < 1600; ++k) {
                const double row = static_cast<double>(pixel.row) + (k / 40 + 0.5) / 40;
                const double column = static_cast<double>(pixel.column) + (k % 40 + 0.5) / 40;
                const Direction d = geometry.direction(column, row);
                const double theta = pi * row / 64;
                const double solidAngle = std::sin(theta) * pi / 64 * 2 * pi / 128 / 1600;
                const std::size_t at = 3 * (pixel.row * 128 + pixel.column);
                difference +=
                    (static_cast<double>(picture.rgb[at]) - static_cast<double>(rest.rgb[at])) *
                    dot(d, n) * solidAngle;
            }
        whole = split.irradiance[0] * dot(split.sun.towards, n);
        EXPECT_NEAR(difference, whole, 3e-4 * whole);
    }
    for (std::size_t k = 0; k < picture.rgb.size(); ++k) EXPECT_LE(rest.rgb[k], picture.rgb[k]);
}

/// All pixels but the sun's are as in the picture; the sun's are like the sky about it.
TEST_F(SunSplits, TheRestIsThePictureWithTheSkyInPlaceOfTheSun) {
    const Direction centre = directionFromAngles(radians(50), -0.7);
    const std::string path = write("sun.exr", {.width = 256, .height = 128},
                                   withDisc(centre, radians(2), {5e3, 5e3, 5e3}));
    const PictureLight picture = read(path);
    const SunSplit split = splitSun(picture);
    const PictureLight rest = read(writeRestOf(picture, split));
    std::size_t others = 0;
    for (std::size_t row = 0; row < 128; ++row)
        for (std::size_t column = 0; column < 256; ++column) {
            const std::size_t at = 3 * (row * 256 + column);
            const bool same = std::equal(picture.rgb.begin() + static_cast<std::ptrdiff_t>(at),
                                         picture.rgb.begin() + static_cast<std::ptrdiff_t>(at + 3),
                                         rest.rgb.begin() + static_cast<std::ptrdiff_t>(at));
            if (!same) ++others;
            const Rgb expected = sky(geometryOf(picture).direction(
                static_cast<double>(column) + 0.5, static_cast<double>(row) + 0.5));
            for (std::size_t c = 0; c < 3; ++c)
                EXPECT_NEAR(rest.rgb[at + c], expected[c], 2e-3 * expected[c]);
        }
    EXPECT_LE(others, split.rest.size());
    EXPECT_GT(others, 5U);
    const auto parsed = std::get<DiscLight>(parseLights(sunSpecification(split)).lights[0]);
    EXPECT_LT(angleTo(parsed.towards, split.sun.towards), 1e-12);
    EXPECT_NEAR(parsed.radiance[1], split.sun.radiance[1], 1e-9 * split.sun.radiance[1]);
}

TEST_F(SunSplits, EveryLayoutAndPlacementIsSplit) {
    const Direction centre = directionFromAngles(radians(55), 0.9);
    struct Case {
        PictureLayout layout;
        std::size_t width, height;
        std::string options;
    };
    for (const Case& one : {Case{PictureLayout::latlong, 128, 64, "turn=40"},
                            Case{PictureLayout::cross, 128, 96, "layout=cross,mirror=yes"},
                            Case{PictureLayout::faces, 192, 32, "layout=faces,tilt=70,turn=10"},
                            Case{PictureLayout::angular, 96, 96, "layout=angular,scale=3"},
                            Case{PictureLayout::mirrorBall, 128, 128, "layout=mirror-ball"},
                            Case{PictureLayout::dome, 96, 96, "layout=dome,turn=-100"},
                            Case{PictureLayout::equalArea, 96, 96, "layout=equal-area"}}) {
        const PictureGeometry geometry{one.layout, one.width, one.height};
        const std::string path =
            write("sun.exr", geometry, withDisc(centre, radians(2.5), {4e3, 4e3, 4e3}), 16);
        const PictureLight picture = read(path + ":" + one.options);
        const SunSplit split = splitSun(picture);
        EXPECT_LT(angleTo(split.sun.towards, toWorld(picture, centre)), radians(1)) << one.options;
        // Pixels of up to 3.75 degrees widen it.
        EXPECT_GT(split.sun.radius, radians(2.3)) << one.options;
        EXPECT_LT(split.sun.radius, radians(4.5)) << one.options;
        const double flux = 4e3 * picture.scale * pi * std::pow(std::sin(radians(2.5)), 2);
        EXPECT_NEAR(split.irradiance[1], flux, 0.1 * flux) << one.options;
        const std::string rest = writeRestOf(picture, split);
        std::string placement = one.options;
        if (const std::size_t at = placement.find(",scale"); at != std::string::npos)
            placement.resize(at);
        const auto sum = coefficients(rest + ":" + placement + " + " + sunSpecification(split), 2);
        const auto whole = coefficients(path + ":" + one.options, 2);
        for (std::size_t c = 0; c < 3; ++c)
            for (std::size_t k = 0; k < 4; ++k)
                EXPECT_NEAR(sum[4 * c + k], whole[4 * c + k], 1e-5 * whole[4 * c]) << one.options;
    }
}

/// A single pixel that outshines the sun is not taken for it: its flux is less.
TEST_F(SunSplits, TheLargestFluxDecidesAmongBrightParts) {
    const Direction centre = directionFromAngles(radians(60), 1);
    const Direction other = directionFromAngles(radians(70), -2);
    const PictureGeometry geometry{.width = 256, .height = 128};
    const auto [column, row] = geometry.position(other);
    const Direction middle = geometry.direction(std::floor(column) + 0.5, std::floor(row) + 0.5);
    const Radiance both = withDisc(middle, radians(0.5), {9e4, 9e4, 9e4},
                                   withDisc(centre, radians(2.5), {2e4, 2e4, 2e4}));
    const SunSplit split = splitSun(read(write("two.exr", geometry, both)));
    EXPECT_LT(angleTo(split.sun.towards, centre), radians(0.3));
}

TEST_F(SunSplits, PicturesWithoutASunAreNamed) {
    const PictureGeometry geometry{.width = 128, .height = 64};
    const Direction centre = directionFromAngles(radians(50), 0.3);
    const auto refused = [&](const std::string& name, const Radiance& radiance,
                             const std::string& why) {
        const std::string path = write(name, geometry, radiance, 2);
        const PictureLight picture = read(path);
        expectInputError([&] { splitSun(picture); }, {path, "has no sun", why});
    };
    refused("sky.exr", sky, "times the luminance around it");
    refused(
        "black.exr", [](const Direction&) { return Rgb{}; }, "black");
    refused("faint.exr", withDisc(centre, radians(3), {80, 80, 80}), "a sun has 100 times");
    refused("panel.exr", withDisc(centre, radians(9), {9e4, 9e4, 9e4}), "lamp or a window");
    refused("wide.exr", withDisc(centre, radians(40), {9e4, 9e4, 9e4}), "its brightest");
    // A lamp in a black room is a sun.
    const auto dark = [](const Direction&) { return Rgb{}; };
    const SunSplit split =
        splitSun(read(write("lamp.exr", geometry, withDisc(centre, radians(4), {1, 1, 1}, dark))));
    EXPECT_LT(angleTo(split.sun.towards, centre), radians(0.5));
    EXPECT_EQ(split.surroundings, 0);
}

}  // namespace
}  // namespace hshfit
