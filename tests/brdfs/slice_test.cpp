#include "places.h"

#include <brdfs/catalog.h>
#include <brdfs/measured/gridded/slice.h>
#include <brdfs/measured/gridded/slice_writer.h>
#include <brdfs/measured/merl.h>

#include <brdfs/gridded_files.h>
#include <gtest/gtest.h>

#include <ImfInputFile.h>
#include <ImfRgbaFile.h>
#include <ImfStringAttribute.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

namespace hshfit {
namespace {

using brdfs::SliceBrdf;
using brdfs::writeSlices;
using test::TemporaryFile;

const std::string merlSlices = test::sharedFolder() + "/data/merl_slices";

std::string contentOf(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

std::unique_ptr<SliceBrdf> slice(const test::SliceCells& cells) {
    const std::string bytes = test::merlSliceFile(cells);
    return brdfs::readMerlSlice(
        {reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()}, "slice");
}

/// Rusinkiewicz' rotations by the book: the difference direction is tilted by theta_h about y and
/// turned by phi_h about z. Degrees.
DirectionPair pairAt(double thetaHalf, double phiHalf, double thetaDifference, double phi) {
    const double sh = std::sin(radians(thetaHalf)), ch = std::cos(radians(thetaHalf));
    const double sd = std::sin(radians(thetaDifference)), cd = std::cos(radians(thetaDifference));
    const double dx = sd * std::cos(radians(phi)), dy = sd * std::sin(radians(phi));
    const auto tilted = [&](double x, double y) {
        return rotateAboutZ({ch * x + sh * cd, y, ch * cd - sh * x}, radians(phiHalf));
    };
    return {tilted(dx, dy), tilted(-dx, -dy)};
}

TEST(MerlSlice, equalsAMerlTableThatDoesNotDependOnTheAzimuth) {
    const auto value = [](int c, int h, int d) {
        return static_cast<float>((c * 7919 + h * 104729 + d * 1299709) % 1000) / 64;
    };
    const TemporaryFile file(test::merlFile([&](int c, int h, int d, int) {
        return value(c, h, d) / brdfs::merlScale[static_cast<std::size_t>(c)];
    }));
    const brdfs::MerlBrdf table(file.path());
    const auto brdf = slice(value);
    EXPECT_TRUE(brdf->laws().isotropic && brdf->laws().reciprocal && brdf->laws().mirrorSymmetric);
    std::mt19937 random(1);
    for (int k = 0; k < 5000; ++k) {
        const Direction wi = test::randomDirection(random), wo = test::randomDirection(random);
        const auto f = evaluate(*brdf, wi, wo), expected = evaluate(table, wi, wo);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(f[c], expected[c], 1e-9);
    }
    for (const double theta : {0.0, 0.5, 1.3}) {
        const Direction wo = directionFromAngles(theta, 1);
        EXPECT_NEAR(brdf->lobes(wo).empty() ? 0 : brdf->lobes(wo)[0].width,
                    table.lobes(wo).empty() ? 0 : table.lobes(wo)[0].width, 1e-12);
    }
}

TEST(MerlSlice, coversItsPlaneOnly) {
    const auto brdf =
        slice([](int c, int h, int d) { return c == 1 && h > 40 && d > 50 ? -1 : 2; });
    const auto covered = [&](double h, double d, double p) {
        const auto [wi, wo] = pairAt(h, 20, d, p);
        unsigned char result = 2;
        brdf->coverage(wo, {&wi.x, &wi.y, &wi.z, 1}, &result);
        return int(result);
    };
    EXPECT_EQ(covered(10, 30, 90), 1);
    EXPECT_EQ(covered(10, 30, 270), 1) << "by reciprocity";
    EXPECT_EQ(covered(10, 30, 90.9), 1) << "0.45 degrees from the plane";
    EXPECT_EQ(covered(10, 30, 91.1), 0) << "0.55 degrees from it";
    EXPECT_EQ(covered(10, 30, 0), 0);
    EXPECT_EQ(covered(10, 0.4, 0), 1) << "all of phi_d is near where theta_d is small";
    EXPECT_EQ(covered(30, 60, 90), 0) << "invalid";
    EXPECT_EQ(evaluate(*brdf, pairAt(30, 0, 60, 90).wi, pairAt(30, 0, 60, 90).wo)[1], 0);
    const brdfs::Census census = brdf->census();
    EXPECT_EQ(census.values, 24300u);
    EXPECT_EQ(census.invalid, 49u * 39u);
}

TEST(MerlSlice, valuesThatAreNotFiniteAreReported) {
    for (const float bad : {std::nanf(""), INFINITY, -INFINITY}) {
        const auto brdf =
            slice([bad](int c, int h, int d) { return c == 2 && h == 45 && d == 20 ? bad : 3.F; });
        const auto [wi, wo] = pairAt(22.7, 0, 20.2, 90);
        EXPECT_NEAR(evaluate(*brdf, wi, wo)[2], 3, 1e-6);
        test::expectInputError([&] { brdf->checkIntact(); },
                               {"channel B at theta_h 22.5, theta_d 20, phi_d 90"});
        EXPECT_NO_THROW(brdf->checkReadable());
        EXPECT_EQ(brdf->census().notANumber + brdf->census().infinite, 1u);
    }
}

TEST(MerlSlice, everyRealSliceLoads) {
    if (!std::filesystem::is_directory(merlSlices)) {
        GTEST_SKIP() << merlSlices << " is absent";
    }
    int files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(merlSlices)) {
        if (entry.path().extension() != ".slice") continue;
        ++files;
        const auto brdf = brdfs::open(entry.path().string());
        const auto& read = dynamic_cast<const SliceBrdf&>(*brdf);
        EXPECT_NO_THROW(read.checkIntact());
        const brdfs::Census census = read.census();
        EXPECT_EQ(census.values, 24300u);
        EXPECT_EQ(census.notANumber + census.infinite, 0u);
        const std::string bytes = contentOf(entry.path().string());
        for (int d = 1; d < 90; d += 11)
            for (int h = 1; h < 90; h += 7) {
                const auto [wi, wo] = pairAt(h * h / 90.0, 33, d, 90);
                const auto f = evaluate(read, wi, wo);
                for (std::size_t c = 0; c < 3; ++c) {
                    float stored;
                    std::memcpy(&stored, bytes.data() + 4 * (3 * (90 * d + h) + c), 4);
                    EXPECT_NEAR(f[c], std::max(stored, 0.F), 1e-6 * (1 + stored)) << entry.path();
                }
            }
    }
    EXPECT_EQ(files, 60);
}

// A picture that ALTA made of the MERL table red-fabric, cell by cell without interpolation,
// against the `.slice` of that table, which comes from elsewhere: both readings of the axes agree.
TEST(SlicePicture, aPictureByAltaShowsTheSliceOfTheSameMaterial) {
    const std::string path = test::sharedFolder() + "/data/alta/data-example-01.exr";
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is absent";
    const auto brdf = brdfs::open(path);
    ASSERT_NE(dynamic_cast<const SliceBrdf*>(brdf.get()), nullptr);
    const std::string bytes = contentOf(merlSlices + "/red-fabric.slice");
    ASSERT_EQ(bytes.size(), 97200u);
    int pixels = 0, equal = 0;
    for (int row = 0; row < 512; row += 3)
        for (int column = 0; column < 512; column += 3) {
            const double thetaHalf = (column + 0.5) / 512 * 90, d = (row + 0.5) / 512 * 90;
            const auto [wi, wo] = pairAt(thetaHalf, 0, d, 90);
            const auto f = evaluate(*brdf, wi, wo);
            const int h = static_cast<int>(90 * std::sqrt(thetaHalf / 90));
            float stored[3];
            std::memcpy(stored, bytes.data() + 12 * (90 * static_cast<int>(d) + h), 12);
            ++pixels;
            bool same = true;
            for (int c = 0; c < 3; ++c) same = same && std::fabs(f[c] / stored[c] - 1) < 1e-3;
            equal += same;
        }
    // At the edges of its cells ALTA's rounding may choose the neighbour.
    EXPECT_GT(equal, 0.94 * pixels);
    std::printf("equal within half precision: %d of %d pixels\n", equal, pixels);
}

/// The picture as OpenEXR reads it, without the library.
struct Picture {
    explicit Picture(const std::string& path) : file(path.c_str(), 0) {
        const auto box = file.header().dataWindow();
        width = box.max.x + 1;
        height = box.max.y + 1;
        Imf::FrameBuffer buffer;
        for (auto i = file.header().channels().begin(); i != file.header().channels().end(); ++i) {
            auto& plane = planes[i.name()];
            plane.resize(static_cast<std::size_t>(width * height));
            types[i.name()] = i.channel().type;
            buffer.insert(i.name(), Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(plane.data()), 4,
                                               4 * static_cast<std::size_t>(width)));
        }
        file.setFrameBuffer(buffer);
        file.readPixels(0, height - 1);
    }
    float at(const std::string& channel, int row, int column) const {
        return planes.at(channel)[static_cast<std::size_t>(row * width + column)];
    }
    std::string attribute(const char* name) const {
        return file.header().typedAttribute<Imf::StringAttribute>(name).value();
    }
    Imf::InputFile file;
    int width = 0, height = 0;
    std::map<std::string, std::vector<float>> planes;
    std::map<std::string, Imf::PixelType> types;
};

TEST(SlicesWriter, pixelsAreTheBrdfAtTheirAngles) {
    const auto brdf = brdfs::open("ggx:alpha=0.3,F0=0.9/0.5/0.2,kd=0.1");
    for (const bool root : {false, true}) {
        const TemporaryFile file({}, ".exr");
        writeSlices(*brdf, file.path(), {.size = 24, .rootHalf = root, .slices = 4},
                    {.force = true});
        const Picture picture(file.path());
        ASSERT_EQ(picture.width, 24);
        ASSERT_EQ(picture.height, 24);
        EXPECT_EQ(picture.planes.size(), 12u);
        EXPECT_EQ(picture.types.at("R"), Imf::FLOAT);
        EXPECT_EQ(picture.attribute("hshfit:theta_half"), root ? "root" : "linear");
        EXPECT_EQ(picture.attribute("hshfit:phi_difference"), "90 135 0 45");
        for (int row = 0; row < 24; ++row)
            for (int column = 0; column < 24; ++column) {
                const double x = (column + 0.5) / 24, d = 90 * (23.5 - row) / 24;
                for (const auto& [layer, phi] :
                     {std::pair{"", 90}, {"phi135.", 135}, {"phi000.", 0}, {"phi045.", 45}}) {
                    const auto [wi, wo] = pairAt(90 * (root ? x * x : x), 0, d, phi);
                    if (std::fabs(std::min(wi.z, wo.z)) < 1e-9) continue;  // on the horizon
                    const auto f = std::min(wi.z, wo.z) > 0 ? evaluate(*brdf, wi, wo)
                                                            : std::vector<double>(3, 0.0);
                    const char* names[] = {"R", "G", "B"};
                    for (int c = 0; c < 3; ++c) {
                        EXPECT_NEAR(picture.at(std::string(layer) + names[c], row, column), f[c],
                                    1e-6 * (1 + f[c]))
                            << layer << row << " " << column;
                    }
                }
            }
    }
}

TEST(SlicesWriter, itsFilesAreReadBack) {
    const auto brdf = brdfs::open("ggx:alpha=0.4,F0=0.9/0.5/0.2,kd=0.1");
    for (const std::size_t slices : {1, 5}) {
        const TemporaryFile file({}, ".exr");
        const auto notes = writeSlices(*brdf, file.path(), {.size = 288, .slices = slices},
                                       {.force = true});  // the size of a UTIA picture
        EXPECT_FALSE(notes.empty());
        const auto read = brdfs::open(file.path());
        const auto& back = dynamic_cast<const SliceBrdf&>(*read);
        EXPECT_EQ(back.layout().phi.size(), slices);
        EXPECT_EQ(back.laws().reciprocal, true);
        std::mt19937 random(6);
        for (int k = 0; k < 500; ++k) {
            const double column = 0.5 + static_cast<double>(random() % 200);
            const double row = 0.5 + static_cast<double>(random() % 200);
            const double phi = slices == 1 ? 90 : 90 + 36.0 * static_cast<double>(random() % 5);
            const auto [wi, wo] = pairAt(column / 288 * 90, 77, row / 288 * 90, phi);
            if (std::min(wi.z, wo.z) < 0.05) continue;
            const auto f = evaluate(back, wi, wo), expected = evaluate(*brdf, wi, wo);
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(f[c], expected[c], 1e-5 * expected[c]);
        }
    }
}

TEST(SlicesWriter, greySpectralAndHalf) {
    class Spectral : public Brdf {
    public:
        std::string name() const override { return "spectral"; }
        const Channels& channels() const override { return channels_; }
        const Laws& laws() const override { return laws_; }
        void eval(const Direction&, DirectionBatch wi, double* out) const override {
            for (std::size_t k = 0; k < wi.count; ++k) {
                out[k] = wi.z[k];
                out[wi.count + k] = 0.5;
            }
        }
        Channels channels_ = Channels::spectral({450, 550.5});
        Laws laws_{.isotropic = true};
    };
    const TemporaryFile file({}, ".exr");
    writeSlices(Spectral(), file.path(), {.size = 8, .halfPixels = true, .slices = 2},
                {.force = true});
    const Picture picture(file.path());
    EXPECT_EQ(picture.types.at("450nm"), Imf::HALF);
    EXPECT_EQ(picture.at("550,5nm", 3, 3), 0.5);
    EXPECT_EQ(picture.attribute("hshfit:phi_period"), "360");
    EXPECT_EQ(picture.planes.count("phi270.450nm"), 1u);
    const auto read = brdfs::open(file.path());
    EXPECT_EQ(read->channels().wavelengths, (std::vector<double>{450, 550.5}));
    EXPECT_FALSE(read->laws().reciprocal);
    const auto [wi, wo] = pairAt(90 * 2.5 / 8, 0, 90 * 3.5 / 8, 270);
    EXPECT_NEAR(evaluate(*read, wi, wo)[0], wi.z, 1e-3);
    writeSlices(*brdfs::open("lambert"), file.path(), {.size = 2}, {.force = true});
    EXPECT_NEAR(Picture(file.path()).at("Y", 0, 1), 1 / pi, 1e-7);
    EXPECT_EQ(brdfs::open(file.path())->channels().kind, Channels::Kind::grey);
}

TEST(SlicesWriter, displaysAsPlainRgb) {
    const TemporaryFile file({}, ".exr");
    writeSlices(*brdfs::open("lambert:kd=0.2/0.4/0.8"), file.path(), {.size = 4}, {.force = true});
    Imf::RgbaInputFile rgba(file.path().c_str());
    std::array<Imf::Rgba, 16> pixels;
    rgba.setFrameBuffer(pixels.data(), 1, 4);
    rgba.readPixels(0, 3);
    EXPECT_NEAR(pixels[5].r, 0.2 / pi, 1e-4);
    EXPECT_NEAR(pixels[5].b, 0.8 / pi, 2e-4);
    const std::string command = "exrheader '" + file.path() + "' > /dev/null 2>&1";
    const int status = std::system("command -v exrheader > /dev/null 2>&1");
    if (status == 0) {
        EXPECT_EQ(std::system(command.c_str()), 0);
    }
}

TEST(SlicesWriter, refusesWhatPixelsCannotHold) {
    class Broken : public Brdf {
    public:
        explicit Broken(double value) : value_(value) {}
        std::string name() const override { return "broken"; }
        const Channels& channels() const override { return channels_; }
        const Laws& laws() const override { return laws_; }
        void eval(const Direction&, DirectionBatch wi, double* out) const override {
            std::fill_n(out, wi.count, value_);
        }
        double value_;
        Channels channels_;
        Laws laws_{.isotropic = true};
    };
    const TemporaryFile file("standing", ".exr");
    for (const double bad : {-1.0, std::nan(""), 1e39}) {
        EXPECT_THROW(writeSlices(Broken(bad), file.path(), {.size = 4}, {.force = true}),
                     NumericError);
    }
    EXPECT_THROW(
        writeSlices(Broken(7e4), file.path(), {.size = 4, .halfPixels = true}, {.force = true}),
        NumericError);
    EXPECT_THROW(writeSlices(Broken(1), file.path(), {.size = 8192, .slices = 2}, {.force = true}),
                 UsageError);
    EXPECT_THROW(writeSlices(Broken(1), file.path(), {.size = 4}, {}), OutputError);
    EXPECT_EQ(contentOf(file.path()), "standing");
}

}  // namespace
}  // namespace hshfit
