// Spheres against closed forms, and pictures as other programs read them.

#include <hshfit/error.h>
#include <hshfit/files/exr_picture.h>
#include <hshfit/pictures/rgb_picture.h>
#include <hshfit/pictures/sphere_picture.h>

#include "lib/blurred_mirror.h"
#include "lib/coefficient_files/coefficient_samples.h"
#include "lib/formula_brdf.h"

#include <gtest/gtest.h>
#include <png.h>
#include <tbb/global_control.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

using namespace hshfit;
using samples::contentOf;
using samples::Folder;
using test::BlurredMirror;
using test::FormulaBrdf;

namespace {

constexpr Laws anisotropic{.mirrorSymmetric = false};

FormulaBrdf lambert(double kd) {
    return FormulaBrdf([kd](const Direction&, const Direction&) { return kd / pi; });
}

/// R, G and B of an 8-bit RGBA file as libpng's row reader gives them, not the simplified writer.
struct Png {
    std::size_t width = 0, height = 0;
    std::vector<unsigned char> rgba;
    bool srgb = false;
};

Png decoded(const std::string& bytes) {
    Png out;
    struct Source {
        const std::string& bytes;
        std::size_t at;
    } source{bytes, 0};
    png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_set_read_fn(png, &source, [](png_structp p, png_bytep to, png_size_t count) {
        auto& from = *static_cast<Source*>(png_get_io_ptr(p));
        if (from.at + count > from.bytes.size()) png_error(p, "short");
        std::memcpy(to, from.bytes.data() + from.at, count);
        from.at += count;
    });
    png_read_png(png, info, PNG_TRANSFORM_IDENTITY, nullptr);
    out.width = png_get_image_width(png, info);
    out.height = png_get_image_height(png, info);
    out.srgb = png_get_valid(png, info, PNG_INFO_sRGB) != 0;
    EXPECT_EQ(png_get_bit_depth(png, info), 8);
    EXPECT_EQ(png_get_color_type(png, info), PNG_COLOR_TYPE_RGBA);
    png_bytepp rows = png_get_rows(png, info);
    for (std::size_t row = 0; row < out.height; ++row) {
        out.rgba.insert(out.rgba.end(), rows[row], rows[row] + 4 * out.width);
    }
    png_destroy_read_struct(&png, &info, nullptr);
    return out;
}

/// (x, y) on the unit disc of a pixel's centre; whether it is on the sphere.
bool onSphere(int row, int column, int size, double& x, double& y) {
    x = (2 * (column + 0.5) / size - 1) / 0.96;
    y = (1 - 2 * (row + 0.5) / size) / 0.96;
    return x * x + y * y < 1;
}

TEST(Sphere, LambertIsTheClosedForm) {
    // L = kd (sum of strength max(0, n.l) + dome): pi of the irradiance goes with kd / pi.
    const double kd = 0.6, dome = 0.3;
    const SphereRig rig{{{directionFromAngles(radians(40), radians(120)), 1.5},
                         {directionFromAngles(radians(110), radians(-60)), 0.5}},
                        dome};
    const SpherePicture sphere = renderSphere(lambert(kd), {.rig = rig, .size = 64, .samples = 1});
    int covered = 0;
    for (int row = 0; row < 64; ++row) {
        for (int column = 0; column < 64; ++column) {
            const std::size_t pixel = static_cast<std::size_t>(row * 64 + column);
            double x = 0, y = 0;
            const bool inside = onSphere(row, column, 64, x, y);
            ASSERT_EQ(sphere.coverage[pixel], inside ? 1 : 0) << row << " " << column;
            double expected = 0;
            if (inside) {
                ++covered;
                const double z = std::sqrt(1 - x * x - y * y);
                const double key = std::sin(radians(40)) *
                                       (std::cos(radians(120)) * x + std::sin(radians(120)) * y) +
                                   std::cos(radians(40)) * z;
                const double fill = std::sin(radians(110)) *
                                        (std::cos(radians(60)) * x - std::sin(radians(60)) * y) +
                                    std::cos(radians(110)) * z;
                expected = kd * (1.5 * std::max(0.0, key) + 0.5 * std::max(0.0, fill) + dome);
            }
            for (std::size_t c = 0; c < 3; ++c) {
                ASSERT_NEAR(sphere.radiance[3 * pixel + c], expected, 2e-6) << row << " " << column;
            }
        }
    }
    // The area of a disc of radius 0.96 / 2 in pixels.
    EXPECT_NEAR(covered, pi * 0.48 * 0.48 * 64 * 64, 40);
}

TEST(Sphere, TheFrameIsTheDocumentedOne) {
    // f = wi.x shows the light's part along the tangent (n.z, 0, -n.x) / |…|, f = wi.y that along
    // the bitangent n x t.
    const Direction light = directionFromAngles(radians(30), radians(50));
    for (const bool bitangent : {false, true}) {
        const FormulaBrdf f(
            [=](const Direction& wi, const Direction&) { return bitangent ? wi.y : wi.x; }, {},
            anisotropic);
        const SpherePicture sphere =
            renderSphere(f, {.rig = {{{light, 1}}, 0}, .size = 32, .samples = 1});
        int compared = 0;
        for (int row = 0; row < 32; ++row) {
            for (int column = 0; column < 32; ++column) {
                double x = 0, y = 0;
                if (!onSphere(row, column, 32, x, y)) continue;
                const double z = std::sqrt(1 - x * x - y * y), l = std::sqrt(x * x + z * z);
                const double cosine = light.x * x + light.y * y + light.z * z;
                if (cosine <= 0) continue;
                const double t = (light.x * z - light.z * x) / l;
                const double b = (-light.x * x * y + light.y * l * l - light.z * y * z) / l;
                const auto pixel = static_cast<std::size_t>(row * 32 + column);
                EXPECT_NEAR(sphere.radiance[3 * pixel], pi * cosine * (bitangent ? b : t), 1e-5);
                ++compared;
            }
        }
        EXPECT_GT(compared, 500);
    }
}

/// A mirror sphere of radius R scatters R^2/4 of a beam into each steradian, whatever the
/// direction: its picture sums to E R^2/4, with the irradiance E = pi strength.
TEST(Sphere, NarrowHighlightsHaveTheFluxOfAMirror) {
    constexpr int size = 32;
    const double radius = 0.96 * size / 2, expected = pi * radius * radius / 4;
    for (const double w : {3e-2, 1e-2, 3e-3, 2e-3}) {
        for (const double theta : {0.0, 20.0, 45.0, 75.0, 110.0}) {
            for (const double phi : {-30.0, 100.0, 135.0}) {
                const Direction towards = directionFromAngles(radians(theta), radians(phi));
                const SpherePicture picture =
                    renderSphere(BlurredMirror(w), {.rig = {.lights = {{towards, 1}}, .dome = 0},
                                                    .size = size,
                                                    .sharpened = true});
                double sum = 0;
                for (std::size_t k = 0; k < picture.coverage.size(); ++k)
                    sum += picture.coverage[k] * picture.radiance[3 * k];
                EXPECT_NEAR(sum / expected, 1, 0.05) << w << " " << theta << " " << phi;
            }
        }
    }
}

TEST(Sphere, DomeShowsTheAlbedo) {
    // f = a (wi.x wo.x)^2: albedo a wo.x^2 pi / 4, as the integral of cos sin^3 is 1/4. Linear
    // interpolation over h is off by h^2/8 times the second derivative, which is at most 2 for
    // sin^2 and cos^2: h of 11.25 degrees in azimuth and 5 in elevation, twice as much if coarse.
    const double fineBound = (std::pow(radians(11.25), 2) + std::pow(radians(5), 2)) / 4;
    const double a = 0.8;
    using Detail = AlbedoTable::Detail;
    for (const auto& [mirror, detail] : {std::pair{false, Detail::fine},
                                         {true, Detail::fine},
                                         {false, Detail::coarse},
                                         {true, Detail::coarse}}) {
        const double bound = fineBound * (detail == Detail::fine ? 1 : 4);
        const FormulaBrdf f(
            [a](const Direction& wi, const Direction& wo) { return a * wi.x * wi.x * wo.x * wo.x; },
            {}, {.mirrorSymmetric = mirror});
        const AlbedoTable table(f, detail);
        for (const double theta : {3.0, 22.0, 47.0, 71.0, 86.0}) {
            for (double phi = -175; phi < 180; phi += 20) {
                const Direction wo = directionFromAngles(radians(theta), radians(phi));
                double albedo = 0;
                table.at(wo, {&albedo, 1});
                EXPECT_NEAR(albedo, a * wo.x * wo.x * pi / 4, a * pi / 4 * bound) << theta << phi;
            }
        }
        EXPECT_LT(table.error(), 1e-6);
    }
}

TEST(Sphere, ValuesThatAreNotFiniteAreLeftOutAndCounted) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const FormulaBrdf f([nan](const Direction& wi, const Direction& wo) {
        return wi.z > 0.9 ? nan : wo.z > 0.9 ? HUGE_VAL : 1 / pi;
    });
    const SpherePicture sphere = renderSphere(f, {.size = 32});
    EXPECT_GT(sphere.notFinite, 0u);
    for (const float value : sphere.radiance) ASSERT_TRUE(std::isfinite(value));
}

TEST(Sphere, SpectraHaveAColour) {
    // Flat: R = G = B. Two wavelengths are too few for a colour: the mean, as grey.
    std::vector<double> nanometres;
    for (int nm = 380; nm <= 780; nm += 20) nanometres.push_back(nm);
    class Flat : public FormulaBrdf {
    public:
        using FormulaBrdf::FormulaBrdf;
        void eval(const Direction&, DirectionBatch wi, double* out) const override {
            std::fill_n(out, wi.count * channels().count(), 0.5 / pi);
        }
    };
    const Flat flat([](const Direction&, const Direction&) { return 0.0; }, {}, {.isotropic = true},
                    Channels::spectral(nanometres));
    const SphereOptions options{.size = 16};
    const SpherePicture coloured = renderSphere(flat, options);
    const SpherePicture grey = renderSphere(lambert(0.5), options);
    const FormulaBrdf two([](const Direction&, const Direction&) { return 1 / pi; }, {},
                          {.isotropic = true}, Channels::spectral({900, 1000}));
    const SpherePicture mean = renderSphere(two, options),
                        threeQuarters = renderSphere(lambert(0.75), options);
    EXPECT_NE(mean.colours.find("mean of 2"), std::string::npos);
    for (std::size_t i = 0; i < grey.radiance.size(); ++i) {
        ASSERT_NEAR(coloured.radiance[i], grey.radiance[i], 1e-5);
        ASSERT_NEAR(mean.radiance[i], threeQuarters.radiance[i], 1e-6);
    }
}

TEST(SpherePicture, PngHoldsTheRadianceInSrgb) {
    const SpherePicture a = renderSphere(lambert(0.8), {.size = 40}),
                        b = renderSphere(lambert(0.1), {.size = 40});
    const std::array spheres{a, b};
    const Png png = decoded(spheresPng(spheres, -1.5));
    ASSERT_EQ(png.width, 80u);
    ASSERT_EQ(png.height, 40u);
    EXPECT_TRUE(png.srgb);
    for (std::size_t row = 0; row < 40; ++row) {
        for (std::size_t column = 0; column < 80; ++column) {
            const SpherePicture& sphere = column < 40 ? a : b;
            const std::size_t pixel = row * 40 + column % 40;
            const unsigned char* rgba = png.rgba.data() + 4 * (row * 80 + column);
            ASSERT_NEAR(rgba[3] / 255.0, sphere.coverage[pixel], 0.5 / 255 + 1e-6);
            // Decoded with the inverse of IEC 61966-2-1; half a step of 8 bits is at most
            // 0.5/255 times the steepest slope of that inverse, 2.4/1.055.
            const double s = rgba[1] / 255.0;
            const double linear = s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
            const double shown = std::min(1.0, sphere.radiance[3 * pixel + 1] / std::exp2(1.5));
            ASSERT_NEAR(linear, shown, 0.5 / 255 * 2.4 / 1.055 + 1e-6);
        }
    }
}

TEST(SpherePicture, ExrHoldsTheRadianceItself) {
    const Folder folder;
    const SpherePicture a = renderSphere(lambert(30), {.size = 24}),
                        b = renderSphere(lambert(0.1), {.size = 24});
    const std::array spheres{a, b};
    writeSpheres(spheres, 5, folder / "s.exr", {{"hshfit:sphere1", "thirty"}});
    ExrPicture exr = readExrPicture(contentOf(folder / "s.exr"), "s.exr", 1 << 20);
    ASSERT_EQ(exr.width, 48u);
    EXPECT_EQ(exr.attributes["hshfit:sphere1"], "thirty");
    EXPECT_EQ(exr.channels, (std::vector<std::string>{"A", "B", "G", "R"}));
    for (std::size_t i = 0; i < 24 * 24; ++i) {
        ASSERT_EQ(exr.at(i / 24, i % 24, 0), a.coverage[i]);
        ASSERT_EQ(exr.at(i / 24, i % 24, 3), a.coverage[i] * a.radiance[3 * i]);
        ASSERT_EQ(exr.at(i / 24, 24 + i % 24, 2), b.coverage[i] * b.radiance[3 * i + 1]);
    }
    EXPECT_THROW(writeSpheres(spheres, 0, folder / "s.jpeg"), UsageError);
    EXPECT_THROW(writeSpheres(spheres, 0, folder / "none/s.png"), OutputError);
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(SpherePicture, DifferencesAndExposures) {
    const SphereOptions options{.size = 48};
    const SpherePicture half = renderSphere(lambert(0.5), options),
                        quarter = renderSphere(lambert(0.25), options);
    EXPECT_EQ(meanSquare(sphereDifference(half, half)), 0);
    EXPECT_EQ(amplificationFor(sphereDifference(half, half), 0), 1);
    // approximation - reference = -reference / 2.
    const SpherePicture difference = sphereDifference(half, quarter);
    EXPECT_NEAR(meanSquare(difference) / meanSquare(half), 0.25, 1e-6);
    for (std::size_t i = 0; i < difference.radiance.size(); ++i) {
        ASSERT_LE(difference.radiance[i], 0);
        ASSERT_NEAR(amplified(difference, 2).radiance[i], half.radiance[i], 1e-6);
    }
    // Half the radiance takes one stop more; a tenth is how exposures are rounded.
    const double stops = automaticExposure({&half, 1});
    EXPECT_NEAR(automaticExposure({&quarter, 1}) - stops, 1, 0.1 + 1e-9);
    std::vector<float> shown;
    for (std::size_t i = 0; i < half.coverage.size(); ++i) {
        if (half.coverage[i] > 0) {
            shown.push_back(half.radiance[3 * i] * static_cast<float>(std::exp2(stops)));
        }
    }
    std::sort(shown.begin(), shown.end());
    EXPECT_NEAR(shown[shown.size() * 95 / 100], 0.8, 0.8 * 0.05);
}

TEST(Sphere, AHighlightOnBlackIsNotExposedAtRounding) {
    SpherePicture spot;
    spot.size = 10;
    spot.coverage.assign(100, 1.0F);
    spot.radiance.assign(300, 1e-12F);
    spot.radiance[0] = 4;
    // The exposure takes the radiance `shown` to 0.8. Where 4 is white, `shown` is the first step
    // above black.
    const double shown = 0.8 / std::exp2(automaticExposure({&spot, 1}));
    EXPECT_EQ(encoded(0.95 * shown / 4), 1);
    EXPECT_EQ(encoded(0.4 * shown / 4), 0);
    spot.radiance.assign(300, 0);
    EXPECT_EQ(automaticExposure({&spot, 1}), 0);
    // A hundredth of a stop below 0 is rounded to 0, not to -0.
    EXPECT_FALSE(std::signbit(automaticExposure(std::vector<float>{0.8F * 1.007F})));
}

TEST(Sphere, TheSameWhateverTheThreads) {
    const FormulaBrdf f(
        [](const Direction& wi, const Direction& wo) {
            return std::pow(std::max(0.0, wi.z * wo.z - wi.x * wo.x), 9) + 0.1 * wi.y * wi.y;
        },
        {}, anisotropic);
    std::vector<SpherePicture> pictures;
    for (const int threads : {1, 4}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        pictures.push_back(renderSphere(f, {.size = 48}));
    }
    EXPECT_EQ(pictures[0].radiance, pictures[1].radiance);
    EXPECT_EQ(pictures[0].coverage, pictures[1].coverage);
    EXPECT_EQ(spheresPng({&pictures[0], 1}, 0), spheresPng({&pictures[1], 1}, 0));
}

}  // namespace
