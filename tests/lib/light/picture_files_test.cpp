// Pictures written by OpenImageIO itself, read back and broken.
#include <hshfit/error.h>
#include <hshfit/light/catalog.h>
#include <hshfit/light/light_samples.h>
#include <hshfit/light/picture_light.h>

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numeric>

#include <unistd.h>

namespace hshfit {
namespace {

namespace fs = std::filesystem;

class PictureFiles : public testing::Test {
protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("hshfit-pictures-" + std::to_string(getpid()));
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }

    std::string path(const std::string& name) const { return (folder_ / name).string(); }

    /// Values [row][column][channel] from 0 to 1 for whole numbers.
    std::string write(const std::string& name, int width, int height,
                      const std::vector<float>& values, OIIO::TypeDesc type = OIIO::TypeDesc::FLOAT,
                      const std::function<void(OIIO::ImageSpec&)>& change = {}) const {
        const std::string file = path(name);
        if (file.ends_with(".pfm")) {
            writePfm(file, width, height, values);
            return file;
        }
        auto out = OIIO::ImageOutput::create(file);
        OIIO::ImageSpec spec(width, height, static_cast<int>(values.size()) / (width * height),
                             type);
        if (change) change(spec);
        EXPECT_TRUE(out && out->open(file, spec)) << OIIO::geterror();
        if (spec.tile_width > 0) {
            EXPECT_TRUE(out->write_image(OIIO::TypeDesc::FLOAT, values.data()));
        } else {
            EXPECT_TRUE(out->write_scanlines(0, height, 0, OIIO::TypeDesc::FLOAT, values.data()));
        }
        out->close();
        return file;
    }

    /// OpenImageIO reads PFM but does not write it. Rows are from the bottom to the top.
    static void writePfm(const std::string& file, int width, int height,
                         const std::vector<float>& values) {
        std::ofstream out(file, std::ios::binary);
        out << "PF\n" << width << " " << height << "\n-1.0\n";
        const auto row = static_cast<std::size_t>(3 * width);
        for (int k = height; k-- > 0;) {
            out.write(
                reinterpret_cast<const char*>(values.data() + static_cast<std::size_t>(k) * row),
                static_cast<std::streamsize>(row * sizeof(float)));
        }
    }

    static std::string messageOf(const std::string& spec) {
        try {
            parseLights(spec);
        } catch (const InputError& error) {
            return error.what();
        }
        return "no input error";
    }

    fs::path folder_;
};

/// Distinct values of every pixel and channel, each a power of two or near one.
std::vector<float> pattern(std::size_t count) {
    std::vector<float> values(count);
    for (std::size_t k = 0; k < count; ++k) values[k] = static_cast<float>(1 + k % 97) / 128;
    return values;
}

constexpr std::string_view formats[] = {"a.exr", "a.hdr", "a.pfm", "a.png",
                                        "a.tif", "a.bmp", "a.ppm", "a.jpg"};

bool isFloat(std::string_view name) {
    return name == "a.exr" || name == "a.hdr" || name == "a.pfm";
}

TEST_F(PictureFiles, EveryFormatGivesThePixelsThatWereWritten) {
    for (const std::string_view name : formats) {
        const bool real = isFloat(name);
        const std::string file =
            write(std::string(name), 16, 8, pattern(3 * 16 * 8),
                  real ? OIIO::TypeDesc::FLOAT : OIIO::TypeDesc::UINT8, [](OIIO::ImageSpec& spec) {
                      spec.attribute("CompressionQuality", 100);
                      spec.attribute("jpeg:subsampling", "4:4:4");
                  });
        const PictureLight light =
            real ? readPictureLight(file, 2)
                 : readPictureLight(file, 2, {.curve = TransferCurve::linear});
        // A byte, RGBE's 8 bits of the largest component, and JPEG's rounding of colours.
        const double tolerance = name == "a.jpg" ? 0.2 : name == "a.hdr" ? 0.008 : real ? 0 : 0.002;
        const std::vector<float> expected = pattern(3 * 16 * 8);
        ASSERT_EQ(light.rgb.size(), expected.size()) << name;
        double worst = 0;
        for (std::size_t k = 0; k < expected.size(); ++k) {
            worst = std::max(worst, std::abs(light.rgb[k] / 2.0 - expected[k]));
        }
        EXPECT_LE(worst, tolerance) << name;
    }
}

TEST_F(PictureFiles, CurvesDecodeAsPublished) {
    // IEC 61966-2-1: 0.5 is 0.21404; ITU-R BT.709: 0.5 is ((0.5 + 0.099) / 1.099)^(1/0.45).
    EXPECT_NEAR(decoded(TransferCurve::srgb, 0.5), 0.2140411, 1e-6);
    EXPECT_NEAR(decoded(TransferCurve::srgb, 0.04), 0.04 / 12.92, 1e-12);
    EXPECT_NEAR(decoded(TransferCurve::rec709, 0.5), std::pow(0.599 / 1.099, 1 / 0.45), 1e-12);
    EXPECT_NEAR(decoded(TransferCurve::gamma22, 0.5), std::pow(0.5, 2.2), 1e-12);
    for (const CurveName& row : curveNames()) {
        EXPECT_NEAR(decoded(row.curve, 1), 1, 1e-12) << row.name;
        EXPECT_EQ(decoded(row.curve, 0), 0) << row.name;
        const std::string file =
            write("c.png", 8, 4, std::vector<float>(3 * 8 * 4, 128 / 255.F), OIIO::TypeDesc::UINT8);
        const auto lights = parseLights(file + ":curve=" + std::string(row.name)).lights;
        EXPECT_NEAR(radianceFrom(lights, {0, 0.6, 0.8})[1], decoded(row.curve, 128 / 255.0), 1e-6);
    }
    const std::string deep =
        write("d.png", 8, 4, std::vector<float>(3 * 8 * 4, 0.3F), OIIO::TypeDesc::UINT16);
    EXPECT_NEAR(radianceFrom(parseLights(deep + ":curve=srgb").lights, {})[0],
                decoded(TransferCurve::srgb, 0.3), 2e-5);
}

TEST_F(PictureFiles, TilesCompressionsGreyAndAlphaAreRead) {
    const auto expected = pattern(64 * 32 * 3);
    for (const char* compression : {"none", "rle", "zip", "zips", "piz"}) {
        const auto file = write("e.exr", 64, 32, expected, OIIO::TypeDesc::FLOAT,
                                [&](auto& spec) { spec.attribute("compression", compression); });
        EXPECT_EQ(readPictureLight(file, 1).rgb, expected) << compression;
    }
    const auto tiled = write("t.exr", 64, 32, expected, OIIO::TypeDesc::FLOAT, [](auto& spec) {
        spec.tile_width = 24, spec.tile_height = 20, spec.tile_depth = 1;
    });
    EXPECT_EQ(readPictureLight(tiled, 1).rgb, expected);
    const auto grey = write("g.exr", 8, 4, pattern(32), OIIO::TypeDesc::FLOAT,
                            [](auto& spec) { spec.channelnames = {"Y"}; });
    const auto light = readPictureLight(grey, 1);
    for (std::size_t k = 0; k < 96; ++k) EXPECT_EQ(light.rgb[k], pattern(32)[k / 3]);
    const auto alpha = write("a.png", 8, 4, std::vector<float>(4 * 32, 0.2F), OIIO::TypeDesc::UINT8,
                             [](auto& spec) { spec.attribute("oiio:UnassociatedAlpha", 1); });
    EXPECT_NEAR(radianceFrom(parseLights(alpha + ":curve=linear").lights, {})[0], 0.2, 1e-6);
}

TEST_F(PictureFiles, SixFilesAreOneCube) {
    const char* names[] = {"px", "nx", "py", "ny", "pz", "nz"};
    for (int face = 0; face < 6; ++face) {
        write(std::string("cube_") + names[face] + ".exr", 4, 4,
              std::vector<float>(48, static_cast<float>(face + 1)));
    }
    const Direction directions[] = {{0, -1, 0}, {0, 1, 0}, {0, 0, 1},
                                    {0, 0, -1}, {1, 0, 0}, {-1, 0, 0}};
    for (const char* mark : {"{face}", "%s"}) {
        const auto lights = parseLights(path(std::string("cube_") + mark + ".exr")).lights;
        for (int face = 0; face < 6; ++face) {
            EXPECT_EQ(radianceFrom(lights, directions[face])[0], face + 1) << mark;
        }
    }
    write("cube_nx.exr", 5, 5, std::vector<float>(75, 1));
    EXPECT_NE(messageOf(path("cube_{face}.exr")).find("one size"), std::string::npos);
    fs::remove(path("cube_nx.exr"));
    EXPECT_NE(messageOf(path("cube_{face}.exr")).find("cube_nx.exr"), std::string::npos);
}

TEST_F(PictureFiles, EveryLayoutGivesTheIrradianceOfItsDirections) {
    // A function of direction sampled at the pixels of each layout is the same light.
    const auto value = [](const Direction& d) { return 1 + d.x / 2 + d.y * d.z / 3; };
    const std::pair<PictureGeometry, const char*> shapes[] = {
        {{PictureLayout::latlong, 128, 64}, "latlong"},
        {{PictureLayout::angular, 128, 128}, "angular"},
        {{PictureLayout::mirrorBall, 256, 256}, "mirror-ball"},
        {{PictureLayout::cross, 256, 192}, "cross"},
        {{PictureLayout::cross, 192, 256}, "cross"},
        {{PictureLayout::faces, 64, 384}, "faces"}};
    for (const auto& [g, layout] : shapes) {
        std::vector<float> values;
        for (std::size_t row = 0; row < g.height; ++row) {
            for (std::size_t column = 0; column < g.width; ++column) {
                const Direction d =
                    g.direction(static_cast<double>(column) + 0.5, static_cast<double>(row) + 0.5);
                values.insert(values.end(), 3, static_cast<float>(value(d)));
            }
        }
        const std::string file =
            write("l.exr", static_cast<int>(g.width), static_cast<int>(g.height), values);
        const std::string spec = file + ":layout=" + layout + ",turn=25,scale=2";
        const auto lights = parseLights(spec).lights;
        const Frame frame(Orientation{0.8, 2, 0});
        // Irradiance of 1 + a.d + a product: pi + 2 pi / 3 a.n + pi / 4 (product of n).
        const Direction n = rotateAboutZ(frame.normal, -radians(25));
        const double expected = 2 * (pi + 2 * pi / 3 * n.x / 2 + pi / 4 * n.y * n.z / 3);
        for (const LightSamples& samples :
             {sampleLights(lights, frame, 4), latticeSamples(lights, frame, 100000)}) {
            double sum = 0;
            for (std::size_t k = 0; k < samples.count(); ++k) {
                sum += samples.flux[0][k] * samples.z[k];
            }
            EXPECT_NEAR(sum, expected, 4e-3 * expected) << spec;
        }
    }
}

TEST_F(PictureFiles, RowsComeFromMemoryAndFromFilesAlike) {
    const std::string file = write("r.exr", 64, 32, pattern(3 * 64 * 32));
    PictureLight light = readPictureLight(file, 3);
    PictureLight reduced = light;  // as if it had been reduced
    reduced.width = 2, reduced.height = 1, reduced.rgb.resize(6);
    reduced.fileWidth = 64, reduced.fileHeight = 32;
    EXPECT_EQ(fileGeometryOf(reduced).width, 64U);
    std::vector<float> fromFile;
    forEachRow(reduced, [&](std::size_t row, std::span<const float> rgb) {
        EXPECT_EQ(row, fromFile.size() / (3 * 64));
        fromFile.insert(fromFile.end(), rgb.begin(), rgb.end());
    });
    EXPECT_EQ(fromFile, light.rgb);
}

TEST_F(PictureFiles, FluxOfALargePictureSurvivesItsReduction) {
    // 4608 x 2304 is more than is held; a lamp of 3 x 3 pixels has most of the flux.
    std::vector<float> values(3 * 4608 * 2304, 0.25F);
    for (std::size_t row = 700; row < 703; ++row) {
        for (std::size_t column = 1001; column < 1004; ++column) {
            for (std::size_t c = 0; c < 3; ++c) values[3 * (row * 4608 + column) + c] = 1e6F;
        }
    }
    const std::string file = write("large.exr", 4608, 2304, values, OIIO::TypeDesc::FLOAT);
    const PictureLight light = readPictureLight(file, 1);
    EXPECT_LE(light.width * light.height, mostHeldPixels);
    EXPECT_EQ(fileGeometryOf(light).width, 4608U);
    const auto flux = [](const PictureGeometry& g, auto at) {
        double sum = 0;
        for (std::size_t row = 0; row < g.height; ++row) {
            double line = 0;
            for (std::size_t column = 0; column < g.width; ++column) line += at(row, column);
            sum += line * g.solidAngle(0, row);
        }
        return sum;
    };
    const double whole = flux({PictureLayout::latlong, 4608, 2304}, [&](auto row, auto column) {
        return values[3 * (row * 4608 + column)];
    });
    const double held = flux(geometryOf(light), [&](auto row, auto column) {
        return light.rgb[3 * (row * light.width + column)];
    });
    EXPECT_NEAR(held, whole, 1e-6 * whole);
}

TEST_F(PictureFiles, TruncatedFilesOfEveryFormatAreRefused) {
    for (const std::string_view name : formats) {
        const bool real = isFloat(name);
        // Noise, so that no compression makes the file short.
        std::vector<float> noise(3 * 64 * 32);
        std::uint32_t state = 1;
        for (float& value : noise) {
            state = state * 1664525U + 1013904223U;
            value = static_cast<float>(state >> 8) / 16777216.F;
        }
        const std::string file = write(std::string(name), 64, 32, noise,
                                       real ? OIIO::TypeDesc::FLOAT : OIIO::TypeDesc::UINT8);
        std::ifstream in(file, std::ios::binary);
        const std::string bytes{std::istreambuf_iterator<char>(in), {}};
        const std::string spec = file + (real ? "" : ":curve=srgb");
        EXPECT_EQ(messageOf(spec), "no input error") << name;
        for (const double share : {0.0, 0.001, 0.01, 0.1, 0.5, 0.9}) {
            const auto size =
                static_cast<std::streamsize>(static_cast<double>(bytes.size()) * share);
            std::ofstream(file, std::ios::binary | std::ios::trunc).write(bytes.data(), size);
            const std::string message = messageOf(spec);
            EXPECT_TRUE(message.starts_with(file)) << name << " at " << share << ": " << message;
            EXPECT_EQ(message.find('\n'), std::string::npos);
        }
    }
}

TEST_F(PictureFiles, AttributesLongerThanTheFileAreRefusedBeforeTheyAreRead) {
    const std::string file = write("a.exr", 4, 2, std::vector<float>(24, 1), OIIO::TypeDesc::HALF);
    std::ifstream in(file, std::ios::binary);
    std::string bytes{std::istreambuf_iterator<char>(in), {}};
    const std::string_view mark("screenWindowWidth\0float\0", 24);
    const std::size_t at = bytes.find(mark);
    ASSERT_NE(at, bytes.npos);
    for (const char* type : {"string", "floatvector", "stringvector", "float", "opaque"}) {
        std::string changed = bytes;
        changed.replace(at, mark.size() + 4,
                        std::string("x\0", 2) + type + std::string("\0\xff\xff\xff\x7f", 5));
        std::ofstream(file, std::ios::binary) << changed;
        EXPECT_NE(messageOf(file).find("longer than the file"), std::string::npos) << type;
    }
}

TEST_F(PictureFiles, StripsOfATiffFileFitItsPicture) {
    const auto strips = [&](const char* compression, std::uint32_t rows) {
        const std::string file = write("a.tif", 40, 20, std::vector<float>(2400, 0.5F),
                                       OIIO::TypeDesc::UINT8, [&](OIIO::ImageSpec& spec) {
                                           spec.attribute("compression", compression);
                                           spec.attribute("tiff:RowsPerStrip", 20);
                                       });
        std::fstream both(file, std::ios::binary | std::ios::in | std::ios::out);
        const std::string bytes{std::istreambuf_iterator<char>(both), {}};
        for (const char type : {'\3', '\4'}) {  // 278, one number; any number needs four bytes
            const std::string head{'\x16', '\1', type, '\0', '\1', '\0', '\0', '\0'};
            const std::size_t at = bytes.find(head);
            if (at == bytes.npos) continue;
            both.clear();
            both.seekp(static_cast<std::streamoff>(at + 2)).put('\4');
            both.seekp(static_cast<std::streamoff>(at + 8));
            for (int k = 0; k < 4; ++k) both.put(static_cast<char>(rows >> 8 * k & 255U));
        }
        both.close();
        return file + ":curve=srgb";
    };
    for (const char* compression : {"none", "zip", "packbits", "lzw"}) {
        for (const std::uint32_t rows : {20U, 1000U, 0xffffffffU})
            EXPECT_EQ(messageOf(strips(compression, rows)), "no input error") << rows;
        for (const std::uint32_t rows :
             {1U << 30, (1U << 31) - 1, 1U << 31, (1U << 31) + 1, 0xfffffffeU}) {
            const std::string message = messageOf(strips(compression, rows));
            EXPECT_NE(message, "no input error") << compression << ", " << rows;
        }
    }
}

TEST_F(PictureFiles, InvalidPixelsAreCountedWithTheFirstPlace) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinity = std::numeric_limits<float>::infinity();
    auto values = pattern(3 * 16 * 8);
    values[3 * (2 * 16 + 5) + 1] = -0.5F;
    values[3 * (3 * 16 + 1)] = -2;
    values[3 * (4 * 16 + 9) + 2] = nan;
    values[3 * (7 * 16 + 15) + 2] = infinity;
    const std::string file = write("bad.exr", 16, 8, values);
    EXPECT_NE(messageOf(file).find("2 pixels below 0, 1 infinite, 1 not a number; the first is "
                                   "-0.5 at column 5, row 2"),
              std::string::npos)
        << messageOf(file);
    const PictureLight light = readPictureLight(file, 1, {}, InvalidPixels::zero);
    EXPECT_EQ(light.census.total(), 4U);
    EXPECT_EQ(light.rgb[3 * (2 * 16 + 5) + 0], 0);
    // Each layout; the corners of a disc and of a cross are no light and may hold anything.
    struct Case {
        int width, height;
        const char* layout;
        std::size_t corner, used;
    };
    for (const Case& c :
         {Case{16, 8, "latlong", 999, 0}, Case{16, 16, "angular", 0, 8 * 16 + 8},
          Case{16, 16, "mirror-ball", 0, 8 * 16 + 8}, Case{16, 12, "cross", 0, 6 * 16 + 6},
          Case{12, 16, "cross", 0, 8 * 12 + 6}, Case{24, 4, "faces", 999, 5},
          Case{4, 24, "faces", 999, 5}}) {
        auto pixels = pattern(static_cast<std::size_t>(3 * c.width * c.height));
        if (c.corner != 999) pixels[3 * c.corner] = nan;
        const std::string name = write("layout.exr", c.width, c.height, pixels);
        const std::string spec = name + ":layout=" + c.layout;
        EXPECT_EQ(messageOf(spec), "no input error") << spec;
        pixels[3 * c.used] = -1;
        write("layout.exr", c.width, c.height, pixels);
        EXPECT_NE(messageOf(spec).find("1 pixels below 0"), std::string::npos) << spec;
    }
}

TEST_F(PictureFiles, SizesCurvesAndChannelsThatDoNotFitAreRefused) {
    const auto has = [&](const std::string& spec, const std::string& words) {
        const std::string message = messageOf(spec);
        EXPECT_NE(message.find(words), std::string::npos) << spec << ": " << message;
    };
    const std::string square = write("s.exr", 16, 16, pattern(3 * 256));
    has(square, "do not tell a layout");
    // The layouts of squares alone, as they are typed.
    has(square, "state one: " + square + ":layout=angular, " + square + ":layout=mirror-ball, ");
    EXPECT_EQ(messageOf(square).find("layout=cross"), std::string::npos);
    // A stated panorama may have any proportion.
    EXPECT_EQ(messageOf(square + ":layout=latlong"), "no input error");
    has(square + ":layout=cross", "4 : 3 or 3 : 4");
    has(square + ":layout=faces", "6 : 1 or 1 : 6");
    has(write("w.exr", 32, 16, pattern(3 * 512)) + ":layout=angular", "as wide as high");
    has(write("o.exr", 33, 16, pattern(3 * 33 * 16)), "do not tell a layout");
    has(square + ":layout=angular,curve=srgb", "are linear");
    has(write("l.png", 16, 8, pattern(384), OIIO::TypeDesc::UINT8), "l.png:curve=srgb");
    has(write("x.exr", 16, 8, pattern(384), OIIO::TypeDesc::FLOAT,
              [](auto& spec) {
                  spec.channelnames = {"X", "Y", "Z"};
              }),
        "has no R, G and B, nor Y alone; channels: X, Y, Z");
    has(write("c.exr", 16, 8, pattern(384), OIIO::TypeDesc::FLOAT,
              [](auto& spec) { spec.full_width = 32; }),
        "all have to be there");
    has(write("t.tif", 16, 8, pattern(384), OIIO::TypeDesc::UINT8,
              [](auto& spec) { spec.attribute("Orientation", 6); }) +
            ":curve=srgb",
        "orientation 6");
    has(write("e.exr", 8, 48, pattern(3 * 8 * 48), OIIO::TypeDesc::FLOAT,
              [](auto& spec) { spec.attribute("textureformat", "CubeFace Environment"); }),
        "OpenEXR cube");
    std::ofstream(path("n.exr")) << "no picture";
    has(path("n.exr"), "of no known picture format");
    std::ofstream(path("n.hdr")) << "#?RADIANCE\r\nFORMAT=32-bit_rle_rgbe\r\n\r\n-Y 1 +X 2\r\n";
    has(path("n.hdr"), "end in CR LF, expected LF");
    std::ofstream(path("z.exr")) << "";
    has(path("z.exr"), path("z.exr"));
    has(folder_.string() + "/absent.hdr", "no such file");
}

TEST_F(PictureFiles, NumbersInTheHeadOfPnmAndPfmAreChecked) {
    const std::string pixels(2 * 2 * 3 * 4, '\0');
    const auto read = [&](const std::string& head) {
        std::ofstream(path("picture"), std::ios::binary) << head << pixels;
        return readPictureLight(path("picture"), 1,
                                {.layout = PictureLayout::angular, .curve = TransferCurve::linear});
    };
    for (const char* head : {"P6\n2 2\n255\n", "P6 2 2 65535 ", "P6\n# 9 9 9\n2 # w\n2\n1\n"})
        EXPECT_EQ(read(head).width, 2u) << head;
    for (const auto& [head, word] : std::initializer_list<std::pair<std::string, std::string>>{
             {"P6\n2 2\n0\n", "'0'; it has to be from 1 to 65535"},
             {"P6\n2 2\n70000\n", "'70000'"},
             {"P6\n2 2\n65536\n", "'65536'"},
             {"P6\n2 2\n-255\n", "'-255'"},
             {"P6\n2 2\n255.5\n", "'255.5'"},
             {"P6\n2 2\n2e2\n", "'2e2'"},
             {"P6\n2.9 2\n255\n", "its width is '2.9'"},
             {"P6\n2 0\n255\n", "its height is '0'"},
             {"P6\n2 99999999999999999999\n255\n", "its height"}}) {
        try {
            read(head);
            ADD_FAILURE() << head;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
        }
    }
    const auto readFloats = [&](const std::string& head) {
        std::ofstream(path("picture"), std::ios::binary) << head << pixels;
        return readPictureLight(path("picture"), 1, {.layout = PictureLayout::angular});
    };
    for (const char* scale : {"-1.0", "2.5", "-1e-3"})
        EXPECT_EQ(readFloats(std::string("PF\n2 2\n") + scale + "\n").width, 2u) << scale;
    for (const char* scale : {"0", "-0.0", "nan", "inf", "1x", "--1"}) {
        try {
            readFloats(std::string("PF\n2 2\n") + scale + "\n");
            ADD_FAILURE() << scale;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find("its scale"), std::string::npos)
                << error.what();
        }
    }
}

}  // namespace
}  // namespace hshfit
