// Other elements of Mueller matrices than the reflectance: tables of the tests, NIST's measurement
// of PTFE, and the expansion that was fitted to it.

#include "places.h"
#include "skip_without.h"

#include <brdfs/catalog.h>
#include <brdfs/measured/mueller.h>
#include <brdfs/measured/pbsdf.h>
#include <brdfs/measured/scattered/scatmech.h>
#include <brdfs/measured/scattered/scattered.h>
#include <hshfit/error.h>

#include <brdfs/measured_files.h>
#include <brdfs/tensor_writer.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>

namespace hshfit {
namespace {

using brdfs::MuellerElements;
using brdfs::PbsdfBrdf;
using test::expectInputError;

double rising(double phi, double difference, double half, std::size_t wavelength) {
    return 0.2 + 0.03 * phi + 0.1 * difference + 0.05 * half + 0.3 * double(wavelength);
}

/// M00 times `share` of each element, at the place row * 4 + column.
std::string tableOf(const std::array<float, 16>& share) {
    auto fields = test::pbsdfFields({.withAngles = true}, rising);
    std::string& data = fields[4].data;
    for (std::size_t at = 0; at < data.size(); at += 16 * sizeof(float)) {
        float m00 = 0;
        std::memcpy(&m00, data.data() + at, sizeof m00);
        for (std::size_t e = 1; e < 16; ++e) {
            const float value = share[e] * m00;
            std::memcpy(data.data() + at + e * sizeof(float), &value, sizeof value);
        }
    }
    return test::tensorFile(fields);
}

/// [quantity * 2 + wavelength], at one pair of directions.
std::vector<double> valuesOf(const std::string& bytes, const std::string& elements) {
    const std::vector<unsigned char> copy(bytes.begin(), bytes.end());
    const PbsdfBrdf brdf({copy.data(), copy.size()}, "memory", MuellerElements(elements));
    return evaluate(brdf, directionFromAngles(0.7, 0.3), directionFromAngles(0.4, 2));
}

double valueOf(const std::string& bytes, const std::string& element, std::size_t channel = 0) {
    return valuesOf(bytes, element)[channel];
}

std::string nameAt(std::size_t place) {
    return "m" + std::to_string(place / 4) + std::to_string(place % 4);
}

TEST(Mueller, ElementsOfATableAreThoseAtTheirPlaces) {
    std::array<float, 16> share{};
    for (std::size_t e = 1; e < 16; ++e) share[e] = 0.05F * float(e) - 0.5F;
    share[4] = 0.3F, share[8] = -0.4F;
    const std::string bytes = tableOf(share);
    const double f = valueOf(bytes, "m00", 1);
    ASSERT_GT(f, 0);
    for (std::size_t e = 1; e < 16; ++e) {
        const std::string name = nameAt(e);
        EXPECT_NEAR(valueOf(bytes, name, 1), double{share[e]} * f, 1e-6) << name;
    }
    EXPECT_NEAR(valueOf(bytes, "dolp"), 0.5, 1e-6);  // 3, 4, 5
}

TEST(Mueller, ANodeWithoutOneElementIsLeftOutForThatOne) {
    std::array<float, 16> share{};
    share[5] = std::nanf("");
    const std::string bytes = tableOf(share);
    EXPECT_GT(valueOf(bytes, "m00"), 0);
    EXPECT_EQ(valueOf(bytes, "m11"), 0);  // no node has one
}

TEST(Mueller, ListedElementsAreThoseOfSingleOnesInTheOrderOfTheMatrix) {
    std::array<float, 16> share{};
    for (std::size_t e = 1; e < 16; ++e) share[e] = 0.05F * float(e) - 0.5F;
    const std::string bytes = tableOf(share);
    std::string all;
    for (std::size_t e = 0; e < 16; ++e) all += nameAt(15 - e) + "/";
    const std::vector<double> values = valuesOf(bytes, "all"),
                              listed = valuesOf(bytes, all + "dolp");
    ASSERT_EQ(values.size(), 32u);
    ASSERT_EQ(listed.size(), 34u);
    for (std::size_t e = 0; e < 16; ++e)
        for (std::size_t w = 0; w < 2; ++w) {
            EXPECT_EQ(values[2 * e + w], valueOf(bytes, nameAt(e), w)) << nameAt(e);
            EXPECT_EQ(listed[2 * e + w], values[2 * e + w]) << nameAt(e);
        }
    EXPECT_EQ(listed[32], valueOf(bytes, "dolp"));
}

TEST(Mueller, ChannelsBearTheNamesOfElementsAndWavelengths) {
    const MuellerElements two("m33/m00");
    EXPECT_EQ(two.channels(Channels::spectral({351, 532})).names(),
              (std::vector<std::string>{"m00_351nm", "m00_532nm", "m33_351nm", "m33_532nm"}));
    EXPECT_EQ(two.channels(Channels::grey()).names(), (std::vector<std::string>{"m00", "m33"}));
    EXPECT_EQ(two.channels(Channels::spectral({351, 532})).reflectances(), 2u);
    EXPECT_EQ(MuellerElements("m33").channels(Channels::grey()).reflectances(), 0u);
    EXPECT_EQ(MuellerElements("m00").channels(Channels::grey()), Channels::grey());
}

TEST(Mueller, UnknownAndRepeatedElementsAreNamed) {
    for (const std::string text : {"m44", "", "m00/", "m00,m01", "M00", "all/m00"})
        EXPECT_THROW(MuellerElements{text}, UsageError) << text;
    try {
        MuellerElements("m01/m10/m01");
        FAIL();
    } catch (const UsageError& error) {
        EXPECT_NE(std::string(error.what()).find("'m01' is there twice"), std::string::npos);
    }
}

class Ptfe : public testing::Test {
protected:
    static std::string file(const std::string& name) {
        return test::sharedFolder() + "/data/nist_ptfe/" + name;
    }
    static std::unique_ptr<Brdf> open(const std::string& name, const std::string& options) {
        return brdfs::open(file(name) + ":" + options);
    }
};

/// A row of the measurement: lambda, four angles, f_r11, then the elements over it.
std::vector<std::array<double, 21>> measuredRows(const std::string& path) {
    std::ifstream file(path);
    std::vector<std::array<double, 21>> rows;
    std::string line;
    std::getline(file, line);
    while (std::getline(file, line)) {
        std::istringstream cells(line);
        std::string cell;
        std::array<double, 21> row{};
        for (double& value : row) std::getline(cells, cell, ','), value = std::stod(cell);
        rows.push_back(row);
    }
    return rows;
}

/// Root mean squares over the rows of a wavelength: of the measured element, and of what the
/// expansion leaves of it, with its own sign and with the other.
struct Residuals {
    double measured = 0, left = 0, turned = 0;
};

Residuals residualsOf(const Brdf& element, const Brdf& reflectance, std::size_t column,
                      const std::vector<std::array<double, 21>>& rows, double um) {
    Residuals sums;
    double count = 0;
    for (const auto& row : rows) {
        if (row[0] != um) continue;
        const Direction wi = directionFromAngles(radians(row[1]), radians(row[2]));
        const Direction wo = directionFromAngles(radians(row[3]), radians(row[4]));
        const double m = evaluate(element, wi, wo)[0] / evaluate(reflectance, wi, wo)[0];
        sums.measured += row[column] * row[column];
        sums.left += (m - row[column]) * (m - row[column]);
        sums.turned += (m + row[column]) * (m + row[column]);
        ++count;
    }
    return {std::sqrt(sums.measured / count), std::sqrt(sums.left / count),
            std::sqrt(sums.turned / count)};
}

/// The expansion was fitted to these rows, to the elements i <= j and, by reciprocity, to the
/// elements below: its formulas and signs are right if it leaves the noise of the instrument, which
/// the elements close to 0 (M03, M30) show.
TEST_F(Ptfe, TheExpansionLeavesTheNoiseOfEveryMeasuredElement) {
    SKIP_WITHOUT(file("PTFE.coeff.csv"));
    const auto rows = measuredRows(file("PTFE.data.csv"));
    for (const double um : {0.351, 0.532, 0.633, 1.064}) {
        const std::string at = ",wavelength=" + std::to_string(std::lround(um * 1000));
        const auto reflectance = open("PTFE.coeff.csv", "mueller=m00" + at);
        for (std::size_t e = 1; e < 16; ++e) {
            const std::string name = nameAt(e);
            const auto element = open("PTFE.coeff.csv", "mueller=" + name + at);
            const Residuals r = residualsOf(*element, *reflectance, 5 + e, rows, um);
            EXPECT_LT(r.left, 0.026) << name << at;
            EXPECT_LT(r.left, 1.01 * r.measured) << name << at;
            if (r.measured > 0.025) {
                EXPECT_LT(r.left, 0.6 * r.turned) << name << at;
            }
        }
    }
}

/// A factor changes what is in 1/sr, and no ratio of it.
TEST_F(Ptfe, FactorsLeaveTheDegreeOfPolarisation) {
    SKIP_WITHOUT(file("PTFE.data.csv"));
    const auto plain = open("PTFE.data.csv", "mueller=m00/dolp"),
               twice = open("PTFE.data.csv", "mueller=m00/dolp,scale=2");
    const auto& before = dynamic_cast<const brdfs::Scattered&>(*plain).samples();
    const auto& after = dynamic_cast<const brdfs::Scattered&>(*twice).samples();
    const std::vector<std::string> names = before.channels.names();
    ASSERT_EQ(after.values.size(), before.values.size());
    for (std::size_t k = 0; k < before.values.size(); ++k)
        EXPECT_EQ(after.values[k],
                  before.values[k] * (names[k % names.size()].starts_with("m00") ? 2 : 1))
            << names[k % names.size()];
    EXPECT_EQ(after.census.greatest, std::ranges::max(after.values));
}

/// Every value that is read of every row, by the numbers of the rows.
TEST_F(Ptfe, MeasuredElementsAreThoseOfTheFile) {
    SKIP_WITHOUT(file("PTFE.data.csv"));
    const auto rows = measuredRows(file("PTFE.data.csv"));
    const auto brdf = open("PTFE.data.csv", "mueller=all"),
               dolp = open("PTFE.data.csv", "mueller=dolp");
    EXPECT_FALSE(brdf->laws().reciprocal);
    EXPECT_FALSE(brdf->laws().nonNegative);
    EXPECT_TRUE(dolp->laws().nonNegative);
    const auto& samples = dynamic_cast<const brdfs::Scattered&>(*brdf).samples();
    const auto& degrees = dynamic_cast<const brdfs::Scattered&>(*dolp).samples();
    ASSERT_EQ(samples.channels.count(), 64u);
    for (std::size_t k = 0; k < samples.size(); ++k)
        for (std::size_t w = 0; w < 4; ++w) {
            const auto& row = rows[samples.rows[64 * k + w] - 2];
            EXPECT_NEAR(row[0] * 1000, samples.channels.wavelengths[w], 1e-9);
            EXPECT_EQ(samples.values[64 * k + w], row[5]);
            for (std::size_t e = 1; e < 16; ++e)
                EXPECT_NEAR(samples.values[64 * k + 4 * e + w], row[5] * row[5 + e], 1e-12);
            EXPECT_NEAR(degrees.values[4 * k + w], std::hypot(row[9], row[13]), 1e-12);
        }
}

TEST_F(Ptfe, ListedElementsAreThoseOfSingleOnes) {
    SKIP_WITHOUT(file("PTFE.coeff.csv"));
    // M00 alone is taken as reciprocal and mirrored, which the other elements are not.
    const std::string plain = "exchange=no,mirror=no,mueller=";
    for (const auto& [name, options] :
         {std::pair<std::string, std::string>{"PTFE.coeff.csv", "mueller="},
          {"PTFE.data.csv", plain}}) {
        const auto all = open(name, options + "all");
        ASSERT_EQ(all->channels().count(), 64u);
        for (const std::size_t e : {0, 1, 4, 6, 11, 15}) {
            const auto one = open(name, options + nameAt(e));
            for (const double theta : {0.2, 0.8, 1.2}) {
                const Direction wi = directionFromAngles(theta, 0.2),
                                wo = directionFromAngles(0.7, 2.9);
                const auto values = evaluate(*all, wi, wo), single = evaluate(*one, wi, wo);
                for (std::size_t w = 0; w < 4; ++w)
                    EXPECT_NEAR(values[4 * e + w], single[w], 1e-14) << name << nameAt(e);
            }
        }
    }
}

TEST_F(Ptfe, ElementsAreThoseOfAnIsotropicSample) {
    SKIP_WITHOUT(file("PTFE.coeff.csv"));
    const Direction wi = directionFromAngles(1, 0.2), wo = directionFromAngles(0.8, 2.5);
    for (const char* name : {"dolp", "m10", "m12"}) {
        const auto brdf = open("PTFE.coeff.csv", std::string("mueller=") + name);
        const double before = evaluate(*brdf, wi, wo)[0];
        EXPECT_NE(before, 0);
        EXPECT_NEAR(evaluate(*brdf, rotateAboutZ(wi, 1.1), rotateAboutZ(wo, 1.1))[0], before,
                    1e-13);
    }
}

TEST(Mueller, AnElementWithoutRowsIsNamed) {
    const std::string table = "1,1,0,0,0,0,0,0.2\n1,2,2,2,0,0,0,0.1\n";
    const auto brdf =
        brdfs::readScatmech(table, "t", "t", {.elements = MuellerElements("m00/m01/dolp")});
    EXPECT_EQ(brdf->channels().names(), (std::vector<std::string>{"m00", "m01", "dolp"}));
    expectInputError(
        [&] { brdfs::readScatmech(table, "t", "t", {.elements = MuellerElements("m01/m22")}); },
        {"no row of m22"});
}

TEST_F(Ptfe, OnlyTheReflectanceIsFitted) {
    SKIP_WITHOUT(file("PTFE.coeff.csv"));
    EXPECT_NO_THROW(brdfs::requireReflectance(*open("PTFE.coeff.csv", "mueller=m00"), "fit"));
    for (const char* name : {"PTFE.coeff.csv", "PTFE.data.csv"}) {
        expectInputError([&] { brdfs::requireReflectance(*open(name, "mueller=m01"), "fit"); },
                         {"m01_351nm is no reflectance", "mueller=m00"});
        expectInputError([&] { brdfs::requireReflectance(*open(name, "mueller=all"), "fit"); },
                         {"m01_351nm is no reflectance", "mueller=m00"});
    }
}

}  // namespace
}  // namespace hshfit
