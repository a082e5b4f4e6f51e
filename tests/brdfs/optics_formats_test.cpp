// Files of optical design programs: Zemax, FRED, Speos and OpenMATERIAL. The geometry is checked by
// rotations, the real files by parsers of their own, and one measurement in two forms against
// itself.

#include "places.h"
#include "skip_without.h"

#include <brdfs/catalog.h>
#include <brdfs/measured/scattered/fred.h>
#include <brdfs/measured/scattered/scattered.h>
#include <brdfs/measured/scattered/speos.h>
#include <brdfs/measured/scattered/xompt.h>
#include <brdfs/measured/scattered/zemax.h>
#include <brdfs/measured_files.h>
#include <brdfs/sample_checks.h>

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

namespace hshfit::brdfs {
namespace {

using test::atDegrees;
using test::cutEverywhere;
using test::expectDirection;
using Values = std::vector<double>;

std::string field(const std::string& name) {
    return test::sharedFolder() + "/data/field/files/" + name;
}

std::string textOf(const std::string& path) {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
}

const Samples& samplesOf(const Brdf& brdf) {
    return dynamic_cast<const Scattered&>(brdf).samples();
}

/// Rodrigues' formula: `v` turned counterclockwise about the unit vector `axis`.
Direction turnedAbout(const Direction& axis, const Direction& v, double angle) {
    const double c = std::cos(angle), s = std::sin(angle), k = dot(axis, v) * (1 - c);
    return {v.x * c + (axis.y * v.z - axis.z * v.y) * s + axis.x * k,
            v.y * c + (axis.z * v.x - axis.x * v.z) * s + axis.y * k,
            v.z * c + (axis.x * v.y - axis.y * v.x) * s + axis.z * k};
}

TEST(Zemax, PlacesAreTurnedAboutTheSpecularDirection) {
    for (const double incidence : {0.0, 10.0, 65.0})
        for (const double azimuth : {0.0, 40.0, 90.0, 180.0, 250.0})
            for (const double radial : {0.0, 5.0, 60.0})
                for (const double rotation : {0.0, 30.0}) {
                    const DirectionPair pair = zemaxPair(rotation, incidence, azimuth, radial);
                    const double turn = -radians(rotation);
                    const Direction specular = atDegrees(incidence, 0);
                    // Towards the normal: from the specular direction by `radial` back along theta.
                    const Direction start = atDegrees(incidence - radial, 0);
                    const Direction wo = turnedAbout(specular, start, radians(azimuth));
                    expectDirection(pair.wo, turnedAbout({0, 0, 1}, wo, turn));
                    expectDirection(pair.wi,
                                    turnedAbout({0, 0, 1}, atDegrees(incidence, 180), turn));
                }
}

const std::string zemaxText =
    "# own\nSource  Measured\nSymmetry  PlaneSymmetrical\nSpectralContent  Monochrome\n"
    "ScatterType  BRDF\nSampleRotation  1\n0\nAngleOfIncidence  2\n10\t40\t\nScatterAzimuth 2\n"
    "0 180\nScatterRadial 3\n0 10 60\n\nMonochrome\nDataBegin\nTIS 0.1\n0.5 0.4 0.3\n0.5 0.2 0\n"
    "TIS 0.2\n0.9 0.8 0.7\n0.9 0.6 0\nDataEnd\n";

TEST(Zemax, TablesAreSamplesAndZerosAreNot) {
    const Samples samples = readZemax(zemaxText, "f");
    // One specular value each; 180/60 at 10 degrees is 0 above the horizon, at 40 below it.
    EXPECT_EQ(samples.values, (Values{0.5, 0.4, 0.3, 0.2, 0.9, 0.8, 0.7, 0.6}));
    expectDirection(samples.wo[1], {0, 0, 1});
    expectDirection(samples.wo[3], atDegrees(20, 0));
    expectDirection(samples.wi[4], atDegrees(40, 180));
    EXPECT_EQ(samples.census.belowHorizon, 1u);
    ASSERT_EQ(samples.leftOut.size(), 1u);
    EXPECT_EQ(samples.leftOut[0].substr(0, 2), "1 ");
    EXPECT_EQ(readZemax(zemaxText, "f", true).size(), 9u);
}

TEST(Zemax, TristimulusValuesOfANeutralSurfaceAreGrey) {
    std::string text = zemaxText;
    const auto swap = [&](const std::string& from, const std::string& to) {
        text.replace(text.find(from), from.size(), to);
    };
    swap("SpectralContent  Monochrome", "SpectralContent  XYZ");
    const std::string data = zemaxText.substr(zemaxText.find("DataBegin"));
    text = text.substr(0, text.find("Monochrome\nDataBegin"));
    for (const char* name : {"TristimulusX\n", "TristimulusY\n", "TristimulusZ\n"})
        text += name + data;
    const Samples samples = readZemax(text, "f");
    ASSERT_EQ(samples.channels.kind, Channels::Kind::rgb);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(samples.values[c], 0.5, 1e-12);
}

TEST(Zemax, SeveralRotationsAreAnisotropicAndMirroredWhereStated) {
    std::string text = zemaxText;
    text.replace(text.find("SampleRotation  1\n0"), 19, "SampleRotation  2\n0 90");
    text.replace(text.find("0 180\n"), 6, "0 90\n");
    const std::string tables =
        zemaxText.substr(zemaxText.find("TIS"), zemaxText.find("DataEnd") - zemaxText.find("TIS"));
    text.insert(text.find("DataEnd"), tables);
    const Samples samples = readZemax(text, "f");
    EXPECT_FALSE(samples.isotropic);
    // 5 + 6 samples a rotation with one value of 0 fewer, and azimuth 90 twice.
    std::size_t left = 0, right = 0;
    for (std::size_t k = 0; k < samples.size(); ++k) {
        const double side = samples.wi[k].x * samples.wo[k].y - samples.wi[k].y * samples.wo[k].x;
        left += side > 1e-9;
        right += side < -1e-9;
    }
    EXPECT_GT(left, 0u);
    EXPECT_EQ(left, right);
    expectDirection(samples.wi.back(), atDegrees(40, 90));
}

TEST(Fred, RowsAreAboutTheNormalAndIncidencesSpecular) {
    const Samples samples = readFred(
        "! own\ntype bsdf_data\nformat angles=deg bsdf=value scale=1\n10 0\n0 0 0.5\n20 0 0.4\n"
        "30\t90\t0.3\n120 0 9\n50 90\n20 0 0.2\n",
        "f");
    ASSERT_EQ(samples.size(), 4u);
    expectDirection(samples.wi[0], atDegrees(10, 180));
    expectDirection(samples.wo[1], atDegrees(20, 0));
    expectDirection(samples.wo[2], atDegrees(30, 90));
    expectDirection(samples.wi[3], atDegrees(50, 270));
    EXPECT_EQ(samples.values, (Values{0.5, 0.4, 0.3, 0.2}));
    EXPECT_EQ(samples.leftOut, (std::vector<std::string>{"1 samples of transmission"}));
}

/// v = 1 everywhere and 20 percent: f = 0.2 / pi for values of f, 0.2 / (2 pi cos theta) for
/// intensities.
TEST(Speos, PercentagesScaleTheTables) {
    const auto file = [](const std::string& type) {
        return "OPTIS - brdf surface file v8.0\n0\nown\n5\nab\ncd\n1\t1\n" + type +
               "\n1\t2\n30\n500 600\n20\n3 3\n\t0 180 360\n0 1 1 1\n45 1 1 1\n90 1 1 1\n"
               "40\n3 3\n\t0 180 360\n0 2 2 2\n45 2 2 2\n90 2 2 2\nEnd of file\n";
    };
    const Samples f = readSpeos(file("1"), "f");
    EXPECT_EQ(f.channels.wavelengths, (Values{500, 600}));
    ASSERT_EQ(f.size(), 5u);  // the normal once, and azimuth 360 is 0
    for (std::size_t k = 0; k < f.size(); ++k) {
        EXPECT_NEAR(f.values[2 * k], 0.2 / pi, 1e-12);
        EXPECT_NEAR(f.values[2 * k + 1], 0.4 / pi, 1e-12);
    }
    expectDirection(f.wi[0], atDegrees(30, 180));
    expectDirection(f.wo[1], atDegrees(45, 0));
    const Samples intensity = readSpeos(file("0"), "f");
    ASSERT_EQ(intensity.size(), 3u);  // none on the horizon
    EXPECT_NEAR(intensity.values[2], 0.2 / (2 * pi * std::sqrt(0.5)), 1e-12);
    EXPECT_EQ(f.leftOut, (std::vector<std::string>{"transmission (option side)"}));
}

/// Two anisotropy angles, values 1 and 3, and a spectrum measured half way between two incidences.
TEST(Speos, AnisotropicTablesShareOneScale) {
    const std::string table = "2 2\n0 180\n0 %% %%\n90 %% %%\n";
    std::string text =
        "OPTIS - Anisotropic BSDF surface file v8.0\n0\nown\n0\n\n0 1 0\n1 0\n1\n2\n0 90\n"
        "2\n10 30\n1\n20\n20 0\nnm, percent\n2\n400 10\n500 20\n";
    for (const char* value : {"1", "2", "3"}) {
        std::string own = table;
        for (std::size_t at = own.find("%%"); at != std::string::npos; at = own.find("%%"))
            own.replace(at, 2, value);
        text += own;
    }
    const Samples samples = readSpeos(text, "f");
    EXPECT_FALSE(samples.isotropic);
    EXPECT_EQ(samples.channels.wavelengths, (Values{400, 500}));
    // 1/I is the mean of 1/pi and 1/(2 pi).
    const double scale = 0.75 / pi;
    ASSERT_EQ(samples.size(), 9u);
    EXPECT_NEAR(samples.values[0], 0.1 * scale, 1e-12);
    EXPECT_NEAR(samples.values[1], 0.2 * scale, 1e-12);
    EXPECT_NEAR(samples.values[6], 0.2 * scale, 1e-12);
    EXPECT_NEAR(samples.values[12], 0.3 * scale, 1e-12);
    expectDirection(samples.wi[6], atDegrees(20, 90));
    expectDirection(samples.wo[7], atDegrees(90, -90));
}

TEST(Xompt, RowsOfWavelengthsBecomeChannels) {
    const Samples samples = readXompt(
        R"({"metadata": {"name": "own"}, "brdf": {"wavelengths": [5e-7, 6e-7], "lookupTable": [
            [5e-7, 0.1, 0.2, 3.0, 0.3], [5e-7, 0.1, 0.4, 0.0, 0.5], [5e-7, 0.1, 0.6, 0.0, null],
            [6e-7, 0.1, 0.2, 3.0, 0.4]]}})",
        "f");
    EXPECT_EQ(samples.channels.wavelengths, (Values{500, 600}));
    EXPECT_EQ(samples.values, (Values{0.3, 0.4}));
    expectDirection(samples.wi[0], directionFromAngles(0.1, 0));
    expectDirection(samples.wo[0], directionFromAngles(0.2, 3));
    EXPECT_EQ(samples.leftOut.size(), 2u);
}

/// Values of a real Zemax file by a parser of this test: incidence, azimuth, radial -> value.
std::map<std::array<double, 3>, double> zemaxValues(const std::string& path) {
    std::istringstream text(textOf(path));
    std::string line, word;
    std::map<std::string, Values> lists;
    std::map<std::array<double, 3>, double> values;
    std::size_t incidence = 0, azimuth = 0;
    bool data = false;
    while (std::getline(text, line)) {
        if (line.empty() || line[0] == '#') continue;
        std::istringstream words(line);
        words >> word;
        if (word == "DataBegin") data = true;
        if (!data &&
            (word == "AngleOfIncidence" || word == "ScatterAzimuth" || word == "ScatterRadial")) {
            std::getline(text, line);
            std::istringstream numbers(line);
            for (double x; numbers >> x;) lists[word].push_back(x);
        } else if (data && word == "TIS") {
            ++incidence;
            azimuth = 0;
        } else if (data && incidence > 0 && word != "DataEnd") {
            std::istringstream numbers(line);
            for (const double radial : lists["ScatterRadial"]) {
                double value = 0;
                if (!(numbers >> value)) break;
                values[{lists["AngleOfIncidence"][incidence - 1], lists["ScatterAzimuth"][azimuth],
                        radial}] = value;
            }
            ++azimuth;
        }
    }
    return values;
}

TEST(ZemaxShared, EveryValueIsASampleAndIsReturned) {
    for (const auto& [name, tables] :
         {std::pair("zemax/AnoBlackEC1onAlum.bsdf", 4 * 19 * 12),
          std::pair("zemax/test_13_planesymmetric_brdf_zemax.bsdf", 13 * 19 * 11)}) {
        const std::string path = field(name);
        SKIP_WITHOUT(path);
        const auto stored = zemaxValues(path);
        ASSERT_EQ(stored.size(), static_cast<std::size_t>(tables));
        const auto brdf = open(path + ":exchange=no");
        std::size_t checked = 0;
        for (const auto& [at, value] : stored) {
            if (value == 0) continue;
            // Independently of zemaxPair: the specular direction turned back and about itself.
            const Direction specular = atDegrees(at[0], 0);
            const Direction wo = turnedAbout(specular, atDegrees(at[0] - at[2], 0), radians(at[1]));
            if (wo.z <= 1e-6) continue;
            EXPECT_NEAR(evaluate(*brdf, atDegrees(at[0], 180), wo)[0], value, 1e-9 + 1e-6 * value)
                << name << " at " << at[0] << ", " << at[1] << ", " << at[2];
            ++checked;
        }
        std::printf("%s: %zu values, %zu samples\n", name, checked, samplesOf(*brdf).size());
        EXPECT_GT(checked, stored.size() / 2);
    }
}

/// One measurement in two files. FRED's is every 5 and 10 degrees about the normal, Zemax's is
/// resampled about the specular direction, every 5 to 10 degrees; neither states its smoothing.
TEST(ZemaxShared, AgreesWithTheSameMeasurementInFredsForm) {
    const std::string zemax = field("zemax/AnoBlackEC1onAlum.bsdf");
    const std::string fred = field("fred/AnoBlackEC1onAlum.txt");
    SKIP_WITHOUT(zemax);
    const auto table = open(zemax + ":exchange=no"), rows = open(fred);
    const Samples& samples = samplesOf(*rows);
    EXPECT_EQ(samples.size(), 289u + 3 * 285u);
    double sum = 0, squares = 0, turned = 0, count = 0;
    for (std::size_t k = 0; k < samples.size(); ++k) {
        const Direction &wi = samples.wi[k], &wo = samples.wo[k];
        // Past 70 degrees the tables have holes, and at 70 degrees of incidence they differ.
        if (wo.z < std::cos(radians(65.5)) || wi.z < std::cos(radians(60))) continue;
        const double f = samples.values[k];
        const double ratio = evaluate(*table, wi, wo)[0] / f - 1;
        const double wrong = evaluate(*table, wi, mirrored(wo))[0] / f - 1;
        sum += ratio;
        squares += ratio * ratio;
        turned += wrong * wrong;
        ++count;
    }
    std::printf(
        "Zemax over FRED at %.0f samples: mean %+.4f, root mean square %.4f (opposite "
        "azimuth: %.2f)\n",
        count, sum / count, std::sqrt(squares / count), std::sqrt(turned / count));
    EXPECT_NEAR(sum / count, 0, 0.02);
    EXPECT_LT(std::sqrt(squares / count), 0.08);
    EXPECT_GT(std::sqrt(turned / count), 0.5);
    // Where no interpolation comes between, the specular directions at 10 and 30 degrees.
    for (const double theta : {10.0, 30.0}) {
        const Direction wi = atDegrees(theta, 180);
        const double f = evaluate(*rows, wi, mirrored(wi))[0];
        EXPECT_NEAR(evaluate(*table, wi, mirrored(wi))[0], f, 5e-4 * f) << theta;
    }
}

TEST(FredShared, RowsOfAFullCircleAreThoseOfHalfOfIt) {
    const std::string half = field("fred/AnoBlackEC1onAlum.txt");
    const std::string full = field("fred/AnoBlackEC1onAlum_fullAz.txt");
    SKIP_WITHOUT(half);
    const auto a = open(half), b = open(full);
    const Samples& samples = samplesOf(*b);
    EXPECT_GT(samples.size(), samplesOf(*a).size());
    for (std::size_t k = 0; k < samples.size(); ++k)
        EXPECT_NEAR(evaluate(*a, samples.wi[k], samples.wo[k])[0], samples.values[k],
                    1e-6 * samples.values[k]);
}

/// The sum over the samples of f cos(theta) times their cells of 1 degree.
TEST(SpeosShared, TablesReflectTheirPercentages) {
    const std::string path = field("speos/test_13_brdf_one_wavelength_speos.brdf");
    SKIP_WITHOUT(path);
    const Samples samples = readSpeos(textOf(path), path);
    EXPECT_EQ(samples.channels.wavelengths, (Values{550}));
    EXPECT_EQ(samples.size() + samples.census.belowHorizon, 4u * (90 * 360 + 1));
    std::map<double, double> reflectance;
    for (std::size_t k = 0; k < samples.size(); ++k) {
        const double theta = polarAngle(samples.wo[k]), step = radians(1);
        const double key = std::round(degrees(polarAngle(samples.wi[k])) * 10) / 10;
        reflectance[key] += samples.values[k] * std::sin(theta) * std::cos(theta) * step * step;
    }
    const std::map<double, double> stated{
        {0, 0.023}, {22.5, 0.01932}, {45, 0.1366}, {67.5, 0.1828}};
    for (const auto& [incidence, share] : stated)
        EXPECT_NEAR(reflectance[incidence], share, 1e-3 * share) << incidence;
}

/// The Speos file was made from the Zemax file, scaled to its TIS of 0.134506 at 15 degrees.
TEST(SpeosShared, FollowsTheZemaxFileThatItWasMadeFrom) {
    const std::string speos = field(
        "speos/test_13_planesymmetric_brdf_speos_reference"
        ".anisotropicbsdf");
    const std::string zemax = field("zemax/test_13_planesymmetric_brdf_zemax.bsdf");
    SKIP_WITHOUT(speos);
    const auto a = open(speos);
    EXPECT_EQ(a->channels().kind, Channels::Kind::grey);
    int compared = 0;
    for (const auto& [at, value] : zemaxValues(zemax)) {
        // Nodes of both files: the plane of incidence within 30 degrees of the normal.
        if (at[1] != 0 && at[1] != 180) continue;
        const double theta = at[0] - (at[1] == 0 ? at[2] : -at[2]);
        if (std::fabs(theta) > 60 || value == 0) continue;
        const Direction wi = atDegrees(at[0], 180);
        const double ratio = evaluate(*a, wi, atDegrees(theta, 0))[0] / value;
        if (ratio == 0) continue;  // the converter's own holes
        ++compared;
        EXPECT_GT(ratio, 1) << at[0] << ", " << theta;
        EXPECT_LT(ratio, 1.2) << at[0] << ", " << theta;
    }
    std::printf("%d places of both files\n", compared);
    EXPECT_GT(compared, 150);
}

TEST(XomptShared, EveryRowIsAValue) {
    const std::string path = field("xompt/asphalt_camera.xompt");
    SKIP_WITHOUT(path);
    const auto brdf = open(path);
    const Samples& samples = samplesOf(*brdf);
    EXPECT_EQ(samples.channels.count(), 32u);
    EXPECT_EQ(samples.values.size(), 1888u);
    EXPECT_EQ(samples.values[0], 1.4e-5);
    EXPECT_EQ(samples.values.back(), 2.6e-5);
}

void refusedBy(const std::function<void(const std::string&)>& read, const std::string& text,
               const std::vector<std::string>& parts) {
    test::expectInputError([&] { read(text); }, parts);
}

std::string with(std::string text, const std::string& from, const std::string& to) {
    return text.replace(text.find(from), from.size(), to);
}

TEST(ZemaxAttack, FieldsAreChecked) {
    const auto read = [](std::string_view text) { readZemax(text, "f"); };
    cutEverywhere(read, zemaxText);
    refusedBy(read, "", {"DataBegin"});
    refusedBy(read, with(zemaxText, "BRDF", "BSDF"), {"bsdf", "BRDF or BTDF"});
    refusedBy(read, with(zemaxText, "PlaneSymmetrical", "Round"), {"round", "PlaneSymmetrical"});
    refusedBy(read, with(zemaxText, "Monochrome", "Red"), {"red", "Monochrome"});
    refusedBy(read, with(zemaxText, "Source", "Sauce"), {"'Sauce'"});
    refusedBy(read, with(zemaxText, "Incidence  2", "Incidence  3"), {"'ScatterAzimuth'"});
    refusedBy(read, with(zemaxText, "Incidence  2", "Incidence  1e9"), {"whole number"});
    refusedBy(read, with(zemaxText, "10\t40", "40\t10"), {"ascending"});
    refusedBy(read, with(zemaxText, "10\t40", "10\t140"), {"140", "0 to 90"});
    refusedBy(read, with(zemaxText, "0.5 0.4 0.3", "0.5 0.4 nan"), {"nan"});
    refusedBy(read, with(zemaxText, "0.5 0.4 0.3", "0.5 0.4"), {"more numbers"});
    refusedBy(read, with(zemaxText, "0.5 0.4 0.3", "0.5 x 0.3"), {"'x' is no number"});
    refusedBy(read, with(zemaxText, "TIS 0.2", "0.2"), {"expected TIS"});
    refusedBy(read, with(zemaxText, "DataEnd", ""), {"DataEnd"});
    refusedBy(read, with(zemaxText, "Symmetry  PlaneSymmetrical\n", ""), {"Symmetry"});
}

TEST(FredAttack, FieldsAreChecked) {
    const auto read = [](std::string_view text) { readFred(text, "f"); };
    const std::string head = "type bsdf_data\nformat angles=deg bsdf=value scale=1\n";
    cutEverywhere(read, head + "10 0\n0 0 0.5\n20 90 0.25\n");
    refusedBy(read, "", {"bsdf_data"});
    refusedBy(read, "type x\n", {"bsdf_data"});
    refusedBy(read, "type bsdf_data\n", {"format"});
    refusedBy(read, "type bsdf_data\nformat bsdf=value\n", {"angles"});
    refusedBy(read, with(head, "scale=1", "scale=2"), {"scale=2", "option scale"});
    refusedBy(read, with(head, "value", "log"), {"bsdf=log"});
    refusedBy(read, head + "0 0 0.5\n", {"line 3", "3 numbers"});
    refusedBy(read, head + "10 0\n1 2 3 4\n", {"line 4", "4 numbers"});
    refusedBy(read, head + "100 0\n", {"theta_i is 100"});
    refusedBy(read, head + "10 0\n200 0 1\n", {"theta_s is 200", "180"});
    refusedBy(read, head + "10 0\n20 0 inf\n", {"line 4", "inf"});
}

TEST(SpeosAttack, FieldsAreChecked) {
    const auto read = [](std::string_view text) { readSpeos(text, "f"); };
    const std::string text =
        "OPTIS - brdf surface file v8.0\n0\nown\n2\nab\n1 0\n1\n1 1\n30\n550\n20\n2 3\n0 180 360\n"
        "0 1 1 1\n90 1 1 1\nEnd of file\n";
    cutEverywhere(read, text);
    refusedBy(read, "x\n", {"OPTIS"});
    refusedBy(read, "OPTIS - brdf surface file v8.0\n0\nown\n", {"description"});
    refusedBy(read, with(text, "v8.0\n0", "v8.0\n1"), {"binary", "text"});
    refusedBy(read, with(text, "1 0\n1\n", "0 1\n1\n"),
              {"line 15", "expected 90 to 180 for transmission"});
    refusedBy(read, with(text, "1 0\n1\n", "1 0\n7\n"), {"is 7"});
    refusedBy(read, with(text, "1 1\n30", "1e9 1\n30"), {"whole number"});
    refusedBy(read, with(text, "0 180 360", "0 180 270"), {"360 or 180"});
    refusedBy(read, with(text, "90 1 1 1", "120 1 1 1"), {"120", "90"});
    refusedBy(read, with(text, "\n20\n", "\n-1\n"), {"-1 percent"});
    refusedBy(read, with(with(text, "0 1 1 1", "0 0 0 0"), "90 1 1 1", "90 0 0 0"), {"integral"});
}

TEST(XomptAttack, FieldsAreChecked) {
    const auto read = [](std::string_view text) { readXompt(text, "f"); };
    const auto rows = [](const std::string& text) {
        return R"({"brdf": {"lookupTable": [)" + text + "]}}";
    };
    cutEverywhere(read, rows("[5e-7, 0.1, 0.2, 3.0, 0.3]"));
    refusedBy(read, "{}", {"lookupTable"});
    refusedBy(read, R"({"brdf": 3})", {"lookupTable"});
    refusedBy(read, rows(""), {"no row"});
    refusedBy(read, rows("[5e-7, 0.1, 0.2, 3.0]"), {"row 0", "5 numbers"});
    refusedBy(read, rows(R"([5e-7, 0.1, "x", 3.0, 1])"), {"row 0", "column 3"});
    refusedBy(read, rows("[5e-7, 10, 0.2, 3.0, 1]"), {"row 0", "theta_i is 10"});
    refusedBy(read, rows("[0, 0.1, 0.2, 3.0, 1]"), {"row 0", "wavelength"});
}

}  // namespace
}  // namespace hshfit::brdfs
