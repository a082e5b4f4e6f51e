// Scattered formats of both sides of a surface (ASTM, Speos, pab-opto), and BiRD's universal file.
#include "places.h"
#include "skip_without.h"
#include "temporary_file.h"

#include <brdfs/catalog.h>
#include <brdfs/measured/scattered/astm.h>
#include <brdfs/measured/scattered/bird.h>
#include <brdfs/measured/scattered/pab_opto.h>
#include <brdfs/measured/scattered/scattered.h>
#include <brdfs/measured/scattered/speos.h>
#include <brdfs/measured_files.h>
#include <brdfs/sample_checks.h>
#include <hshfit/brdf/transmission.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

namespace hshfit::brdfs {
namespace {

using test::atDegrees;
using test::cutEverywhere;
using test::expectDirection;
using test::expectInputError;
using test::TemporaryFile;
using Values = std::vector<double>;

// --- ASTM ---------------------------------------------------------------------------------------

const std::string astmNames = "VARS theta_i,phi_i,theta_s,phi_s,BSDF\n";

/// One sample of each side; degrees.
const std::string fourSides =
    astmNames + "20,30,40,200,1\n160,30,130,200,2\n20,30,140,210,3\n150,10,40,200,4\n";

TEST(AstmSides, PolarAnglesBeyondTheHorizonAreOnTheBack) {
    const auto side = [](const char* word) { return readAstm(fourSides, "f", true, word); };
    const Samples front = side("auto");
    EXPECT_EQ(front.values, Values{1});
    EXPECT_EQ(front.side, "reflection-front");
    EXPECT_EQ(front.leftOut.size(), 3U);
    expectDirection(front.wi[0], atDegrees(20, 30));
    expectDirection(front.wo[0], atDegrees(40, 200));
    // Light from the back: the frame turned about y, which exchanges azimuths p and 180 - p.
    const Samples back = side("reflection-back");
    EXPECT_EQ(back.values, Values{2});
    expectDirection(back.wi[0], atDegrees(20, 150));
    expectDirection(back.wo[0], atDegrees(50, -20));
    // Outgoing directions of transmissions are mirrored at the surface.
    const Samples through = side("transmission-front");
    EXPECT_EQ(through.values, Values{3});
    expectDirection(through.wi[0], atDegrees(20, 30));
    expectDirection(through.wo[0], atDegrees(40, 210));
    const Samples out = side("transmission-back");
    EXPECT_EQ(out.values, Values{4});
    expectDirection(out.wi[0], atDegrees(30, 170));
    expectDirection(out.wo[0], atDegrees(40, -20));
}

TEST(AstmSides, FilesOfTransmissionAloneOpenAsWhatTheyAre) {
    const TemporaryFile file(astmNames + "0.3,0,2.6,3.2,0.5\n0.3,0,2.2,3.2,0.25\n", ".astm");
    const auto brdf = open(file.path());
    EXPECT_EQ(brdf->name(), file.path() + ":side=transmission-front");
    EXPECT_TRUE(transmits(*brdf));
    EXPECT_FALSE(brdf->laws().reciprocal);
    EXPECT_EQ(open(brdf->name())->name(), brdf->name());
    const auto& samples = dynamic_cast<const Scattered&>(*brdf).samples();
    for (std::size_t k = 0; k < samples.size(); ++k)
        EXPECT_NEAR(evaluate(*brdf, samples.wi[k], samples.wo[k])[0], samples.values[k], 1e-12);
    expectInputError([&] { open(file.path() + ":side=reflection-front"); },
                     {file.path(), "side=reflection-front", "transmission-front (2 samples)"});
    const TemporaryFile plain(astmNames + "0.3,0,0.6,3.2,0.5\n", ".astm");
    EXPECT_EQ(open(plain.path())->name(), plain.path());
    EXPECT_TRUE(open(plain.path())->laws().reciprocal);
}

/// A model's transmission, written as a laboratory would, has its values at the samples.
TEST(AstmSides, ATransmissionOfGlassComesBack) {
    for (const std::string side : {"front", "back"}) {
        const auto glass = open("rough-glass:alpha=0.4,side=transmission-" + side);
        std::string text = astmNames;
        Values expected;
        const bool back = side == "back";
        for (const double thetaI : {0.0, 20.0, 45.0})
            for (double thetaO = 0; thetaO < 80; thetaO += 15)
                for (double phi = 0; phi < 360; phi += 40) {
                    if (thetaO == 0 && phi > 0) continue;
                    // The model's frame has +z towards the light; wo as an instrument states it.
                    const Direction wi = atDegrees(thetaI, 180), wo = atDegrees(thetaO, phi);
                    const double f = evaluate(*glass, wi, wo)[0];
                    expected.push_back(f);
                    const double out = 180 - thetaO;
                    text += back ? fmt::format("{},{},{},{},{}\n", 180 - thetaI, 0, 180 - out,
                                               180 - phi, f)
                                 : fmt::format("{},{},{},{},{}\n", thetaI, 180, out, phi, f);
                }
        const Samples samples = readAstm(text, "f", true);
        EXPECT_EQ(samples.side, "transmission-" + side);
        ASSERT_EQ(samples.size(), expected.size());
        for (std::size_t k = 0; k < samples.size(); ++k)
            EXPECT_NEAR(evaluate(*glass, samples.wi[k], samples.wo[k])[0], expected[k],
                        1e-9 * (1 + expected[k]));
    }
}

// --- Speos --------------------------------------------------------------------------------------

std::string speosTable(const std::string& percent, bool through, const std::string& values) {
    const std::string rows[3] = {through ? "90" : "0", through ? "135" : "45",
                                 through ? "180" : "90"};
    std::string text = percent + "\n3 3\n\t0 180 360\n";
    for (int k = 0; k < 3; ++k) {
        const std::string v(1, values[static_cast<std::size_t>(k)]);
        text += rows[k] + " " + v + " " + v + " " + v + "\n";
    }
    return text;
}

std::string speosFile(const std::string& kinds, const std::string& tables) {
    return "OPTIS - brdf surface file v8.0\n0\nown\n2\nab\n" + kinds + "\n1\n1 2\n30\n500 600\n" +
           tables + "End of file\n";
}

/// Tables of 1 everywhere with P percent have f = P / 100 / pi on their own side.
TEST(SpeosSides, TransmissionIsScaledByItsPercentageInAnyOrder) {
    const std::string r1 = speosTable("20", false, "111"), t1 = speosTable("30", true, "111");
    const std::string r2 = speosTable("40", false, "222"), t2 = speosTable("50", true, "222");
    for (const std::string& tables : {r1 + t1 + r2 + t2, r1 + r2 + t1 + t2, t1 + t2 + r1 + r2}) {
        const std::string text = speosFile("1\t1", tables);
        const Samples through = readSpeos(text, "f", "transmission-front");
        const Samples reflected = readSpeos(text, "f", "auto");
        ASSERT_EQ(through.size(), 5U);
        EXPECT_EQ(through.side, "transmission-front");
        EXPECT_EQ(reflected.side, "reflection-front");
        for (std::size_t k = 0; k < 5; ++k) {
            EXPECT_NEAR(through.values[2 * k], 0.3 / pi, 1e-12);
            EXPECT_NEAR(through.values[2 * k + 1], 0.5 / pi, 1e-12);
            EXPECT_NEAR(reflected.values[2 * k], 0.2 / pi, 1e-12);
            EXPECT_NEAR(reflected.values[2 * k + 1], 0.4 / pi, 1e-12);
        }
        EXPECT_EQ(through.leftOut, std::vector<std::string>{"reflection (option side)"});
    }
    // Alone.
    const std::string only = speosFile("0 1", t1 + t2);
    EXPECT_EQ(readSpeos(only, "f").side, "transmission-front");
    EXPECT_EQ(readSpeos(only, "f", "transmission-back").side, "transmission-back");
    expectInputError([&] { readSpeos(only, "f", "reflection-front"); },
                     {"transmission alone", "reflection-front"});
    expectInputError([&] { readSpeos(speosFile("1 0", r1 + r2), "f", "transmission-front"); },
                     {"reflection alone", "transmission-front"});
    expectInputError([&] { readSpeos(speosFile("0 1", r1 + r2), "f"); },
                     {"0 to 90", "expected 90 to 180 for transmission"});
    expectInputError([&] { readSpeos(speosFile("0 0", r1), "f"); }, {"neither"});
    cutEverywhere([](std::string_view t) { readSpeos(t, "f", "transmission-front"); },
                  speosFile("1 1", r1 + t1 + r2 + t2));
}

/// Rows at 90, 135 and 180 degrees hold 1, 2 and 3: 3 straight through the surface.
TEST(SpeosSides, PolarAnglesAreMirroredAtTheSurface) {
    const std::string text =
        speosFile("0 1", speosTable("30", true, "123") + speosTable("30", true, "123"));
    const Samples samples = readSpeos(text, "f");
    // The bilinear integral of v cos over the hemisphere, rings of pi each: by parts in theta.
    const auto moment = [](double a, double b) {  // of (t - a)/(b - a) sin t cos t
        const auto first = [](double t) { return (std::sin(2 * t) - 2 * t * std::cos(2 * t)) / 8; };
        const auto zeroth = [](double t) { return std::sin(t) * std::sin(t) / 2; };
        return (first(b) - first(a) - a * (zeroth(b) - zeroth(a))) / (b - a);
    };
    const double low = (std::pow(std::sin(pi / 4), 2)) / 2, high = 0.5 - low;
    // v = 3 - (t / (pi/4)) on both halves.
    const double whole = 2 * pi * (3 * low - moment(0, pi / 4) + 2 * high - moment(pi / 4, pi / 2));
    double seen = 0;
    for (std::size_t k = 0; k < samples.size(); ++k) {
        const double value = 3 - polarAngle(samples.wo[k]) / (pi / 4);
        EXPECT_NEAR(samples.values[2 * k], 0.3 * value / whole, 1e-12);
        seen += samples.wo[k].x > 0.5;
        expectDirection(samples.wi[k], atDegrees(30, 180));
    }
    EXPECT_EQ(seen, 2);
}

TEST(SpeosSides, AnisotropicFilesHaveTheirTransmissionToo) {
    const auto table = [](double from, const std::string& v) {
        return fmt::format("2 2\n0 180\n{} {} {}\n{} {} {}\n", from, v, v, from + 90, v, v);
    };
    const std::string text =
        "OPTIS - Anisotropic BSDF surface file v8.0\n0\nown\n0\n\n0 1 0\n1 1\n1\n1\n0\n1\n20\n"
        "2\n0 90\n1\n10\n1\n20\n20 0\nr\n2\n400 10\n500 10\n10 0\nt\n2\n400 30\n500 40\n" +
        table(0, "1") + table(90, "2") + table(90, "4") + "End of file\n";
    const Samples reflected = readSpeos(text, "f");
    EXPECT_TRUE(reflected.isotropic);
    EXPECT_EQ(reflected.channels.count(), 1U);
    EXPECT_NEAR(reflected.values[0], 0.1 / pi, 1e-12);
    expectDirection(reflected.wi[0], atDegrees(20, 180));
    const Samples through = readSpeos(text, "f", "transmission-front");
    EXPECT_FALSE(through.isotropic);
    EXPECT_EQ(through.channels.wavelengths, (Values{400, 500}));
    ASSERT_EQ(through.size(), 6U);
    // The first table gives the scale. Its integral is 2 pi.
    EXPECT_NEAR(through.values[0], 0.3 / pi, 1e-12);
    EXPECT_NEAR(through.values[1], 0.4 / pi, 1e-12);
    EXPECT_NEAR(through.values[6], 0.6 / pi, 1e-12);
    expectDirection(through.wi[0], atDegrees(10, 180));
    expectDirection(through.wi[3], atDegrees(20, 90));
}

// --- pab-opto -----------------------------------------------------------------------------------

/// The minimal file of the manual of Radiance's pabopto2bsdf, with the light at 180 degrees.
const std::string pabText =
    "#sample_name \"own\"\n#incident_angle 82.5 180\n#format: theta phi DSF\n"
    "84.968 125.790 0.009744\n84.889\t125.610\t0.007737\n\n100 20 0.5\n";

TEST(PabOpto, RowsAreValuesOrValuesTimesTheCosine) {
    const Samples dsf = readPabOpto(pabText, "f");
    ASSERT_EQ(dsf.size(), 2U);
    expectDirection(dsf.wi[0], atDegrees(82.5, 180));
    expectDirection(dsf.wo[1], atDegrees(84.889, 125.61));
    EXPECT_NEAR(dsf.values[0], 0.009744 / std::cos(radians(84.968)), 1e-12);
    EXPECT_EQ(dsf.leftOut, std::vector<std::string>{"transmission-front (1 samples), option side"});
    const Samples through = readPabOpto(pabText, "f", "transmission-front");
    ASSERT_EQ(through.size(), 1U);
    EXPECT_NEAR(through.values[0], 0.5 / std::cos(radians(80)), 1e-12);
    expectDirection(through.wo[0], atDegrees(80, 20));
    std::string bsdf = pabText;
    bsdf.replace(bsdf.find("DSF"), 3, "BTDF");
    EXPECT_EQ(readPabOpto(bsdf, "f", "transmission-front").values, Values{0.5});
    // Both words for the incidence.
    std::string words = pabText;
    words.replace(words.find("#incident_angle 82.5 180"), 24, "#inphi 180\r\n#intheta: 82.5");
    EXPECT_EQ(readPabOpto(words, "f").values, dsf.values);
    expectDirection(readPabOpto(words, "f").wi[0], dsf.wi[0]);
}

TEST(PabOpto, FilesBehindEachOtherAreOneScan) {
    const std::string second = "#intheta 30\n#inphi 170\n#format: theta phi BSDF\n10 0 0.25\n";
    const Samples samples = readPabOpto(pabText + second, "f");
    ASSERT_EQ(samples.size(), 3U);
    expectDirection(samples.wi[2], atDegrees(30, 170));
    EXPECT_EQ(samples.values[2], 0.25);
    EXPECT_EQ(samples.facts[1], (Fact{"incidences", std::int64_t{2}}));
    // A header that lacks its own format or incidence does not borrow from the file before.
    expectInputError([&] { readPabOpto(pabText + "#intheta 30\n10 0 0.25\n", "f"); },
                     {"line 9", "#format"});
    expectInputError([&] { readPabOpto(pabText + "#format: theta phi DSF\n10 0 0.25\n", "f"); },
                     {"line 9", "#incident_angle"});
}

TEST(PabOpto, ColoursAndSides) {
    const std::string head = "#incident_angle 150 20\n#format: theta phi BSDF\n";
    const Samples grey = readPabOpto(head + "120 20 0.5\n30 10 0.25\n", "f");
    EXPECT_EQ(grey.side, "reflection-back");
    expectDirection(grey.wi[0], atDegrees(30, 160));
    expectDirection(grey.wo[0], atDegrees(60, 160));
    const Samples colour = readPabOpto(head + "#colorimetry: CIE-XYZ\n120 20 0.5 0.5 0.5\n", "f");
    ASSERT_EQ(colour.channels.kind, Channels::Kind::rgb);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(colour.values[c], 0.5, 1e-12);
    const TemporaryFile file(head + "30 10 0.25\n", ".txt");
    const auto brdf = open(file.path());
    EXPECT_EQ(brdf->name(), file.path() + ":side=transmission-back");
    EXPECT_EQ(brdf->facts()[0], (Fact{"format", std::string("pab-opto")}));
}

TEST(PabOpto, FieldsAreChecked) {
    const auto refused = [](const std::string& text, const std::vector<std::string>& parts) {
        expectInputError([&] { readPabOpto(text, "f"); }, parts);
    };
    const std::string head = "#incident_angle 10 0\n#format: theta phi BSDF\n";
    cutEverywhere([](std::string_view t) { readPabOpto(t, "f"); }, pabText);
    refused("", {"without a row"});
    refused(head, {"without a row"});
    refused("#format: theta phi BSDF\n1 2 3\n", {"line 2", "#incident_angle"});
    refused("#incident_angle 10 0\n1 2 3\n", {"line 2", "#format"});
    refused("#format: phi theta BSDF\n", {"line 1", "theta phi BSDF"});
    refused("#format: theta phi volts\n", {"line 1", "DSF"});
    refused("#incident_angle 10\n", {"line 1", "angle"});
    refused("#intheta 190\n", {"line 1", "190", "0 to 180"});
    refused("#intheta nan\n", {"line 1"});
    refused("#colorimetry: RGB\n", {"line 1", "'rgb'", "CIE-XYZ"});
    refused(head + "1 2\n", {"line 3", "2 numbers"});
    refused(head + "1 2 3 4\n", {"line 3", "4 numbers"});
    refused(head + "1 2 x\n", {"line 3"});
    refused(head + "1 2 nan\n", {"line 3", "nan"});
    refused(head + "200 2 1\n", {"line 3", "200"});
    refused(head + "1 2 3\n#colorimetry: CIE-XYZ\n" + head + "1 2 3 3 3\n",
            {"line 7", "#colorimetry differs"});
}

// --- BiRD ---------------------------------------------------------------------------------------

std::string birdFile(const std::string& more, const std::string& values = "0.2, 0.4, 0.3, 0.5",
                     const std::string& angleUnit = "deg") {
    const auto angle = [&](const std::string& name, const std::string& list) {
        return "\"" + name + R"(": {"unit": ")" + angleUnit + R"(", "values": [)" + list + "]}, ";
    };
    return R"({"metadata": {"schema": "brdf_json_schema_v1.0.json", "type": "BRDF",)"
           R"( "method": "measurement", "provenance": {"organization": "own"},)"
           R"( "sample": {"name": "tile", "properties_symmetry": "isotropic"}}, "data": {)" +
           angle("theta_i", "10, 10, 10, 10") + angle("phi_i", "0, 0, 0, 0") +
           angle("theta_r", "20, 20, 40, 40") + angle("phi_r", "180, 180, 90, 90") + more +
           R"("BRDF": {"unit": "sr^-1", "values": [)" + values + "]}}}";
}

const std::string twoWavelengths =
    R"("wavelength_i": {"unit": "nm", "values": [500, 600, 500, 600]}, )";

TEST(Bird, WavelengthsBecomeChannels) {
    const TemporaryFile file(birdFile(twoWavelengths), ".brdf");
    const auto brdf = open(file.path());
    const auto& samples = dynamic_cast<const Scattered&>(*brdf).samples();
    EXPECT_EQ(samples.channels.wavelengths, (Values{500, 600}));
    EXPECT_EQ(samples.values, (Values{0.2, 0.4, 0.3, 0.5}));
    expectDirection(samples.wi[0], atDegrees(10, 0));
    expectDirection(samples.wo[1], atDegrees(40, 90));
    EXPECT_TRUE(brdf->laws().isotropic);
    EXPECT_EQ(samples.facts[1], (Fact{"material", std::string("tile")}));
    const std::string micro =
        "\"wavelength_r\": {\"unit\": \"\u03bcm\", \"values\": [0.5, 0.6, 0.5, 0.6]}, ";
    EXPECT_EQ(readBird(birdFile(micro), "f").channels.wavelengths, (Values{500, 600}));
    // Without wavelengths each value is a sample; degrees as a sign, and radians.
    EXPECT_EQ(readBird(birdFile(""), "f").size(), 4U);
    expectDirection(readBird(birdFile("", "1, 1, 1, 1", "\u00b0"), "f").wo[2], atDegrees(40, 90));
    std::string radian = birdFile("", "1, 1, 1, 1", "rad");
    for (const auto& [from, to] : {std::pair("10, 10, 10, 10", "0.1, 0.1, 0.1, 0.1"),
                                   std::pair("20, 20, 40, 40", "0.2, 0.2, 0.4, 0.4"),
                                   std::pair("180, 180, 90, 90", "3, 3, 1, 1")})
        radian.replace(radian.find(from), std::string(from).size(), to);
    expectDirection(readBird(radian, "f").wo[3], directionFromAngles(0.4, 1));
}

TEST(Bird, OppositePolarizationsBecomeTheirMean) {
    const auto with = [](const std::string& notation, const std::string& values) {
        return birdFile(R"("polarization_i": {"notation": ")" + notation + R"(", "values": [)" +
                        values + "]}, ");
    };
    for (const std::string& text :
         {with("sp", R"("s", "p", "p", "s")"),
          with("inStokes", "[1,1,0,0], [1,-1,0,0], [1,0,0.5,0], [1,0,-0.5,0]")}) {
        const Samples samples = readBird(text, "f");
        ASSERT_EQ(samples.size(), 2U);
        EXPECT_NEAR(samples.values[0], 0.3, 1e-15);
        EXPECT_NEAR(samples.values[1], 0.4, 1e-15);
    }
    EXPECT_EQ(readBird(with("sp", R"("u", "u", "u", "u")"), "f").size(), 2U);
    expectInputError([&] { readBird(with("sp", R"("s", "p", "s", "s")"), "f"); },
                     {"value 2", "polarised light"});
    expectInputError([&] { readBird(with("sp", R"("s", "p", "x", "s")"), "f"); },
                     {"polarization_i", "\"u\""});
    expectInputError([&] { readBird(with("inStokes", "[1,2,0,0], 1, 1, 1"), "f"); },
                     {"polarization_i", "Stokes"});
    expectInputError([&] { readBird(with("sp", R"("s")"), "f"); }, {"polarization_i", "4 values"});
    std::string seen = with("sp", R"("u", "u", "u", "s")");
    seen.replace(seen.find("polarization_i"), 14, "polarization_r");
    expectInputError([&] { readBird(seen, "f"); }, {"polarization_r", "analyser"});
}

TEST(Bird, UncertaintiesAreAbsoluteOrInPercent) {
    const Samples percent =
        readBird(birdFile(R"("uBRDF": {"unit": "%", "values": [1, 2, 3, 4]}, )"), "f");
    ASSERT_EQ(percent.sigmas.size(), 4U);
    EXPECT_NEAR(percent.sigmas[1], 0.008, 1e-15);
    const Samples absolute = readBird(
        birdFile(twoWavelengths + R"("uBRDF": {"unit": "1/sr", "values": [1, 2, 3, 4]}, )"), "f");
    EXPECT_EQ(absolute.sigmas, (Values{1, 2, 3, 4}));
    std::string constant = birdFile("");
    const std::string end = R"(0.2, 0.4, 0.3, 0.5])";
    constant.replace(constant.find(end), end.size(),
                     end + R"(, "uncertainty": {"value": 0.01, "unit": "sr^-1"})");
    EXPECT_EQ(readBird(constant, "f").sigmas, (Values{0.01, 0.01, 0.01, 0.01}));
    EXPECT_TRUE(readBird(birdFile(""), "f").sigmas.empty());
}

TEST(Bird, FieldsAreChecked) {
    const auto refused = [](const std::string& text, const std::vector<std::string>& parts) {
        expectInputError([&] { readBird(text, "f"); }, parts);
    };
    cutEverywhere([](std::string_view t) { readBird(t, "f"); }, birdFile(twoWavelengths));
    refused("", {"f"});
    refused("[]", {"object"});
    refused("{}", {"data"});
    refused(R"({"data": {}})", {"BRDF"});
    refused(birdFile("", "0.2, 0.4"), {"theta_i", "4 values", "2"});
    refused(birdFile("", ""), {"BRDF", "empty"});
    refused(birdFile("", "0.2, 0.4, \"a\", 1"), {"BRDF"});
    refused(birdFile("", "1, 1, 1, 1", "grad"), {"theta_i", "unit"});
    refused(birdFile("", "1, 1, 1, 1", "rad"), {"theta_i is 10"});
    refused(birdFile(R"("wavelength_i": {"unit": "m", "values": [1, 1, 1, 1]}, )"),
            {"wavelength_i", "unit"});
    refused(birdFile(R"("uBRDF": {"unit": "%", "values": [1]}, )"), {"uBRDF", "1 values"});
    std::string unit = birdFile("");
    unit.replace(unit.find("sr^-1"), 5, "W");
    refused(unit, {"BRDF", "1/sr"});
}

}  // namespace
}  // namespace hshfit::brdfs
