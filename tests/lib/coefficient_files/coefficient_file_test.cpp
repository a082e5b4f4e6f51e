// Written files come back, from our reader and from independent ones.

#include <hshfit/bases/catalog.h>
#include <hshfit/coefficient_files/coefficient_file.h>
#include <hshfit/error.h>

#include "lib/coefficient_files/coefficient_samples.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdio>
#include <limits>

#include <gtest/gtest.h>

using namespace hshfit;
using samples::contentOf;
using samples::Folder;

namespace {

bool sameBits(double a, double b) {
    return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

void expectSameMetadata(const Coefficients& a, const Coefficients& b) {
    EXPECT_EQ(a.basis, b.basis);
    EXPECT_EQ(a.order, b.order);
    EXPECT_EQ(a.condonShortley, b.condonShortley);
    EXPECT_EQ(a.quantity, b.quantity);
    EXPECT_EQ(a.channels.kind, b.channels.kind);
    EXPECT_EQ(a.channels.wavelengths, b.channels.wavelengths);
    EXPECT_EQ(a.outgoing.map, b.outgoing.map);
    EXPECT_EQ(a.outgoing.width, b.outgoing.width);
    EXPECT_EQ(a.outgoing.height, b.outgoing.height);
    ASSERT_EQ(a.outgoing.size(), b.outgoing.size());
    for (std::size_t i = 0; i < a.outgoing.size(); ++i) {
        const Direction &d = a.outgoing.directions[i], &e = b.outgoing.directions[i];
        EXPECT_TRUE(sameBits(d.x, e.x) && sameBits(d.y, e.y) && sameBits(d.z, e.z)) << i;
    }
    EXPECT_EQ(a.outgoing.solidAngles, b.outgoing.solidAngles);
    EXPECT_EQ(a.isotropic, b.isotropic);
    EXPECT_EQ(a.bilateral, b.bilateral);
    EXPECT_EQ(a.reciprocal, b.reciprocal);
    EXPECT_EQ(a.energy.finite, b.energy.finite);
    EXPECT_EQ(std::isnan(a.energy.value), std::isnan(b.energy.value));
    if (a.energy.finite) {
        EXPECT_EQ(a.energy.value, b.energy.value);
        EXPECT_EQ(a.energy.error, b.energy.error);
    }
    EXPECT_EQ(a.energy.reason, b.energy.reason);
    EXPECT_EQ(a.error, b.error);
    EXPECT_EQ(a.tolerance, b.tolerance);
    EXPECT_EQ(a.source, b.source);
    EXPECT_EQ(a.generator, b.generator);
}

/// Every outgoing map x kind of channel x quantity, with its own seed.
std::vector<Coefficients> everyKind() {
    std::vector<Coefficients> all;
    std::uint64_t seed = 1;
    for (const auto& outgoing : samples::allOutgoing()) {
        for (const auto& channels : samples::allChannels()) {
            for (const auto quantity : {Quantity::brdf, Quantity::brdfCosine}) {
                all.push_back(samples::make(outgoing, channels, quantity, 3, seed++));
            }
        }
    }
    return all;
}

/// The output of a shell command.
std::string printed(const std::string& command) {
    std::FILE* pipe = ::popen(command.c_str(), "r");
    std::string out;
    std::array<char, 4096> block{};
    for (std::size_t n; pipe && (n = std::fread(block.data(), 1, block.size(), pipe)) > 0;) {
        out.append(block.data(), n);
    }
    if (!pipe || ::pclose(pipe) != 0) ADD_FAILURE() << command << "\n" << out;
    return out;
}

bool runs(const std::string& command) {
    return std::system((command + " >/dev/null 2>&1").c_str()) == 0;
}

TEST(CoefficientFile, JsonComesBackExactly) {
    const Folder folder;
    for (const Coefficients& c : everyKind()) {
        SCOPED_TRACE(c.outgoing.spec() + " " + c.channels.names()[0]);
        writeCoefficients(c, folder / "c.json");
        EXPECT_TRUE(looksLikeCoefficients(folder / "c.json"));
        const Coefficients back = readCoefficients(folder / "c.json");
        expectSameMetadata(c, back);
        ASSERT_EQ(c.values.size(), back.values.size());
        for (std::size_t i = 0; i < c.values.size(); ++i) {
            ASSERT_TRUE(sameBits(c.values[i], back.values[i])) << i << " " << c.values[i];
        }
    }
}

TEST(CoefficientFile, ExrComesBackWithinFloat32) {
    const Folder folder;
    for (const Coefficients& c : everyKind()) {
        SCOPED_TRACE(c.outgoing.spec() + " " + c.channels.names()[0]);
        writeCoefficients(c, folder / "c.exr");
        EXPECT_TRUE(looksLikeCoefficients(folder / "c.exr"));
        const Coefficients back = readCoefficients(folder / "c.exr");
        expectSameMetadata(c, back);
        ASSERT_EQ(c.values.size(), back.values.size());
        for (std::size_t i = 0; i < c.values.size(); ++i) {
            ASSERT_LE(std::abs(c.values[i] - back.values[i]),
                      std::ldexp(std::abs(c.values[i]), -24));
        }
    }
}

TEST(CoefficientFile, EveryBasisAndSlotCount) {
    const Folder folder;
    for (const auto& basis : bases::catalog()) {
        const int order = std::min(basis.maxOrder, 33);  // 1089 slots: four digits
        Coefficients c =
            samples::make(OutgoingSet::direction(1, 2), Channels::rgb(), Quantity::brdf, order, 5);
        c.basis = basis.name;
        for (const std::string name : {"c.json", "c.EXR"}) {
            writeCoefficients(c, folder / name);
            const Coefficients back = readCoefficients(folder / name);
            expectSameMetadata(c, back);
            EXPECT_EQ(static_cast<float>(c.values.back()), static_cast<float>(back.values.back()));
        }
    }
}

TEST(CoefficientFile, ExtremeDoublesSurviveInJson) {
    using Limits = std::numeric_limits<double>;
    const Folder folder;
    Coefficients c =
        samples::make(OutgoingSet::direction(1, 2), Channels::grey(), Quantity::brdf, 2, 1);
    c.values = {Limits::max(), -Limits::denorm_min(), Limits::min(), 0.1};
    writeCoefficients(c, folder / "c.json");
    EXPECT_EQ(readCoefficients(folder / "c.json").values, c.values);
    EXPECT_THROW(writeCoefficients(c, folder / "c.exr"), NumericError);
    EXPECT_FALSE(std::filesystem::exists(folder / "c.exr"));
}

TEST(CoefficientFile, AnEnergyThatDoesNotExist) {
    const Folder folder;
    Coefficients c =
        samples::make(OutgoingSet::direction(1, 2), Channels::grey(), Quantity::brdf, 2, 1);
    c.energy = {std::nan(""), std::nan(""), false, "grows \"without\" bound\nat the horizon"};
    for (const std::string name : {"c.json", "c.exr"}) {
        writeCoefficients(c, folder / name);
        expectSameMetadata(c, readCoefficients(folder / name));
    }
}

TEST(CoefficientFile, NeverWritesWhatIsNotFinite) {
    const Folder folder;
    for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
        Coefficients c =
            samples::make(OutgoingSet::elevations(4), Channels::rgb(), Quantity::brdf, 3, 1);
        c.values[40] = bad;
        for (const std::string name : {"c.json", "c.exr"}) {
            try {
                writeCoefficients(c, folder / name);
                ADD_FAILURE() << name;
            } catch (const NumericError& error) {
                EXPECT_NE(std::string(error.what())
                              .find("coefficient 4 of channel 1 at outgoing "
                                    "direction 1"),
                          std::string::npos)
                    << error.what();
            }
        }
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(CoefficientFile, AnotherExtensionIsAUsageError) {
    const Folder folder;
    const auto c =
        samples::make(OutgoingSet::direction(1, 2), Channels::grey(), Quantity::brdf, 2, 1);
    for (const std::string name : {"c.txt", "c", "json", ".json"}) {
        try {
            writeCoefficients(c, folder / name);
            ADD_FAILURE() << name;
        } catch (const UsageError& error) {
            EXPECT_NE(std::string(error.what()).find(".json"), std::string::npos);
            EXPECT_NE(std::string(error.what()).find(".exr"), std::string::npos);
        }
    }
    EXPECT_THROW(writeCoefficients(c, folder / "none/c.json"), OutputError);
    EXPECT_THROW(writeCoefficients(c, folder / "none/c.exr"), OutputError);
}

TEST(CoefficientFile, ContentDecidesBeforeTheName) {
    const Folder folder;
    const auto c =
        samples::make(OutgoingSet::direction(1, 2), Channels::grey(), Quantity::brdf, 2, 1);
    writeCoefficients(c, folder / "c.json");
    writeCoefficients(c, folder / "c.exr");
    std::filesystem::rename(folder / "c.json", folder / "a.exr");
    std::filesystem::rename(folder / "c.exr", folder / "b.json");
    expectSameMetadata(c, readCoefficients(folder / "a.exr"));
    expectSameMetadata(c, readCoefficients(folder / "b.json"));
}

TEST(CoefficientFile, WritingTwiceGivesTheSameBytes) {
    const Folder folder;
    const auto c =
        samples::make(OutgoingSet::parabolic(8, 8), Channels::rgb(), Quantity::brdf, 4, 9);
    for (const std::string extension : {".json", ".exr"}) {
        writeCoefficients(c, folder / ("a" + extension));
        writeCoefficients(c, folder / ("b" + extension));
        EXPECT_EQ(contentOf(folder / ("a" + extension)), contentOf(folder / ("b" + extension)));
    }
}

// The ring that the file states is the one that the directions have.
TEST(CoefficientFile, StatesTheHorizonRing) {
    const Folder folder;
    for (const auto& set : {OutgoingSet::parabolic(6, 6), OutgoingSet::elevations(2000)}) {
        double lowest = 90;
        for (const Direction& d : set.directions) {
            lowest = std::min(lowest, 90 - degrees(polarAngle(d)));
        }
        writeCoefficients(samples::make(set, Channels::grey(), Quantity::brdf, 1, 1),
                          folder / "c.json");
        const std::string content = contentOf(folder / "c.json");
        const std::string key = "\"horizon_ring_degrees\":";
        const auto at = content.find(key);
        ASSERT_NE(at, std::string::npos);
        EXPECT_NEAR(std::stod(content.substr(at + key.size())), lowest, 1e-9);
    }
}

// Python's json and struct read the same 64-bit values that were in memory.
TEST(CoefficientFile, PythonReadsTheJsonForm) {
    if (!runs("/usr/bin/python3 -c pass")) GTEST_SKIP() << "no /usr/bin/python3";
    const Folder folder;
    for (const Coefficients& c : everyKind()) {
        writeCoefficients(c, folder / "c.json");
        std::string raw(reinterpret_cast<const char*>(c.values.data()), c.values.size() * 8);
        samples::put(folder / "c.raw", raw);
        const std::string script =
            "import json,struct,sys\n"
            "d=json.load(open(sys.argv[1]),parse_constant=lambda c:sys.exit(c))\n"
            "v=[float(x) for o in d['coefficients'] for ch in o for x in ch]\n"
            "assert struct.pack('<%dd'%len(v),*v)==open(sys.argv[2],'rb').read()\n"
            "o=d['outgoing']\n"
            "n={'parabolic':lambda:o['width']*o['height'],'elevations':lambda:o['count'],"
            "'direction':lambda:1}[o['map']]()\n"
            "print(n,len(d['channels']),d['basis']['order'],d['quantity'],d['channel_kind'])\n";
        samples::put(folder / "check.py", script);
        const char* kinds[] = {"grey", "rgb", "spectral"};
        EXPECT_EQ(printed("/usr/bin/python3 '" + folder / "check.py" + "' '" + folder / "c.json" +
                          "' '" + folder / "c.raw" + "'"),
                  std::to_string(c.outgoing.size()) + " " + std::to_string(c.channels.count()) +
                      " 3 " + (c.quantity == Quantity::brdf ? "brdf " : "brdf_cosine ") +
                      kinds[static_cast<int>(c.channels.kind)] + "\n");
    }
}

TEST(CoefficientFile, ExrheaderReadsTheExrForm) {
    if (!runs("command -v exrheader")) GTEST_SKIP() << "no exrheader (package openexr)";
    const Folder folder;
    const auto c = samples::make(OutgoingSet::parabolic(5, 9), samples::allChannels()[2],
                                 Quantity::brdfCosine, 2, 3);
    writeCoefficients(c, folder / "c.exr");
    const std::string header = printed("exrheader '" + folder / "c.exr" + "'");
    for (const char* line : {"run-length encoding", "dataWindow (type box2i): (0 0) - (4 8)",
                             "hshfit:format (type string): \"hshfit-coefficients\"",
                             "hshfit:quantity (type string): \"brdf_cosine\"",
                             "c000.360nm, 32-bit floating-point, sampling 1 1",
                             "c003.450,5nm, 32-bit floating-point, sampling 1 1"}) {
        EXPECT_NE(header.find(line), std::string::npos) << line << "\n" << header;
    }
}

}  // namespace
