#include "places.h"

#include <brdfs/catalog.h>
#include <brdfs/measured/pbsdf.h>
#include <hshfit/projection/albedo.h>

#include <brdfs/measured_files.h>
#include <brdfs/tensor_writer.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace hshfit {
namespace {

using brdfs::PbsdfBrdf;
using test::expectInputError;
using test::TemporaryFile;
using test::TensorField;

constexpr std::uint64_t azimuths = 7, differences = 5, halves = 4, wavelengths = 2;

/// Linear in the angles, so that the interpolation is exact.
double reflectance(double phi, double difference, double half, std::size_t wavelength) {
    return 0.2 + 0.03 * phi + 0.1 * difference + 0.05 * half + 0.3 * double(wavelength);
}

std::vector<TensorField> fields(bool withAngles = true) {
    return test::pbsdfFields({.withAngles = withAngles}, reflectance);
}

PbsdfBrdf fromBytes(const std::string& bytes) {
    const std::vector<unsigned char> copy(bytes.begin(), bytes.end());
    return PbsdfBrdf({copy.data(), copy.size()}, "memory");
}

/// wi and wo from Rusinkiewicz's angles, built forwards: d in the frame (t, b, h) of the half
/// vector, t away from the normal.
std::pair<Direction, Direction> directions(double half, double difference, double phi) {
    const double sh = std::sin(half), ch = std::cos(half);
    const double dx = std::sin(difference) * std::cos(phi);
    const double dy = std::sin(difference) * std::sin(phi), dz = std::cos(difference);
    // h = (sh, 0, ch), t = (ch, 0, -sh), b = n x h = (0, 1, 0)
    const Direction wi{dx * ch + dz * sh, dy, -dx * sh + dz * ch};
    const Direction wo{-dx * ch + dz * sh, -dy, dx * sh + dz * ch};
    return {wi, wo};
}

TEST(Pbsdf, interpolatesM00InTheAngles) {
    for (const bool withAngles : {true, false}) {
        const PbsdfBrdf brdf = fromBytes(test::tensorFile(fields(withAngles)));
        EXPECT_EQ(brdf.channels().wavelengths, (std::vector<double>{450, 650}));
        std::mt19937 random(3);
        std::uniform_real_distribution<> unit(0.02, 0.98);
        int checked = 0;
        while (checked < 300) {
            const double h = unit(random) * pi / 2, d = unit(random) * pi / 2;
            const double p = (2 * unit(random) - 1) * pi;
            auto [wi, wo] = directions(h, d, p);
            if (wi.z < 0.01 || wo.z < 0.01) continue;
            ++checked;
            const double turn = double(checked);
            const auto f = evaluate(brdf, rotateAboutZ(wi, turn), rotateAboutZ(wo, turn));
            EXPECT_NEAR(f[0], reflectance(p, d, h, 0), 1e-5);
            EXPECT_NEAR(f[1], reflectance(p, d, h, 1), 1e-5);
        }
    }
}

TEST(Pbsdf, nodesWithoutAValueAreLeftOut) {
    auto file = fields();
    // Everything but the value at the normal is missing, once as NaN and once as 0.
    for (const float missing : {std::nanf(""), 0.0F}) {
        for (std::size_t i = 0; i < file[4].data.size(); i += 4) {
            const bool keep = i / 64 / wavelengths % halves == 0;
            if (!keep) std::memcpy(file[4].data.data() + i, &missing, 4);
        }
        const PbsdfBrdf brdf = fromBytes(test::tensorFile(file));
        const auto [wi, wo] = directions(0.2, 0.3, 1);
        EXPECT_NEAR(evaluate(brdf, wi, wo)[0], reflectance(1, 0.3, 0, 0), 1e-5);
        unsigned char covered = 2;
        brdf.coverage(wo, {&wi.x, &wi.y, &wi.z, 1}, &covered);
        EXPECT_EQ(covered, 1);
        const auto [far, back] = directions(1.1, 0.1, 1);
        EXPECT_EQ(evaluate(brdf, far, back)[0], 0);
        brdf.coverage(back, {&far.x, &far.y, &far.z, 1}, &covered);
        EXPECT_EQ(covered, 0);
        const auto census = brdf.census();
        EXPECT_EQ(census.values, azimuths * differences * halves * wavelengths);
        EXPECT_GT(census.invalid, 0u);
    }
}

TEST(Pbsdf, everyTruncationIsRefused) {
    const std::string whole = test::tensorFile(fields());
    EXPECT_NO_THROW(fromBytes(whole));
    const std::size_t head = whole.size() - fields()[4].data.size();
    for (std::size_t size = 0; size < whole.size(); size += size < head ? 1 : 61) {
        expectInputError([&] { fromBytes(whole.substr(0, size)); }, {"memory: "});
    }
}

TEST(Pbsdf, fieldsAreNotTrusted) {
    constexpr std::uint64_t most = std::numeric_limits<std::uint64_t>::max();
    for (std::size_t i = 0; i < 5; ++i) {
        const std::string name = fields()[i].name;
        auto missing = fields();
        missing.erase(missing.begin() + static_cast<std::ptrdiff_t>(i));
        expectInputError([&] { fromBytes(test::tensorFile(missing)); }, {"has no field " + name});
        auto retyped = fields();
        retyped[i].type = 5;
        expectInputError([&] { fromBytes(test::tensorFile(retyped)); }, {"field "});
        for (const std::uint64_t size : {std::uint64_t{0}, std::uint64_t{3}, most, most / 2}) {
            auto reshaped = fields();
            reshaped[i].shape.back() = size;
            expectInputError([&] { fromBytes(test::tensorFile(reshaped)); }, {"field "});
        }
        if (i == 3) continue;
        auto infinite = fields();
        const float bad = INFINITY;
        std::memcpy(infinite[i].data.data(), &bad, 4);
        expectInputError([&] { fromBytes(test::tensorFile(infinite)); }, {"field " + name});
    }
    auto descending = fields();
    const float low = -4;
    std::memcpy(descending[1].data.data() + 8, &low, 4);
    expectInputError([&] { fromBytes(test::tensorFile(descending)); },
                     {"field theta_d", "value 2 is -4"});
}

TEST(Pbsdf, isToldFromRglByContent) {
    const TemporaryFile file(test::tensorFile(fields()), ".bsdf");
    EXPECT_EQ(brdfs::open(file.path())->channels().count(), 2u);
    const TemporaryFile rgl(test::tensorFile(test::rglFields({})), ".pbsdf");
    EXPECT_EQ(brdfs::open(rgl.path())->channels().kind, Channels::Kind::rgb);
}

TEST(Pbsdf, spectralonIsWhiteAndNearlyLambertian) {
    const std::string path = test::sharedFolder() + "/data/rgl/spectralon_lowres.pbsdf";
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
    const auto brdf = brdfs::open(path);
    EXPECT_EQ(brdf->channels().wavelengths, (std::vector<double>{450, 500, 550, 600, 650}));
    // A node, read from its place in the file: phi_d 5, theta_d 2, theta_h 2, 550 nm.
    std::ifstream file(path, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    float stored = 0;
    std::memcpy(&stored, bytes.data() + 232 + 64 * (((5 * 9 + 2) * 9 + 2) * 5 + 2), 4);
    const auto [wi, wo] = directions(2 * pi / 16, 2 * pi / 16, -pi + 5 * 2 * pi / 21);
    EXPECT_NEAR(evaluate(*brdf, wi, wo)[2], stored, 1e-6);
    double least = 1, greatest = 0;
    for (const double theta : {8.0, 30.0, 45.0}) {
        const auto albedo = directionalAlbedo(*brdf, directionFromAngles(radians(theta), 0), 3e-3);
        std::cout << theta << " degrees:";
        for (const double a : albedo) std::cout << " " << a;
        std::cout << "\n";
        const auto [low, high] = std::minmax_element(albedo.begin(), albedo.end());
        EXPECT_LT(*high / *low, 1.03);  // white
        EXPECT_LT(*high, 1);
        least = std::min(least, *low);
        greatest = std::max(greatest, *high);
    }
    // The albedo is constant. Its value depends on the file's scale (docs/reference/measured.md).
    EXPECT_LT(greatest / least, 1.05);
}

}  // namespace
}  // namespace hshfit
