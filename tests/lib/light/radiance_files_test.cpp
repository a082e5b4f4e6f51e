// Radiance pictures written byte by byte: every orientation, every compression, and broken ones.
#include "places.h"
#include "skip_without.h"
#include "temporary_folder.h"

#include <hshfit/error.h>
#include <hshfit/light/catalog.h>
#include <hshfit/light/light_projection.h>
#include <hshfit/light/picture_light.h>

#include <hshfit/bases/sh.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>

namespace hshfit {
namespace {

using Pixel = std::array<unsigned char, 4>;
using Line = std::vector<Pixel>;

enum class Code { flat, byComponent, oldRuns };

/// Pixel (column, row) of an upright picture, in runs of four; never 1 1 1.
Pixel testPixel(std::size_t column, std::size_t row) {
    const std::size_t k = column / 4 + 8 * row;
    return {static_cast<unsigned char>(128 + k % 100), static_cast<unsigned char>(k % 251),
            static_cast<unsigned char>(7 * k % 253), static_cast<unsigned char>(120 + row % 5)};
}

std::string coded(const Line& line, Code code) {
    std::string out;
    const auto put = [&](std::size_t value) { out += static_cast<char>(value); };
    const auto runAt = [&](std::size_t k, auto same, std::size_t most) {
        std::size_t end = k + 1;
        while (end < line.size() && end - k < most && same(line[end], line[k])) ++end;
        return end - k;
    };
    if (code == Code::flat) {
        for (const Pixel& pixel : line)
            for (const unsigned char byte : pixel) put(byte);
    } else if (code == Code::oldRuns) {
        const auto equal = [](const Pixel& a, const Pixel& b) { return a == b; };
        for (std::size_t k = 0; k < line.size();) {
            for (const unsigned char byte : line[k]) put(byte);
            // The digits of the number of repetitions to the base of 256, the lowest first.
            std::size_t more = runAt(k, equal, line.size()) - 1;
            k += more + 1;
            for (; more > 0; more /= 256)
                for (const std::size_t byte :
                     {std::size_t{1}, std::size_t{1}, std::size_t{1}, more % 256})
                    put(byte);
        }
    } else {
        for (const std::size_t byte :
             {std::size_t{2}, std::size_t{2}, line.size() / 256, line.size() % 256})
            put(byte);
        for (std::size_t c = 0; c < 4; ++c) {
            const auto equal = [c](const Pixel& a, const Pixel& b) { return a[c] == b[c]; };
            for (std::size_t k = 0; k < line.size();) {
                const std::size_t run = runAt(k, equal, 127);
                put(run > 2 ? 128 + run : run);
                for (std::size_t j = 0; j < (run > 2 ? 1 : run); ++j) put(line[k][c]);
                k += run;
            }
        }
    }
    return out;
}

class RadianceFiles : public testing::Test {
protected:
    std::string file(const std::string& name, const std::string& resolution,
                     const std::string& body) const {
        const std::string path = folder_ / name;
        std::ofstream out(path, std::ios::binary);
        out << "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n" << resolution << "\n" << body;
        return path;
    }
    static std::string messageOf(const std::string& spec) {
        try {
            parseLights(spec);
        } catch (const InputError& error) {
            return error.what();
        }
        return "no input error";
    }
    test::TemporaryFolder folder_;
};

/// The lines of a picture as a file of an orientation has them: the axis of the lines, whether they
/// and their pixels run in the upright order.
std::vector<Line> linesOf(std::size_t width, std::size_t height, bool columns, bool forth,
                          bool along) {
    std::vector<Line> lines(columns ? width : height);
    for (std::size_t k = 0; k < lines.size(); ++k) {
        const std::size_t line = forth ? k : lines.size() - 1 - k;
        const std::size_t length = columns ? height : width;
        for (std::size_t j = 0; j < length; ++j) {
            const std::size_t at = along ? j : length - 1 - j;
            lines[k].push_back(columns ? testPixel(line, at) : testPixel(at, line));
        }
    }
    return lines;
}

TEST_F(RadianceFiles, EveryOrientationAndCompressionGivesTheUprightPicture) {
    constexpr std::size_t width = 32, height = 16;
    int files = 0;
    for (const bool columns : {false, true}) {
        for (const bool forth : {true, false}) {
            for (const bool along : {true, false}) {
                const std::string y = std::string((columns ? along : forth) ? "-" : "+") + "Y 16";
                const std::string x = std::string((columns ? forth : along) ? "+" : "-") + "X 32";
                for (const Code code : {Code::flat, Code::byComponent, Code::oldRuns}) {
                    std::string body;
                    for (const Line& line : linesOf(width, height, columns, forth, along))
                        body += coded(line, code);
                    const std::string text = columns ? x + " " + y : y + " " + x;
                    const PictureLight light = readPictureLight(file("a.hdr", text, body), 1);
                    ASSERT_EQ(light.width, width) << text;
                    ASSERT_EQ(light.height, height) << text;
                    for (std::size_t k = 0; k < width * height; ++k) {
                        const Pixel pixel = testPixel(k % width, k / width);
                        for (std::size_t c = 0; c < 3; ++c)
                            ASSERT_EQ(light.rgb[3 * k + c], pixel[c] * std::exp2(pixel[3] - 136.0F))
                                << text << " pixel " << k;
                    }
                    ++files;
                }
            }
        }
    }
    EXPECT_EQ(files, 24);
}

TEST_F(RadianceFiles, RunsThatFollowRunsCountInUnitsOf256) {
    // 700 pixels of one value behind another, 700 = 188 + 2 256; the lines of a row of 2:1.
    constexpr std::size_t width = 702, height = 351;
    std::string body;
    for (std::size_t row = 0; row < height; ++row) {
        Line line(width, Pixel{200, 100, 50, 129});
        line[0] = Pixel{128, 128, 128, 128};
        body += coded(line, Code::oldRuns);
    }
    EXPECT_EQ(body.size(), height * 16);
    const PictureLight light = readPictureLight(file("long.hdr", "-Y 351 +X 702", body), 1);
    EXPECT_EQ(light.rgb[0], 0.5F);
    for (std::size_t k = 1; k < width; ++k) EXPECT_EQ(light.rgb[3 * k], 200.F / 128);
}

TEST_F(RadianceFiles, BrokenFilesAreRefusedWithThePlace) {
    const std::string resolution = "-Y 16 +X 32";
    for (const Code code : {Code::flat, Code::byComponent, Code::oldRuns}) {
        std::string body;
        for (const Line& line : linesOf(32, 16, false, true, true)) body += coded(line, code);
        for (std::size_t size = 0; size < body.size(); size += 7)
            EXPECT_NE(messageOf(file("cut.hdr", resolution, body.substr(0, size)))
                          .find("breaks off or is damaged in row"),
                      std::string::npos)
                << size;
    }
    const std::string pixel("\x80\x40\x20\x80", 4);
    const auto damaged = [&](const std::string& body) {
        return messageOf(file("bad.hdr", resolution, body + std::string(4096, '\x70')))
                   .find("damaged in row 0 of 16") != std::string::npos;
    };
    EXPECT_TRUE(damaged(std::string("\x01\x01\x01\x03", 4)));                  // of no pixel
    EXPECT_TRUE(damaged(pixel + std::string("\x01\x01\x01\x20", 4)));          // one too many
    EXPECT_TRUE(damaged(std::string("\x02\x02\x00\x21", 4)));                  // another length
    EXPECT_TRUE(damaged(std::string("\x02\x02\x00\x20\xa1\x07", 6)));          // a run of 33
    EXPECT_TRUE(damaged(std::string("\x02\x02\x00\x20\x00\x00\x00\x00", 8)));  // none at all
    EXPECT_FALSE(damaged(pixel + std::string("\x01\x01\x01\x1f", 4)));
    // Two rows of twelve bytes, and half of one.
    std::string rows;
    for (int row = 0; row < 3; ++row)
        rows += std::string("\x02\x02\x00\x20\xa0\x07\xa0\x07\xa0\x07\xa0\x80", 12);
    EXPECT_NE(messageOf(file("half.hdr", resolution, rows.substr(0, 30))).find("row 2 of 16"),
              std::string::npos);
    for (const char* text : {"-Y 16", "-Y 16 +Y 32", "-Y 0 +X 32", "-Z 16 +X 32", "-Y 16 +X 32 1",
                             "-Y 16 +X 99999999999", "16 32"})
        EXPECT_NE(messageOf(file("size.hdr", text, std::string(4096, '\x70'))).find("resolution"),
                  std::string::npos)
            << text;
}

/// Real files: one light in four orientations, and with and without old runs.
TEST_F(RadianceFiles, FilesOfTheFieldHoldTheLightOfTheirReferences) {
    const std::string field = test::sharedFolder() + "/data/field/light/";
    SKIP_WITHOUT(field);
    const auto nineOf = [&](const std::string& name) {
        return projectLight(parseLights(field + name).lights, *bases::makeSh(3, {})).values;
    };
    const auto expectNear = [&](const std::string& name, const std::string& reference,
                                double tolerance) {
        const auto a = nineOf(name), b = nineOf(reference);
        for (std::size_t k = 0; k < a.size(); ++k)
            EXPECT_NEAR(a[k], b[k], tolerance * std::abs(b[0])) << name << " slot " << k;
    };
    const std::string turned = "11-picture-mirror-and-tilt/";
    for (const char* name : {"ori_mY_mX.hdr", "ori_pX_mY.hdr", "ori_pY_pX.hdr"})
        expectNear(turned + name, turned + "std.hdr", 1e-9);
    expectNear("15-old-rle/oldrle_runs.hdr", "15-old-rle/oldrle_runs_ref.hdr", 1e-9);
}

}  // namespace
}  // namespace hshfit
