// Parts, layers, windows and colours of picture files, written here, against values that follow
// from the formats' own rules.

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/light/catalog.h>
#include <hshfit/light/light_projection.h>
#include <hshfit/light/picture_light.h>

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numeric>

#include <unistd.h>

namespace hshfit {
namespace {

namespace fs = std::filesystem;

class PictureColours : public testing::Test {
protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("hshfit-colours-" + std::to_string(getpid()));
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }

    std::string path(const std::string& name) const { return (folder_ / name).string(); }

    struct Part {
        std::string name;
        std::vector<std::string> channels;
        float first = 0;  ///< channel k holds `first` + k everywhere
    };
    /// 8 x 4 pixels in each part.
    std::string write(const std::string& name, const std::vector<Part>& parts,
                      const std::function<void(OIIO::ImageSpec&)>& change = {}) const {
        std::vector<OIIO::ImageSpec> specs;
        for (const Part& part : parts) {
            OIIO::ImageSpec spec(8, 4, static_cast<int>(part.channels.size()),
                                 OIIO::TypeDesc::FLOAT);
            spec.channelnames = part.channels;
            if (!part.name.empty()) spec.attribute("oiio:subimagename", part.name);
            if (change) change(spec);
            specs.push_back(spec);
        }
        const std::string file = path(name);
        auto out = OIIO::ImageOutput::create(file);
        EXPECT_TRUE(out);
        EXPECT_TRUE(specs.size() > 1 ? out->open(file, static_cast<int>(specs.size()), specs.data())
                                     : out->open(file, specs[0]))
            << out->geterror();
        for (std::size_t p = 0; p < parts.size(); ++p) {
            if (p > 0) {
                EXPECT_TRUE(out->open(file, specs[p], OIIO::ImageOutput::AppendSubimage));
            }
            const auto pixels = static_cast<std::size_t>(specs[p].width) *
                                static_cast<std::size_t>(specs[p].height);
            std::vector<float> values(pixels * parts[p].channels.size());
            for (std::size_t k = 0; k < values.size(); ++k)
                values[k] = parts[p].first + static_cast<float>(k % parts[p].channels.size());
            EXPECT_TRUE(out->write_image(OIIO::TypeDesc::FLOAT, values.data()));
        }
        out->close();
        return file;
    }

    /// 8 x 4 pixels of (64, 32, 16) / 128 in flat RGBE behind the lines of a header.
    std::string radiance(const std::string& name, const std::string& lines,
                         const std::string& format = "32-bit_rle_rgbe") const {
        std::ofstream out(path(name), std::ios::binary);
        out << "#?RADIANCE\n" << lines << "FORMAT=" << format << "\n\n-Y 4 +X 8\n";
        for (int k = 0; k < 32; ++k) out.write("\x80\x40\x20\x80", 4);
        return path(name);
    }

    static std::vector<float> firstPixel(const std::string& spec) {
        const auto light = std::get<PictureLight>(parseLights(spec).lights.front());
        return {light.rgb[0], light.rgb[1], light.rgb[2]};
    }
    static std::string messageOf(const std::string& spec) {
        try {
            parseLights(spec);
        } catch (const InputError& error) {
            return error.what();
        }
        return "no input error";
    }
    static void expectHas(const std::string& spec, const std::vector<std::string>& words) {
        const std::string message = messageOf(spec);
        for (const std::string& word : words)
            EXPECT_NE(message.find(word), std::string::npos) << word << " in: " << message;
    }

    fs::path folder_;
};

using Pixel = std::vector<float>;

TEST_F(PictureColours, LayersAreReadByTheirOnlyColoursOrByName) {
    EXPECT_EQ(firstPixel(write("v.exr", {{"", {".B", ".G", ".R"}, 1}})), (Pixel{3, 2, 1}));
    EXPECT_EQ(firstPixel(write("b.exr", {{"",
                                          {"ViewLayer.Combined.B", "ViewLayer.Combined.G",
                                           "ViewLayer.Combined.R", "ViewLayer.Depth.Z"},
                                          1}})),
              (Pixel{3, 2, 1}));
    // Channels without a layer go before others.
    EXPECT_EQ(firstPixel(write("d.exr", {{"", {"B", "G", "R", "gi.B", "gi.G", "gi.R"}, 1}})),
              (Pixel{3, 2, 1}));
    const std::string two = write("two.exr", {{"", {"a.B", "a.G", "a.R", "b.B", "b.G", "b.R"}, 1}});
    expectHas(two, {"choose one", "layer=a", "layer=b"});
    EXPECT_EQ(firstPixel(two + ":layer=b"), (Pixel{6, 5, 4}));
    expectHas(two + ":layer=c", {"layer 'c'", "a.R"});
}

TEST_F(PictureColours, PartsAreReadByTheirOnlyColoursOrByNameAndNumber) {
    const std::vector<Part> one{{"depth", {"Z"}, 9}, {"rgba", {"A", "B", "G", "R"}, 1}};
    EXPECT_EQ(firstPixel(write("one.exr", one)), (Pixel{4, 3, 2}));
    const std::vector<Part> two{{"left", {"B", "G", "R"}, 1}, {"right", {"B", "G", "R"}, 5}};
    const std::string file = write("both.exr", two);
    expectHas(file, {"choose one", "part=left", "part=right"});
    EXPECT_EQ(firstPixel(file + ":part=right"), (Pixel{7, 6, 5}));
    EXPECT_EQ(firstPixel(file + ":part=1"), (Pixel{3, 2, 1}));
}

TEST_F(PictureColours, AChannelAloneIsLightIfItIsLuminance) {
    EXPECT_EQ(firstPixel(write("y.exr", {{"", {"Y"}, 2}})), (Pixel{2, 2, 2}));
    for (const char* name : {"Z", "A", "id", "objectId", "depth.Z"})
        expectHas(write("o.exr", {{"", {name}, 2}}), {"no R, G and B, nor Y alone", name});
}

TEST_F(PictureColours, TheDisplayWindowIsThePicture) {
    // 2 columns and 1 row beside the picture on every side; values grow by row and column.
    for (const int origin : {0, 7, -9}) {
        const std::string file = path(fmt::format("w{}.exr", origin));
        OIIO::ImageSpec spec(12, 6, 3, OIIO::TypeDesc::FLOAT);
        spec.x = origin - 2, spec.y = origin - 1;
        spec.full_x = origin, spec.full_y = origin, spec.full_width = 8, spec.full_height = 4;
        std::vector<float> values(12 * 6 * 3);
        for (std::size_t k = 0; k < values.size(); ++k)
            values[k] = static_cast<float>(100 * (k / 36) + k / 3 % 12);
        auto out = OIIO::ImageOutput::create(file);
        ASSERT_TRUE(out->open(file, spec));
        ASSERT_TRUE(out->write_image(OIIO::TypeDesc::FLOAT, values.data()));
        out->close();
        EXPECT_TRUE(looksLikeLight(file));
        const auto light = std::get<PictureLight>(parseLights(file).lights.front());
        ASSERT_EQ(light.width, 8u);
        ASSERT_EQ(light.height, 4u);
        for (std::size_t row = 0; row < 4; ++row)
            for (std::size_t column = 0; column < 8; ++column)
                EXPECT_EQ(light.rgb[3 * (8 * row + column)],
                          static_cast<float>(100 * (row + 1) + column + 2))
                    << origin;
    }
    const auto half = [](OIIO::ImageSpec& spec) { spec.full_height = 8, spec.full_width = 16; };
    expectHas(write("half.exr", {{"", {"B", "G", "R"}, 1}}, half), {"8 x 4", "16 x 8"});
}

// Radiance: pixels over EXPOSURE and COLORCORR, which are cumulative, are radiance.
TEST_F(PictureColours, ExposureAndColourCorrectionAreDividedOut) {
    const auto expect = [&](const std::string& lines, const Pixel& expected) {
        const Pixel got = firstPixel(radiance("e.hdr", lines));
        for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(got[c], expected[c], 1e-6) << lines;
    };
    expect("", {0.5F, 0.25F, 0.125F});
    expect("EXPOSURE=4.0\nEXPOSURE= 2.0\n", {0.5F / 8, 0.25F / 8, 0.125F / 8});
    expect("COLORCORR=1 0.5 2\n", {0.5F, 0.5F, 0.0625F});
    expect("COLORCORR=2 1 1\nEXPOSURE=0.5\nCOLORCORR=1 1 4\nGAMMA=2.2\n", {0.5F, 0.5F, 0.0625F});
    expectHas(radiance("x.hdr", "", "32-bit_rle_xyze"), {"XYZ", "ra_xyze"});
    expectHas(radiance("y.hdr", "EXPOSURE=0\n"), {"EXPOSURE", "above 0"});
    expectHas(radiance("z.hdr", "PRIMARIES=0.6 0.3\n"), {"PRIMARIES", "8"});
}

// P3 with D65 as white, SMPTE EG 432-1: its red in linear Rec. 709 is (1.2249, -0.0420, -0.0197),
// its green (-0.2249, 1.0420, -0.0786), its blue (0, 0, 1.0983), as published with CSS Color 4.
TEST_F(PictureColours, PrimariesAreConvertedToRec709) {
    const std::string p3 = "PRIMARIES=0.68 0.32 0.265 0.69 0.15 0.06 0.3127 0.329\n";
    const double matrix[3][3] = {
        {1.2249, -0.2249, 0}, {-0.0420, 1.0420, 0}, {-0.0197, -0.0786, 1.0983}};
    const double stored[] = {0.5, 0.25, 0.125};
    const float numbers[] = {0.68F, 0.32F, 0.265F, 0.69F, 0.15F, 0.06F, 0.3127F, 0.329F};
    const Pixel got = firstPixel(radiance("p.hdr", p3));
    const Pixel other = firstPixel(write("p.exr", {{"", {"R", "G", "B"}, 1}}, [&](auto& spec) {
        spec.attribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), numbers);
    }));
    for (std::size_t c = 0; c < 3; ++c) {
        double expected = 0, ofOther = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            expected += matrix[c][k] * stored[k];
            ofOther += matrix[c][k] * (1 + static_cast<double>(k));
        }
        EXPECT_NEAR(got[c], expected, 2e-4);
        EXPECT_NEAR(other[c], ofOther, 1e-3);
    }
    // Grey stays grey whatever the white; Radiance's own primaries are Rec. 709.
    std::ofstream grey(path("g.hdr"), std::ios::binary);
    grey << "#?RADIANCE\nPRIMARIES=0.7347 0.2653 0.1596 0.8404 0.0366 0.0001 0.3457 0.3585\n"
            "FORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 8\n";
    for (int k = 0; k < 32; ++k) grey.write("\x80\x80\x80\x80", 4);
    grey.close();
    for (const float value : firstPixel(path("g.hdr"))) EXPECT_NEAR(value, 0.5, 1e-6);
    const std::string own = "PRIMARIES=0.64 0.33 0.29 0.6 0.15 0.06 0.3333 0.3333\n";
    EXPECT_EQ(firstPixel(radiance("o.hdr", own)), (Pixel{0.5F, 0.25F, 0.125F}));
    EXPECT_EQ(firstPixel(radiance("n.hdr", "PRIMARIES=0 0 0 0 0 0 0 0\n")),
              (Pixel{0.5F, 0.25F, 0.125F}));
    expectHas(radiance("s.hdr", "PRIMARIES=0.3 0.3 0.3 0.3 0.3 0.3 0.3 0.3\n"),
              {"span no colours"});
}

TEST_F(PictureColours, InvalidPixelsAreRefusedWithAWayOutOrClamped) {
    const std::string file = path("i.exr");
    OIIO::ImageSpec spec(8, 4, 3, OIIO::TypeDesc::FLOAT);
    std::vector<float> values(96, 1.0F);
    values[0] = -0.25F, values[4] = std::nanf(""), values[8] = HUGE_VALF;
    auto out = OIIO::ImageOutput::create(file);
    ASSERT_TRUE(out->open(file, spec));
    ASSERT_TRUE(out->write_image(OIIO::TypeDesc::FLOAT, values.data()));
    out->close();
    expectHas(file, {"1 pixels below 0", "invalid=clamp"});
    const auto light =
        std::get<PictureLight>(parseLights(file + ":invalid=clamp,scale=2").lights.front());
    const std::vector<float> expected{0, 2, 2, 2, 0, 2, 2, 2, 131008};
    for (std::size_t k = 0; k < expected.size(); ++k) EXPECT_EQ(light.rgb[k], expected[k]) << k;
}

// Light of a radiance of 2 from everywhere, in pixels of any proportion: the first coefficient is
// 2 sqrt(4 pi), and all others are 0.
TEST_F(PictureColours, StatedPanoramasHaveAnyProportion) {
    for (const auto& [width, height] : {std::pair{19, 9}, {7, 7}, {5, 11}}) {
        const auto size = [w = width, h = height](OIIO::ImageSpec& spec) {
            spec.width = spec.full_width = w;
            spec.height = spec.full_height = h;
        };
        const std::string file = write("any.exr", {{"", {"Y"}, 2}}, size);
        const auto basis = bases::make("sh", 3);
        const auto light = projectLight(parseLights(file + ":layout=latlong").lights, *basis);
        EXPECT_NEAR(light.values[0], 2 * std::sqrt(4 * pi), 1e-5);
        for (std::size_t k = 1; k < 9; ++k) EXPECT_NEAR(light.values[k], 0, 1e-5) << width;
    }
}

TEST_F(PictureColours, TheNamesOfWhichMostFacesExistAreTaken) {
    const auto square = [](OIIO::ImageSpec& spec) {
        spec.width = spec.height = spec.full_width = spec.full_height = 4;
    };
    // "up" belongs to another set as well.
    for (const char* name : {"rt", "lf", "up", "dn", "ft", "bk"})
        write(std::string("sky") + name + ".exr", {{"", {"R", "G", "B"}, 1}}, square);
    EXPECT_EQ(firstPixel(path("sky{face}.exr")), (Pixel{1, 2, 3}));
    fs::remove(path("skydn.exr"));
    expectHas(path("sky{face}.exr"), {"skydn.exr"});
}

}  // namespace
}  // namespace hshfit
