// Transmission: blocks of BSDF XML files, their writers, and refusals. Real files are compared with
// an independent evaluator by tests/transmission_evaluator.py.

#include <brdfs/catalog.h>
#include <brdfs/repair.h>
#include <brdfs/rows/spec.h>
#include <hshfit/brdf/transmission.h>
#include <hshfit/error.h>

#include "bsdf_xml_files.h"
#include "places.h"
#include "skip_without.h"

#include <map>

namespace hshfit {
namespace {

using namespace test;

constexpr int patches = 41;  // Klems Quarter
const std::string basis = "LBNL/Klems Quarter";

std::string constant(double f) {
    return matrixText(patches, [=](int, int) { return f; });
}

std::string file(const std::string& blocks) {
    return bsdfXml("Columns", "", blocks);
}

std::string textFact(const Brdf& brdf, std::string_view name) {
    for (const auto& [key, value] : brdf.facts())
        if (key == name && std::holds_alternative<std::string>(value))
            return std::get<std::string>(value);
    return "";
}

double numberFact(const Brdf& brdf, std::string_view name) {
    for (const auto& [key, value] : brdf.facts())
        if (key == name && std::holds_alternative<double>(value)) return std::get<double>(value);
    return -1;
}

/// Runs it and returns the message of the UsageError that it throws.
template <class Run>
std::string refusal(Run run) {
    try {
        run();
    } catch (const UsageError& error) {
        return error.what();
    }
    return "no refusal";
}

std::vector<std::string> write(const Brdf& brdf, const std::string& name,
                               const std::string& options, const std::string& path) {
    for (const brdfs::Writer& writer : brdfs::writers())
        if (writer.name == name)
            return writer.write(brdf, path,
                                brdfs::parseParameters(writer.name, writer.parameters, options),
                                {.force = true});
    throw std::logic_error(name);
}

TEST(Transmission, ASpecificationStatesIt) {
    EXPECT_EQ(transmissionSide("a.xml:side=transmission-front"), "transmission-front");
    EXPECT_EQ(transmissionSide("rgb:a.xml:wavelength=solar,side=transmission-back"),
              "transmission-back");
    EXPECT_EQ(transmissionSide("0.5 * a.xml:side=transmission-back + b.xml:side=transmission-back"),
              "transmission-back");
    for (const char* reflection : {"a.xml", "a.xml:side=front", "a.xml:side=reflection-back",
                                   "side=transmission-front", "inside=transmission-front", ""})
        EXPECT_EQ(transmissionSide(reflection), "") << reflection;
}

TEST(Transmission, EveryBlockOfAFileOpensByItsSide) {
    const TemporaryFile all(file(blockXml("Transmission Front", constant(.0625), basis) +
                                 blockXml("Transmission Back", constant(.125), basis) +
                                 blockXml("Reflection Front", constant(.1875), basis) +
                                 blockXml("Reflection Back", constant(.25), basis)),
                            ".xml");
    const std::map<std::string, double> sides = {{"front", .1875},
                                                 {"reflection-front", .1875},
                                                 {"back", .25},
                                                 {"transmission-front", .0625},
                                                 {"transmission-back", .125}};
    for (const auto& [side, value] : sides) {
        SCOPED_TRACE(side);
        const auto brdf = brdfs::open(all.path() + ":side=" + side);
        EXPECT_EQ(valueOf(*brdf, {.6, 0, .8}, {0, .8, .6}), value);
        EXPECT_EQ(transmits(*brdf), side.starts_with("transmission"));
        EXPECT_EQ(brdfs::open(brdf->name())->name(), brdf->name());
    }
    EXPECT_EQ(valueOf(*brdfs::open(all.path()), {0, 0, 1}, {0, 0, 1}), .1875);
}

TEST(Transmission, AFileWithNothingElseIsReadAndSaysSo) {
    const TemporaryFile only(file(blockXml("Transmission Back", constant(.125), basis)), ".xml");
    const auto brdf = brdfs::open(only.path());
    EXPECT_EQ(brdf->name(), only.path() + ":side=transmission-back");
    EXPECT_EQ(textFact(*brdf, "side"), "transmission-back");
    EXPECT_TRUE(transmits(*brdf));
    EXPECT_NEAR(numberFact(*brdf, "largest_directional_transmittance"), .125 * pi, 1e-6);
    expectInputError([&] { brdfs::open(only.path() + ":side=front"); },
                     {"Reflection Front", "Transmission Back Visible"});
    // With a reflection in the file nothing turns into a transmission.
    const TemporaryFile solar(file(blockXml("Transmission Back", constant(.125), basis, "Solar") +
                                   blockXml("Reflection Back", constant(.25), basis)),
                              ".xml");
    expectInputError([&] { brdfs::open(solar.path() + ":wavelength=solar"); },
                     {"solar", "Transmission Back Solar"});
}

// Helmholtz reciprocity is about light from both sides, so that a block alone has none.
TEST(Transmission, ClaimsNoExchangeOfDirections) {
    const TemporaryFile only(file(blockXml("Transmission Front", constant(.125), basis)), ".xml");
    EXPECT_FALSE(brdfs::open(only.path())->laws().reciprocal);
    const TemporaryFile tree(
        bsdfXml("TensorTree4", "", blockXml("Transmission Back", "{ .125 }", "LBNL/Shirley-Chiu")),
        ".xml");
    EXPECT_FALSE(brdfs::open(tree.path())->laws().reciprocal);
    EXPECT_TRUE(brdfs::open(tree.path())->laws().energyConserving);
}

TEST(Transmission, EnergyIsJudgedWithTheReflectionOfTheSameSide) {
    const auto opened = [](const std::string& structure, double reflected, double sent) {
        const bool tree = structure != "Columns";
        const auto data = [&](double f) {
            return tree ? "{ " + std::to_string(f) + " }" : constant(f);
        };
        const std::string name = tree ? "LBNL/Shirley-Chiu" : basis;
        const TemporaryFile both(bsdfXml(structure, "",
                                         blockXml("Transmission Front", data(sent), name) +
                                             blockXml("Reflection Front", data(reflected), name) +
                                             blockXml("Reflection Back", data(.3), name)),
                                 ".xml");
        return brdfs::open(both.path() + ":side=transmission-front");
    };
    for (const std::string structure : {"Columns", "TensorTree3", "TensorTree4"}) {
        SCOPED_TRACE(structure);
        const auto less = opened(structure, .125, .1875);
        EXPECT_TRUE(less->laws().energyConserving);
        EXPECT_NEAR(numberFact(*less, "largest_reflectance_and_transmittance"), pi * .3125, 1e-5);
        const auto more = opened(structure, .1875, .1875);
        EXPECT_FALSE(more->laws().energyConserving);
        EXPECT_NEAR(numberFact(*more, "largest_reflectance_and_transmittance"), pi * .375, 1e-5);
    }
}

// A reflection that cannot be read, or compared, leaves the transmission readable and is stated.
TEST(Transmission, AReflectionThatIsNotReadIsAFact) {
    const auto fact = [](const std::string& blocks, const std::string& wavelength = "") {
        const TemporaryFile both(
            file(blockXml("Transmission Front", constant(.125), basis) + blocks), ".xml");
        const auto brdf = brdfs::open(both.path() + ":side=transmission-front" + wavelength);
        EXPECT_EQ(valueOf(*brdf, {0, 0, 1}, {0, 0, 1}), .125);
        return textFact(*brdf, "reflection_not_read");
    };
    EXPECT_EQ(fact(""), "");
    EXPECT_EQ(fact(blockXml("Reflection Front", constant(.125), basis)), "");
    EXPECT_EQ(fact(blockXml("Reflection Back", "1, 2", basis)), "");
    EXPECT_EQ(fact(blockXml("Reflection Front", constant(.125), basis, "Solar")), "");
    const std::string broken = fact(blockXml("Reflection Front", "1, 2, x", basis));
    EXPECT_NE(broken.find("judged without"), std::string::npos) << broken;
    const std::string other = fact(blockXml(
        "Reflection Front", matrixText(145, [](int, int) { return .1; }), "LBNL/Klems Full"));
    EXPECT_NE(other.find("judged without"), std::string::npos) << other;
    const std::string twice = fact(blockXml("Reflection Front", constant(.125), basis) +
                                   blockXml("Reflection Front", constant(.125), basis));
    EXPECT_NE(twice.find("second block"), std::string::npos) << twice;
}

// Grids of different depth: cells of the coarser one hold several of the finer one.
TEST(Transmission, EnergyOfTreesOfDifferentDepthIsThatOfTheSameLight) {
    std::string fine = "{";  // 2 x 2 incident cells, the first coordinate in the lower half .125
    for (int k = 0; k < 16; ++k) fine += k < 8 ? " .125" : " .25";  // the last changes fastest
    const TemporaryFile both(
        bsdfXml("TensorTree4", "",
                blockXml("Transmission Back", "{ .03125 }", "LBNL/Shirley-Chiu") +
                    blockXml("Reflection Back", fine + " }", "LBNL/Shirley-Chiu")),
        ".xml");
    EXPECT_NEAR(numberFact(*brdfs::open(both.path() + ":side=transmission-back"),
                           "largest_reflectance_and_transmittance"),
                pi * (.03125 + .25), 1e-6);
}

/// A matrix of numbers that are all different.
std::string numbered(int seed) {
    return matrixText(145, [=](int o, int i) { return ((o * 145 + i) * 7 + seed) % 1000 * 1e-5; });
}

TEST(Transmission, AllFourBlocksAreWrittenWhereTheyWere) {
    const std::string full = "LBNL/Klems Full";
    const TemporaryFile source(file(blockXml("Transmission Front", numbered(1), full) +
                                    blockXml("Transmission Back", numbered(2), full) +
                                    blockXml("Reflection Front", numbered(3), full) +
                                    blockXml("Reflection Back", numbered(4), full)),
                               ".xml"),
        copy("", ".xml"), single("", ".xml");
    EXPECT_TRUE(write(*brdfs::open(source.path()), "bsdf-klems", "side=all", copy.path()).empty());
    for (const std::string side : {"front", "back", "transmission-front", "transmission-back"}) {
        SCOPED_TRACE(side);
        const auto from = brdfs::open(source.path() + ":side=" + side);
        const auto to = brdfs::open(copy.path() + ":side=" + side);
        const auto &a = dynamic_cast<const brdfs::KlemsBrdf&>(*from),
                   &b = dynamic_cast<const brdfs::KlemsBrdf&>(*to);
        double worst = 0;
        for (std::size_t o = 0; o < 145; ++o)
            for (std::size_t i = 0; i < 145; ++i)
                worst = std::max(worst, std::abs(a.value(0, i, o) - b.value(0, i, o)));
        EXPECT_LE(worst, 1e-8);
        // One block keeps its side without an option.
        write(*from, "bsdf-tree", "levels=2,evaluations=0", single.path());
        EXPECT_EQ(transmits(*brdfs::open(single.path())), transmits(*from));
    }
}

TEST(Transmission, IsNeverTakenForAReflection) {
    const TemporaryFile only(file(blockXml("Transmission Front", constant(.125), basis)), ".xml"),
        out("", ".xml");
    const auto sent = brdfs::open(only.path());
    for (const char* format : {"merl", "rgl", "alta", "slices", "xompt"})
        EXPECT_NE(refusal([&] {
                      write(*sent, format, "", out.path());
                  }).find("is a transmission, and " + std::string(format) + " takes reflections"),
                  std::string::npos)
            << format;
    EXPECT_NE(refusal([&] {
                  write(*sent, "bsdf-klems", "side=back", out.path());
              }).find("is a transmission, which side=back is not"),
              std::string::npos);
    EXPECT_NE(refusal([&] {
                  write(*brdfs::open("lambert"), "bsdf-klems", "side=transmission-back",
                        out.path());
              }).find("is a reflection"),
              std::string::npos);
    EXPECT_NE(refusal([&] {
                  write(*brdfs::open("lambert"), "bsdf-klems", "side=all", out.path());
              }).find("side=all writes the blocks of a BSDF XML file"),
              std::string::npos);
    EXPECT_NE(refusal([&] {
                  brdfs::open(only.path() + " + lambert:kd=.5");
              }).find("lambert:kd=0.5 is a reflection"),
              std::string::npos);
    EXPECT_NE(refusal([&] {
                  brdfs::repaired(brdfs::open(only.path()), "reciprocity");
              }).find("other than reciprocity"),
              std::string::npos);
    EXPECT_FALSE(brdfs::repaired(brdfs::open(only.path()), "all")->laws().reciprocal);
}

TEST(Transmission, RealFilesOfNothingElseOpen) {
    const std::string folder = sharedFolder() + "/data/field/files/xml/";
    SKIP_WITHOUT(folder);
    for (const std::string name : {"diffuse50.xml", "simple_tensor_d2_trans.xml"})
        EXPECT_TRUE(transmits(*brdfs::open(folder + name))) << name;
}

}  // namespace
}  // namespace hshfit
