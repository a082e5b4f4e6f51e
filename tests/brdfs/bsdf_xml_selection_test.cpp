// The blocks of a BSDF XML file that a specification stands for: sides that are alone in their
// file, and blocks of single wavelengths.

#include "bsdf_xml_files.h"
#include "bsdf_xml_text.h"
#include "places.h"
#include "skip_without.h"

#include <brdfs/catalog.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace hshfit {
namespace {

using brdfs::BsdfSide;
using test::TemporaryFile;

constexpr int patches = 41;  // Klems Quarter
const std::string basis = "LBNL/Klems Quarter";

std::string matrix(double f) {
    return test::matrixText(patches, [=](int, int) { return f; });
}

/// A block of one wavelength, as LBNL's schema has it.
std::string blockAt(const std::string& direction, double f, const std::string& nanometres) {
    std::string block = test::blockXml(direction, matrix(f), basis, nanometres);
    const std::string unit = "unit=\"Integral\"";
    return block.replace(block.find(unit), unit.size(), "unit=\"Nanometer\"");
}

std::string file(const std::string& blocks) {
    return test::bsdfXml("Columns", "", blocks);
}

std::string factOf(const Brdf& brdf, std::string_view name) {
    for (const auto& [key, value] : brdf.facts())
        if (key == name && std::holds_alternative<std::string>(value))
            return std::get<std::string>(value);
    return "";
}

double atNormal(const Brdf& brdf, std::size_t channel = 0) {
    return evaluate(brdf, {0, 0, 1}, {0, 0, 1})[channel];
}

TEST(BsdfSelection, TheOnlyReflectionOfAFileIsReadAndNamed) {
    const TemporaryFile back(file(test::blockXml("Transmission Back", matrix(.5), basis) +
                                  test::blockXml("Reflection Back", matrix(.25), basis)),
                             ".xml");
    const auto brdf = brdfs::open(back.path());
    EXPECT_EQ(atNormal(*brdf), .25);
    EXPECT_EQ(factOf(*brdf, "side"), "back");
    EXPECT_EQ(brdf->name(), back.path() + ":side=back");
    EXPECT_EQ(atNormal(*brdfs::open(back.path() + ":side=reflection-back")), .25);
    test::expectInputError([&] { brdfs::open(back.path() + ":side=front"); },
                           {"Reflection Front", "Reflection Back Visible"});

    const TemporaryFile both(file(test::blockXml("Reflection Back", matrix(.25), basis) +
                                  test::blockXml("Reflection Front", matrix(.125), basis)),
                             ".xml");
    EXPECT_EQ(atNormal(*brdfs::open(both.path())), .125);
    EXPECT_EQ(atNormal(*brdfs::open(both.path() + ":side=back")), .25);
}

TEST(BsdfSelection, BlocksByWavelengthAreASpectrum) {
    const TemporaryFile spectral(
        file(blockAt("Reflection Back", .3, "650") + blockAt("Reflection Back", .1, "450") +
             blockAt("Transmission Back", .9, "450") + blockAt("Reflection Back", .2, "550.5")),
        ".xml");
    const auto brdf = brdfs::open(spectral.path());
    EXPECT_EQ(brdf->channels().kind, Channels::Kind::spectral);
    EXPECT_EQ(brdf->channels().wavelengths, (std::vector<double>{450, 550.5, 650}));
    for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(atNormal(*brdf, c), .1 * static_cast<double>(c + 1), 1e-7);
    EXPECT_EQ(factOf(*brdf, "wavelength"), "3 wavelengths");
    const auto one = brdfs::open(spectral.path() + ":wavelength=550.5");
    EXPECT_EQ(one->channels().wavelengths, (std::vector<double>{550.5}));
    EXPECT_NEAR(atNormal(*one), .2, 1e-7);
    EXPECT_NEAR(atNormal(*brdfs::open(one->name())), .2, 1e-7);
    test::expectInputError([&] { brdfs::open(spectral.path() + ":wavelength=500"); },
                           {"500", "Reflection Back 450 nm"});
    test::expectInputError([&] { brdfs::open(spectral.path() + ":wavelength=solar"); }, {"solar"});
}

TEST(BsdfSelection, VisibleLightComesBeforeASpectrum) {
    const TemporaryFile mixed(
        file(blockAt("Reflection Front", .3, "650") + blockAt("Reflection Front", .1, "450") +
             test::blockXml("Reflection Front", matrix(.25), basis)),
        ".xml");
    EXPECT_EQ(atNormal(*brdfs::open(mixed.path())), .25);
    const auto spectrum = brdfs::open(mixed.path() + ":wavelength=spectrum");
    EXPECT_EQ(spectrum->channels().count(), 2u);
    EXPECT_NEAR(atNormal(*spectrum, 1), .3, 1e-7);
}

TEST(BsdfSelection, TreesByWavelengthAreASpectrum) {
    std::string blocks;
    for (const char* nm : {"450", "650"}) {
        std::string block = test::blockXml(
            "Reflection Front", nm[0] == '4' ? "{ .125 }" : "{ .25 }", "LBNL/Shirley-Chiu", nm);
        const std::string unit = "unit=\"Integral\"";
        blocks += block.replace(block.find(unit), unit.size(), "unit=\"Nanometer\"");
    }
    const TemporaryFile tree(test::bsdfXml("TensorTree4", "", blocks), ".xml");
    const auto brdf = brdfs::open(tree.path());
    EXPECT_EQ(brdf->channels().wavelengths, (std::vector<double>{450, 650}));
    EXPECT_EQ(atNormal(*brdf, 0), .125);
    EXPECT_EQ(atNormal(*brdf, 1), .25);
}

TEST(BsdfSelection, WrongWavelengthsAreRefused) {
    const auto refused = [](const std::string& blocks, const std::vector<std::string>& parts) {
        const TemporaryFile bad(file(blocks), ".xml");
        test::expectInputError([&] { brdfs::open(bad.path()); }, parts);
    };
    refused(blockAt("Reflection Back", .3, "blue"), {"'blue'", "Nanometer"});
    refused(blockAt("Reflection Back", .3, "-5"), {"'-5'"});
    refused(blockAt("Reflection Back", .3, "450") + blockAt("Reflection Back", .2, "450"),
            {"a second block", "450 nm"});
}

TEST(BsdfSelection, FilesOfTheFieldOpenWithoutAnOption) {
    const std::string path =
        test::sharedFolder() + "/data/field/measured/03-side-default/back_only.xml";
    SKIP_WITHOUT(path);
    const auto brdf = brdfs::open(path);
    EXPECT_NEAR(atNormal(*brdf), .4 / pi, 1e-8);
    EXPECT_EQ(factOf(*brdf, "side"), "back");
}

}  // namespace
}  // namespace hshfit
