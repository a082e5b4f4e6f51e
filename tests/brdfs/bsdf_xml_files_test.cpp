// The real files: what they hold, and that opened BRDFs integrate to the reflectances that the
// files' own definitions imply.

#include <brdfs/catalog.h>
#include <hshfit/projection/albedo.h>

#include "bsdf_xml_files.h"
#include "places.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>

namespace hshfit {
namespace {

using namespace test;
using brdfs::KlemsBrdf;
using brdfs::TreeBrdf;

std::string shared(const std::string& name) {
    return test::sharedFolder() + "/data/bsdf_xml/" + name;
}

#define NEEDS(name) \
    if (!std::filesystem::exists(shared(name))) GTEST_SKIP() << shared(name) << " is absent"

/// The numbers of the nth ScatteringData of a file, without the reader.
std::vector<double> numbersOf(const std::string& path, int nth) {
    std::ifstream file(path);
    std::string text{std::istreambuf_iterator<char>(file), {}};
    std::size_t at = 0;
    for (int k = 0; k <= nth; ++k) at = text.find("<ScatteringData>", at) + 16;
    std::vector<double> numbers;
    for (const char* from = text.c_str() + at;;) {
        while (*from == ',' || std::isspace(static_cast<unsigned char>(*from))) ++from;
        char* end = nullptr;
        const double value = std::strtod(from, &end);
        if (end == from) return numbers;
        numbers.push_back(value);
        from = end;
    }
}

void expectKlems(const std::string& spec, const std::string& path, int block) {
    SCOPED_TRACE(spec);
    const auto brdf = brdfs::open(spec);
    const auto& klems = dynamic_cast<const KlemsBrdf&>(*brdf);
    const std::vector<double> numbers = numbersOf(path, block);
    ASSERT_EQ(numbers.size(), 145u * 145);
    const std::vector<double> solid = projectedSolidAngles(klemsFull);
    double largest = 0, defect = 0, sum = 0;
    for (std::size_t i = 0; i < 145; ++i) {
        double reflectance = 0;
        for (std::size_t o = 0; o < 145; ++o) reflectance += numbers[145 * o + i] * solid[o];
        EXPECT_NEAR(klems.directionalReflectance(0, i), reflectance, 1e-12) << i;
        largest = std::max(largest, reflectance);
    }
    EXPECT_GT(largest, 0.1);
    EXPECT_LT(largest, 1);
    // For one outgoing direction the albedo is the sum over a row.
    for (const std::size_t o : {0u, 30u, 100u, 140u}) {
        std::size_t ring = 0, j = o;
        while (j >= static_cast<std::size_t>(klemsFull[ring].azimuths)) {
            j -= static_cast<std::size_t>(klemsFull[ring++].azimuths);
        }
        const double theta = o == 0 ? 1 : (klemsFull[ring].lower + klemsFull[ring].upper) / 2;
        const double phi = 360.0 * static_cast<double>(j) / klemsFull[ring].azimuths;
        Direction wo = directionFromAngles(radians(theta), radians(phi));
        if (spec == path) wo.x = -wo.x;  // front
        double albedo = 0;
        for (std::size_t i = 0; i < 145; ++i) albedo += numbers[145 * o + i] * solid[i];
        EXPECT_NEAR(directionalAlbedo(*brdf, wo, 2e-3)[0], albedo, 0.01 * albedo) << o;
    }
    const brdfs::Census census = klems.census();
    EXPECT_EQ(census.values, 145u * 145);
    EXPECT_EQ(census.negative + census.notANumber + census.infinite, 0u);
    std::mt19937 random(5);
    for (int k = 0; k < 20000; ++k) {
        const Direction a = randomDirection(random), b = randomDirection(random);
        const double ab = valueOf(*brdf, a, b), ba = valueOf(*brdf, b, a);
        defect += std::abs(ab - ba);
        sum += (ab + ba) / 2;
    }
    std::printf("%s: largest reflectance %.4f, mean |f(a,b) - f(b,a)| %.4f of the mean\n",
                spec.substr(spec.rfind('/') + 1).c_str(), largest, defect / sum);
    EXPECT_EQ(brdf->laws().reciprocal, defect == 0);
}

TEST(BsdfXmlFiles, WindowFilesHaveTheReflectancesOfTheirNumbers) {
    NEEDS("2011-SA1.xml");
    const std::string path = shared("2011-SA1.xml");
    expectKlems(path, path, 2);
    expectKlems(path + ":side=back", path, 3);
    expectKlems(path + ":wavelength=solar,side=back", path, 7);
    // An even fabric, computed from an integrating sphere: values depend on elevations alone.
    EXPECT_TRUE(brdfs::open(path)->laws().isotropic);
}

TEST(BsdfXmlFiles, RadianceMatricesHaveTheReflectancesOfTheirNumbers) {
    NEEDS("klems_aniso_high.xml");
    const std::string path = shared("klems_aniso_high.xml");
    expectKlems(path + ":side=back", path, 2);
    expectKlems(path, path, 3);
    EXPECT_FALSE(brdfs::open(path)->laws().isotropic);
    expectInputError([&] { brdfs::open(path + ":wavelength=solar"); }, {"solar", "Visible"});
}

/// Sum over leaves of the text: pi times the average, by depth in braces. A leaf grid of any size
/// fills the cube of its braces.
double meanReflectance(const std::string& path, int nth) {
    std::ifstream file(path);
    std::string text{std::istreambuf_iterator<char>(file), {}};
    std::size_t at = 0;
    for (int k = 0; k <= nth; ++k) at = text.find("<ScatteringData>", at) + 16;
    double sum = 0;
    std::vector<double> inBraces;
    for (int depth = 0; text[at] != '<'; ++at) {
        if (text[at] == '{') {
            ++depth;
            inBraces.clear();
        } else if (text[at] == '}') {
            --depth;
            double mean = 0;
            for (const double v : inBraces) mean += v / static_cast<double>(inBraces.size());
            sum += mean / std::pow(16, depth);
            inBraces.clear();
        } else if (!std::isspace(static_cast<unsigned char>(text[at]))) {
            char* end = nullptr;
            inBraces.push_back(std::strtod(text.c_str() + at, &end));
            at = static_cast<std::size_t>(end - text.c_str()) - 1;
        }
    }
    return pi * sum;
}

TEST(BsdfXmlFiles, TensorTreesHaveTheReflectancesOfTheirNumbers) {
    NEEDS("blinds_20deg_t45.xml");
    const std::string path = shared("blinds_20deg_t45.xml");
    for (const bool back : {true, false}) {
        const auto brdf = brdfs::open(path + (back ? ":side=back" : ""));
        const auto& tree = dynamic_cast<const TreeBrdf&>(*brdf);
        EXPECT_EQ(tree.tree().levels(), 5);
        double mean = 0;
        const std::vector<double> reflectances = tree.directionalReflectances();
        EXPECT_EQ(reflectances.size(), 1024u);
        for (const double r : reflectances) mean += r / 1024;
        EXPECT_NEAR(mean, meanReflectance(path, back ? 1 : 2), 1e-9);
        const double largest = *std::max_element(reflectances.begin(), reflectances.end());
        std::mt19937 random(9);
        const std::vector<Direction> grid = projectedGrid(768, 720);
        for (int k = 0; k < 4; ++k) {
            const Direction wi = randomDirection(random);
            const auto side = back ? brdfs::BsdfSide::back : brdfs::BsdfSide::front;
            const auto [u, v] = shirleyChiu(-fileX(side, wi.x), -wi.y);
            const auto cell =
                static_cast<std::size_t>(u * 32) + 32 * static_cast<std::size_t>(v * 32);
            EXPECT_NEAR(reflectanceFrom(*brdf, wi, grid), reflectances[cell],
                        0.03 * reflectances[cell]);
        }
        for (int k = 0; k < 3000; ++k) {
            const Direction a = randomDirection(random), b = randomDirection(random);
            const double there = valueOf(*brdf, a, b), here = valueOf(*brdf, b, a);
            // Radiance stores symmetric reflection; large values have four digits.
            ASSERT_NEAR(there, here, 6e-4 * there);
        }
        // The narrow bright cells are not missed, for any outgoing cell.
        const std::vector<double> albedos = tree.tree().averagesOverFirst(2);
        for (int k = 0; k < 6; ++k) {
            const Direction wo = randomDirection(random, 0.2);
            const auto side = back ? brdfs::BsdfSide::back : brdfs::BsdfSide::front;
            const auto [u, v] = shirleyChiu(fileX(side, wo.x), wo.y);
            const auto cell =
                static_cast<std::size_t>(u * 32) + 32 * static_cast<std::size_t>(v * 32);
            EXPECT_NEAR(directionalAlbedo(*brdf, wo, 1e-3)[0], pi * albedos[cell],
                        0.1 * pi * albedos[cell]);
        }
        std::printf("blinds %s: mean reflectance %.4f, largest %.4f\n", back ? "back" : "front",
                    mean, largest);
    }
}

// Slats along x: mirrored at the yz plane they stay what they are, not at the xz plane. Values of a
// ray tracer with noise.
TEST(BsdfXmlFiles, SlatsAlongX) {
    NEEDS("blinds_20deg_t45.xml");
    const auto brdf = brdfs::open(shared("blinds_20deg_t45.xml") + ":side=back");
    std::mt19937 random(4);
    std::vector<double> alongX, alongY, unturned;
    for (int k = 0; k < 4000; ++k) {
        const Direction a = randomDirection(random), b = randomDirection(random);
        const double f = valueOf(*brdf, a, b);
        const double x = valueOf(*brdf, {-a.x, a.y, a.z}, {-b.x, b.y, b.z});
        const double y = valueOf(*brdf, {a.x, -a.y, a.z}, {b.x, -b.y, b.z});
        alongX.push_back(std::abs(f - x) / (f + x));
        alongY.push_back(std::abs(f - y) / (f + y));
        // If azimuths of incidence were taken from wi, reciprocity would be lost.
        const double ab = valueOf(*brdf, mirrored(a), b), ba = valueOf(*brdf, mirrored(b), a);
        unturned.push_back(std::abs(ab - ba) / (ab + ba));
    }
    std::nth_element(alongX.begin(), alongX.begin() + 2000, alongX.end());
    std::nth_element(alongY.begin(), alongY.begin() + 2000, alongY.end());
    std::nth_element(unturned.begin(), unturned.begin() + 2000, unturned.end());
    EXPECT_LT(alongX[2000], 0.02);
    EXPECT_GT(unturned[2000], 0.2);
    EXPECT_GT(alongY[2000], 0.2);
}

}  // namespace
}  // namespace hshfit
