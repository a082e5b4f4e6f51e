// Pictures with faults: pixels that are filled from those around, faces of cubes that do not meet,
// gain maps.
#include "places.h"
#include "skip_without.h"
#include "temporary_folder.h"

#include <hshfit/error.h>
#include <hshfit/light/catalog.h>
#include <hshfit/light/picture_light.h>

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>

namespace hshfit {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float infinite = std::numeric_limits<float>::infinity();

using Value = std::function<float(std::size_t column, std::size_t row, std::size_t channel)>;

class PictureRepairs : public testing::Test {
protected:
    std::string write(const std::string& name, int width, int height, const Value& value) const {
        std::vector<float> values;
        for (std::size_t k = 0; k < static_cast<std::size_t>(width * height); ++k)
            for (std::size_t c = 0; c < 3; ++c)
                values.push_back(value(k % static_cast<std::size_t>(width),
                                       k / static_cast<std::size_t>(width), c));
        const std::string file = folder_ / name;
        auto out = OIIO::ImageOutput::create(file);
        EXPECT_TRUE(out->open(file, OIIO::ImageSpec(width, height, 3, OIIO::TypeDesc::FLOAT)));
        EXPECT_TRUE(out->write_image(OIIO::TypeDesc::FLOAT, values.data()));
        out->close();
        return file;
    }
    static PictureLight read(const std::string& spec) {
        return std::get<PictureLight>(parseLights(spec).lights.front());
    }
    static std::string messageOf(const std::string& spec) {
        try {
            parseLights(spec);
        } catch (const InputError& error) {
            return error.what();
        }
        return "no input error";
    }
    static float at(const PictureLight& light, std::size_t column, std::size_t row, std::size_t c) {
        return light.rgb[3 * (row * light.width + column) + c];
    }
    test::TemporaryFolder folder_;
};

// --- invalid=inpaint ----------------------------------------------------------------------------

// A function a + b x + c y + d x y solves Laplace's equation on pixels, so that holes in it are
// filled exactly, whatever their size.
TEST_F(PictureRepairs, HolesInSmoothGradientsAreFilledExactly) {
    const auto smooth = [](std::size_t x, std::size_t y, std::size_t c) {
        return 1 + 0.25F * static_cast<float>(x) + 0.5F * static_cast<float>(y) +
               0.125F * static_cast<float>(c * x * y);
    };
    const float wrong[] = {nan, infinite, -1.F};
    const auto hole = [](std::size_t x, std::size_t y) {
        return (x >= 5 && x < 9 && y >= 4 && y < 7) || (x == 20 && y == 10);
    };
    const std::string file =
        write("holes.exr", 32, 16, [&](std::size_t x, std::size_t y, std::size_t c) {
            return hole(x, y) && c == (x + y) % 3 ? wrong[c] : smooth(x, y, c);
        });
    EXPECT_NE(messageOf(file).find("invalid=inpaint"), std::string::npos);
    const PictureLight light = read(file + ":invalid=inpaint,scale=2");
    for (std::size_t k = 0; k < 512; ++k)
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(at(light, k % 32, k / 32, c), 2 * smooth(k % 32, k / 32, c),
                        1e-5 * smooth(k % 32, k / 32, c))
                << k;
    EXPECT_EQ(light.census.total(), 13u);
}

// A pixel at the left edge of a panorama lies beside one at the right edge, one in the top row
// beside that across the zenith.
TEST_F(PictureRepairs, HolesAtEdgesAreFilledFromAcrossThem) {
    const auto value = [](std::size_t x, std::size_t y, std::size_t) {
        if ((x == 0 && y == 5) || (x == 3 && y == 0)) return nan;
        return static_cast<float>(x + 100 * y);
    };
    const PictureLight light = read(write("edge.exr", 16, 8, value) + ":invalid=inpaint");
    EXPECT_FLOAT_EQ(at(light, 0, 5, 0), (501 + 515 + 400 + 600) / 4.F);
    EXPECT_FLOAT_EQ(at(light, 3, 0, 1), (2 + 4 + 103 + 11) / 4.F);
    // The front's right edge meets the right face's left edge.
    const auto face = [](std::size_t x, std::size_t y, std::size_t) {
        if (x == 4 * 8 + 7 && y == 3) return infinite;
        return static_cast<float>(x / 8 * 100 + y);
    };
    const PictureLight cube = read(write("cube.exr", 48, 8, face) + ":invalid=inpaint");
    EXPECT_FLOAT_EQ(at(cube, 39, 3, 2), (403 + 402 + 404 + 3) / 4.F);
}

TEST_F(PictureRepairs, FilledPixelsOfLargeFilesAreThoseOfTheirRows) {
    // Larger than the picture that is held, so that rows are read again.
    constexpr int width = 4400, height = 2200;
    const auto value = [](std::size_t x, std::size_t y, std::size_t) {
        return x == 100 && y == 900 ? -5.F : 1 + static_cast<float>(y) / 1024;
    };
    const PictureLight light =
        read(write("large.exr", width, height, value) + ":invalid=inpaint,scale=4");
    ASSERT_GT(light.fileWidth, light.width);
    double worst = 0;
    forEachRow(light, [&](std::size_t row, std::span<const float> rgb) {
        const double expected = 4 * (1 + static_cast<double>(row) / 1024);
        for (const float v : rgb) worst = std::max(worst, std::abs(v - expected));
    });
    EXPECT_LT(worst, 1e-5);
}

TEST_F(PictureRepairs, PicturesWithoutValidPixelsAreRefused) {
    const auto none = [](std::size_t, std::size_t, std::size_t) { return nan; };
    EXPECT_NE(messageOf(write("none.exr", 16, 8, none) + ":invalid=inpaint").find("no valid pixel"),
              std::string::npos);
    const auto most = [](std::size_t x, std::size_t, std::size_t) { return x % 2 ? nan : 1.F; };
    EXPECT_NE(messageOf(write("most.exr", 1024, 512, most) + ":invalid=inpaint").find("65536"),
              std::string::npos);
    // A scale that makes valid pixels infinite is no fault that is filled.
    const auto bright = [](std::size_t x, std::size_t y, std::size_t) {
        return x + y == 0 ? nan : x == 4 ? 3e38F : 1.F;
    };
    EXPECT_NE(messageOf(write("b.exr", 16, 8, bright) + ":invalid=inpaint,scale=1").size(), 0u);
    EXPECT_THROW(readPictureLight(folder_ / "b.exr", 1e6, {}, InvalidPixels::inpainted),
                 InputError);
}

// --- faces ---------------------------------------------------------------------------------------

/// A smooth light: a polynomial of the direction.
float polynomial(const Direction& d, std::size_t c) {
    return static_cast<float>(2 + d.x - 0.7 * d.y + 0.5 * d.z +
                              0.4 * static_cast<double>(c) * d.x * d.z);
}

/// Writes a cube of faces n across: `sourceOf` gives the place in our arrangement of what the file
/// has at a place.
using Place = std::array<std::size_t, 2>;
struct Arrangement {
    PictureGeometry geometry;
    std::function<Place(Place)> sourceOf;
};

TEST_F(PictureRepairs, FacesThatDoNotMeetAreSaidWithTheOrderInWhichTheyDo) {
    constexpr std::size_t n = 16;
    const auto remark = [&](const Arrangement& a, const std::string& name) {
        const std::string file =
            write(name, static_cast<int>(a.geometry.width), static_cast<int>(a.geometry.height),
                  [&](std::size_t x, std::size_t y, std::size_t c) {
                      const Place from = a.sourceOf({x, y});
                      return polynomial(a.geometry.direction(static_cast<double>(from[0]) + 0.5,
                                                             static_cast<double>(from[1]) + 0.5),
                                        c);
                  });
        const auto lights = parseLights(file).lights;
        const auto remarks = remarksOf(lights);
        return remarks.empty() ? std::string() : remarks.front();
    };
    const auto same = [](Place p) { return p; };
    const PictureGeometry row{PictureLayout::faces, 6 * n, n},
        column{PictureLayout::faces, n, 6 * n};
    const PictureGeometry upright{PictureLayout::cross, 3 * n, 4 * n},
        lying{PictureLayout::cross, 4 * n, 3 * n};
    for (const PictureGeometry& g : {row, column, upright, lying})
        EXPECT_EQ(remark({g, same}, "good.exr"), "") << g.width << " x " << g.height;

    // front, right, back, left, top, bottom: faces 4 0 5 1 2 3 of ours.
    constexpr std::size_t order[] = {4, 0, 5, 1, 2, 3};
    const std::string words = "order is front right back left top bottom;";
    const auto inRow = [&](Place p) { return Place{order[p[0] / n] * n + p[0] % n, p[1]}; };
    const auto inColumn = [&](Place p) { return Place{p[0], order[p[1] / n] * n + p[1] % n}; };
    EXPECT_NE(remark({row, inRow}, "row.exr").find(words), std::string::npos);
    EXPECT_NE(remark({column, inColumn}, "column.exr").find(words), std::string::npos);

    const auto turnedBack = [&](std::size_t left, std::size_t top) {
        return [=](Place p) {
            if (p[0] / n != left || p[1] / n != top) return p;
            return Place{2 * left * n + n - 1 - p[0], 2 * top * n + n - 1 - p[1]};
        };
    };
    EXPECT_NE(remark({upright, turnedBack(1, 3)}, "u.exr").find("if the back is upright"),
              std::string::npos);
    EXPECT_NE(remark({lying, turnedBack(3, 1)}, "l.exr").find("back turned by 180 degrees"),
              std::string::npos);
    // Two faces on their heads meet in no order.
    const auto broken = [&](Place p) {
        return p[0] / n == 0 || p[0] / n == 2 ? Place{p[0], n - 1 - p[1]} : p;
    };
    const std::string text = remark({row, broken}, "broken.exr");
    EXPECT_NE(text.find("do not meet"), std::string::npos);
    EXPECT_EQ(text.find("order"), std::string::npos);
    // Pixels that differ as much everywhere: noise has no seams.
    const auto noisy = [&](std::size_t x, std::size_t y, std::size_t) {
        return static_cast<float>(1 + (x * 7919 + y * 104729) % 13);
    };
    EXPECT_TRUE(remarksOf(parseLights(write("noise.exr", 6 * 16, 16, noisy)).lights).empty());
}

TEST_F(PictureRepairs, CubesOfTheFieldAreToldApart) {
    const std::string field = test::sharedFolder() + "/data/field/light/12-cube-order-and-seams/";
    SKIP_WITHOUT(field);
    const auto remark = [&](const std::string& name) { return read(field + name).remark; };
    EXPECT_EQ(remark("vcross_rot.hdr"), "");
    EXPECT_EQ(remark("strip_gl.hdr"), "");
    EXPECT_EQ(remark("sky{face}.hdr"), "");
    EXPECT_NE(remark("vcross_upright.hdr").find("if the back is upright"), std::string::npos);
    EXPECT_NE(remark("strip_dx_h.hdr").find("front right back left top bottom"), std::string::npos);
}

// --- gain maps -----------------------------------------------------------------------------------

TEST_F(PictureRepairs, GainMapsAreNoLight) {
    const std::string file = folder_ / "plain.jpg";
    auto out = OIIO::ImageOutput::create(file);
    ASSERT_TRUE(out->open(file, OIIO::ImageSpec(16, 8, 3, OIIO::TypeDesc::UINT8)));
    const std::vector<float> grey(16 * 8 * 3, 0.5F);
    ASSERT_TRUE(out->write_image(OIIO::TypeDesc::FLOAT, grey.data()));
    out->close();
    EXPECT_EQ(read(file + ":curve=srgb").width, 16u);
    std::ifstream in(file, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    const auto withSegment = [&](char marker, const std::string& content) {
        const std::size_t length = content.size() + 2;
        const std::string segment{'\xff', marker, static_cast<char>(length / 256),
                                  static_cast<char>(length % 256)};
        const std::string name = folder_ / "gain.jpg";
        std::ofstream(name, std::ios::binary)
            << bytes.substr(0, 2) << segment << content << bytes.substr(2);
        return name + ":curve=srgb";
    };
    const std::string xmp =
        std::string("http://ns.adobe.com/xap/1.0/") + '\0' + "<x:xmpmeta hdrgm:Version=\"1.0\"/>";
    EXPECT_NE(messageOf(withSegment('\xe1', xmp)).find("has a gain map (hdrgm:Version)"),
              std::string::npos);
    const std::string iso = std::string("urn:iso:std:iso:ts:21496:-1") + '\0' + "\x01\x02";
    EXPECT_NE(messageOf(withSegment('\xe2', iso)).find("21496"), std::string::npos);
    EXPECT_EQ(read(withSegment('\xfe', "a remark")).width, 16u);
    const std::string field =
        test::sharedFolder() + "/data/field/light/19-gain-map-jpeg/gainmap.jpg";
    if (std::filesystem::exists(field)) {
        EXPECT_NE(messageOf(field + ":curve=srgb").find("gain map"), std::string::npos);
    }
}

}  // namespace
}  // namespace hshfit
