// Damaged files of scattered samples end in one clear line.

#include "places.h"

#include <brdfs/measured/scattered/alta.h>
#include <brdfs/measured/scattered/astm.h>
#include <brdfs/measured/scattered/cornell.h>
#include <brdfs/measured/scattered/nist.h>
#include <brdfs/measured/scattered/scatmech.h>
#include <brdfs/measured_files.h>

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>

namespace hshfit::brdfs {
namespace {

using Reader = std::function<void(std::string_view)>;

/// From a copy on the heap of exactly the size, so that a sanitizer sees one byte too many.
template <class Read>
Reader exact(const Read& read) {
    return [=](std::string_view text) {
        const std::unique_ptr<char[]> copy(new char[text.size() + 1]);
        char* const at = copy.get() + 1;
        std::memcpy(at, text.data(), text.size());
        read(std::string_view(at, text.size()));
    };
}

void refused(const Reader& read, const std::string& text, const std::vector<std::string>& parts) {
    test::expectInputError([&] { read(text); }, parts);
}

/// For every truncation, either the reader takes the rest or it throws InputError.
void cutEverywhere(const Reader& read, const std::string& text) {
    EXPECT_NO_THROW(read(text));
    for (std::size_t size = 0; size < text.size(); ++size) {
        try {
            read(std::string_view(text).substr(0, size));
        } catch (const InputError&) {
        }
    }
}

const Reader cornell = exact([](std::string_view t) { readCornell(t, "f"); });
const Reader astm = exact([](std::string_view t) { readAstm(t, "f"); });
const Reader nist = exact([](std::string_view t) { readNist(t, "f"); });
const Reader scatmech = exact([](std::string_view t) { readScatmech(t, "f", "f"); });
const Reader alta = exact([](std::string_view t) { readAlta(t, "f"); });
const Reader function = exact([](std::string_view t) { readAltaFunction(t, "f"); });

TEST(CornellAttack, fieldsAreChecked) {
    cutEverywhere(cornell, "# x\n2\n400 500\n0.1 0 0.2 0.3 1 2\n0.1 0 0.2 0.4 1 2\n");
    refused(cornell, "", {"number of wavelengths"});
    refused(cornell, "# only\n", {"number of wavelengths"});
    refused(cornell, "9999999\n400 500\n", {"line 1", "9999999"});
    refused(cornell, "1e300\n", {"line 1"});
    refused(cornell, "nan\n400\n", {"line 1"});
    refused(cornell, "-3\n400\n", {"line 1"});
    refused(cornell, "2 3\n400\n", {"line 1"});
    refused(cornell, "2\n400\n", {"1 of 2 wavelengths"});
    refused(cornell, "2\n400 300\n", {"wavelength 1 is 300", "ascending"});
    refused(cornell, "2\n400 nan\n", {"wavelength 1"});
    refused(cornell, "2\n400 500 600\n", {"3 wavelengths, but 2"});
    refused(cornell, "1\n400\n0.1 0 0.2\n", {"line 3", "3 numbers"});
    refused(cornell, "1\n400\n0.1 0 0.2 0 x\n", {"line 3", "'x' is no number"});
    refused(cornell, "1\n400\n0.1 0 0.2 0 nan\n", {"line 3", "400nm", "nan"});
    refused(cornell, "1\n400\n0.1 0 0.2 0 1e999\n", {"line 3", "inf"});
    refused(cornell, "1\n400\n30 0 0.2 0 1\n", {"theta_i is 30", "degrees?"});
    refused(cornell, "1\n400\n0.1 0 0.2 180 1\n", {"phi_s is 180", "degrees?"});
}

TEST(AstmAttack, fieldsAreChecked) {
    const std::string names = "VARS theta_i,phi_i,theta_s,phi_s,a\n";
    cutEverywhere(astm, "LAB_NAME x\nNUM_POINTS 1\n" + names + "0.1,0,0.2,0,1\n");
    refused(astm, "", {"VARS"});
    refused(astm, "LAB_NAME x\n", {"VARS"});
    refused(astm, "VARS theta_i,a\n", {"theta_s"});
    refused(astm, "VARS theta_i,theta_s\n", {"at least one value"});
    refused(astm, "VARS theta_i,theta_i,theta_s,a\n", {"theta_i twice"});
    refused(astm, "VARS theta_i,,theta_s,a\n", {"name 2", "empty"});
    refused(astm, "VARS theta_i,theta_s,a,b\n", {"a,b"});
    refused(astm, "VARS theta_i,theta_s,500nm,400nm\n", {"ascending"});
    refused(astm, "NUM_POINTS many\n" + names, {"NUM_POINTS"});
    refused(astm, "NUM_POINTS 2\n" + names + "0.1,0,0.2,0,1\n", {"1 rows", "announces 2"});
    refused(astm, names + "0.1,0,0.2,0\n", {"line 2", "4 numbers", "names 5"});
    refused(astm, names + "45,0,0.2,0,1\n", {"theta_i is 45", "degrees?"});
    refused(astm, names + "0.1,0,0.2,0,inf\n", {"line 2", "inf"});
    refused(astm, names + "0.1,nan,0.2,0,1\n", {"phi_i is nan"});
}

TEST(NistAttack, fieldsAreChecked) {
    std::string row = "0.633,-30,0,45,10,0.3";
    for (int k = 0; k < 15; ++k) row += ",0";
    const std::string names = "lambda,thetai,phi,thetar,phir\n";
    cutEverywhere(nist, names + row + "\n");
    refused(nist, "", {"names of the columns"});
    refused(nist, row, {"names of the columns"});
    refused(nist, names, {"no rows"});
    refused(nist, names + "1,2,3\n", {"line 2", "3 numbers", "21"});
    refused(nist, names + row + "\n" + row + "\n", {"line 3", "second row"});
    refused(nist, names + "-" + row + "\n", {"lambda is -0.633"});
    refused(nist, names + "633" + row.substr(5, row.size()) + "\n" + "6330" + row.substr(5),
            {"lambda is 6330"});
    refused(nist, names + "0.633,-130" + row.substr(9) + "\n", {"thetai is -130"});
    refused(nist, names + "0.633,nan" + row.substr(9) + "\n", {"thetai is nan"});
}

TEST(ScatmechAttack, fieldsAreChecked) {
    cutEverywhere(scatmech, "1, 1, 2, 0, 0, 0, 0, 0.5\n2, 2, 1, 1, -1, 1, 0, 3\n");
    refused(scatmech, "", {"no row"});
    refused(scatmech, "2,2,0,0,0,0,0,1\n", {"no row of Mueller element 11"});
    refused(scatmech, "1,1,0,0,0,0,0\n", {"line 1", "7 numbers"});
    refused(scatmech, "1,1,999999999,0,0,0,0,1\n", {"n is 999999999", "40"});
    refused(scatmech, "1,1,0.5,0,0,0,0,1\n", {"n is 0.5"});
    refused(scatmech, "1,5,0,0,0,0,0,1\n", {"j is 5"});
    refused(scatmech, "1,1,0,0,0,0,-1,1\n", {"p is -1"});
    refused(scatmech, "1,1,nan,0,0,0,0,1\n", {"n is nan"});
    refused(scatmech, "1,1,1,0,0,0,0,1\n", {"n - l"});
    refused(scatmech, "1,1,2,2,4,4,0,1\n", {"2, 2, 4, 4"});
    refused(scatmech, "1,1,0,0,0,0,0,inf\n", {"a is inf"});
}

const std::string altaHead = "#DIM 4 1\n#PARAM_IN SPHERICAL_TL_PL_TV_PV\n";

std::string stream(const std::string& count, std::size_t bytes, const std::string& end) {
    return altaHead + "#FORMAT binary\n#SAMPLE_COUNT " + count + "\n#BEGIN_STREAM\n" +
           std::string(bytes, '\0') + end;
}

TEST(AltaAttack, textIsChecked) {
    cutEverywhere(alta, altaHead + "#VS 2\n0.1 0 0.2 0 1 0.9 1.1\n0.1 0 0.2 0 1 0.9 1.1\n");
    refused(alta, "", {"no line #DIM"});
    refused(alta, "#PARAM_IN COS_TH\n0.5 1\n", {"line 2", "no line #DIM"});
    refused(alta, "#DIM 1 1\n0.5 1\n", {"UNKNOWN_INPUT", "readable are COS_TH"});
    refused(alta, "#DIM 1 1\n#PARAM_IN ISOTROPIC_TV_TL\n0.5 1\n", {"ISOTROPIC_TV_TL"});
    refused(alta, "#DIM 999999999 1\n", {"line 1", "999999999"});
    refused(alta, "#DIM -1 1\n", {"line 1"});
    refused(alta, "#DIM nan 1\n", {"line 1"});
    refused(alta, "#DIM 2 1\n#PARAM_IN COS_TH\n0.5 0.5 1\n", {"2 coordinates", "has 1"});
    refused(alta, "#DIM 1 2\n#PARAM_IN COS_TH\n0.5 1 1\n", {"2 values"});
    refused(alta, "#DIM 1 1\n#PARAM_IN COS_TH\n#PARAM_OUT ENERGY\n0.5 1\n", {"ENERGY"});
    refused(alta, "#DIM 1 1\n#VS 1 1\n", {"#VS has 2 numbers"});
    refused(alta, "#DIM 1 1\n#VS 7\n", {"#VS is 7"});
    refused(alta, altaHead + "0.1 0 0.2\n", {"line 3", "3 numbers"});
    refused(alta, altaHead + "45 0 0.2 0 1\n", {"line 3", "is 45", "degrees?"});
    refused(alta, altaHead + "0.1 0 nan 0 1\n", {"coordinate 3 is nan"});
    refused(alta, altaHead + "0.1 0 0.2 0 nan\n", {"line 3", "nan"});
    refused(alta, "#DIM 1 1\n#PARAM_IN COS_TH\n1.5 1\n", {"is 1.5"});
    refused(alta, "#DIM 6 1\n#PARAM_IN CARTESIAN\n1 1 1 0 0 1 1\n", {"no pair of unit vectors"});
    refused(alta, "#DIM 2 1\n#PARAM_IN STARK_2D\n1 1 1\n", {"no pair of unit vectors"});
}

TEST(AltaAttack, binaryStreamsAreChecked) {
    const std::string whole = stream("2", 80, "\n#END_STREAM\n");
    cutEverywhere(alta, whole);
    for (std::size_t size = altaHead.size() + 16; size + 1 < whole.size(); ++size) {
        const std::string cut = whole.substr(0, size);
        if (cut.find("#BEGIN_STREAM") != std::string::npos) refused(alta, cut, {});
    }
    refused(alta, stream("3", 80, "\n#END_STREAM\n"), {"3 samples of 5 doubles"});
    refused(alta, stream("1", 80, "\n#END_STREAM\n"), {"#END_STREAM after 1 samples"});
    refused(alta, stream("1e15", 80, "\n#END_STREAM\n"), {"too few"});
    refused(alta, stream("1e300", 80, "\n#END_STREAM\n"), {"#SAMPLE_COUNT is"});
    refused(alta, stream("nan", 80, ""), {"#SAMPLE_COUNT is nan"});
    refused(alta, altaHead + "#BEGIN_STREAM\n", {"no #FORMAT binary"});
    refused(alta, altaHead + "#FORMAT binary\n0 0 0 0 1\n", {"#BEGIN_STREAM"});
    refused(alta, "#FORMAT tree\n", {"'tree'", "binary or text"});
    refused(alta, "#PRECISION half\n", {"'half'"});
    refused(alta, "#ENDIAN middle\n", {"'middle'"});
    refused(alta, "#VERSION 1\n", {"#VERSION"});
    std::string bad = stream("2", 80, "\n#END_STREAM\n");
    const double nan = std::numeric_limits<double>::quiet_NaN();
    std::memcpy(bad.data() + bad.find("STREAM\n") + 7 + 40, &nan, 8);
    refused(alta, bad, {"sample 1", "coordinate 1 is nan"});
}

TEST(AltaAttack, functionsAreChecked) {
    const std::string head = "#ALTA FUNC HEADER\n#DIM 6 1\n";
    cutEverywhere(function, head +
                                "#FUNC nonlinear_function_blinn\nKs 1\nN 5\n#FUNC "
                                "nonlinear_function_diffuse\nkd 1\n");
    refused(function, head, {"no #FUNC"});
    refused(function, "#FUNC nonlinear_function_diffuse\nkd 1\n", {"no #DIM"});
    refused(function, "#DIM 6 999999999\n", {"line 1"});
    refused(function, head + "#FUNC nonlinear_function_lafortune\n", {"line 3", "lafortune"});
    refused(function,
            "#ALTA FUNC HEADER\n#DIM 1 1\n#PARAM_IN COS_TH\n#FUNC rational_function\n#NP 1\n",
            {"last coefficient"});
    refused(function,
            head +
                "#FUNC nonlinear_function_diffuse\nkd 1\n#DIM 1 3\n#FUNC "
                "nonlinear_function_diffuse\nkd 1 1 1\n",
            {"#DIM"});
    refused(function, head + "#FUNC nonlinear_function_diffuse\n", {"before kd"});
    refused(function, head + "#FUNC nonlinear_function_diffuse\nks 1\n", {"expected kd"});
    refused(function, head + "#FUNC nonlinear_function_diffuse\nkd nan\n", {"kd is nan"});
    refused(function, head + "#FUNC nonlinear_function_blinn\nKs 1\nN 1e9\n", {"N is"});
    refused(function, head + "what 3\n", {"belongs to no #FUNC"});
    refused(function, head + "#FUNC nonlinear_fresnel_schlick\nR 0.5\n", {"follows the one"});
    refused(function, head + "#FUNC nonlinear_function_abc\na 1\n", {"expected #PARAM"});
    refused(function, head + "#FUNC nonlinear_function_abc\n#PARAM CARTESIAN\n", {"no cosine"});
    refused(function, head + "#FUNC nonlinear_function_spherical_gaussian\nKs 1\nN 1\n",
            {"--sg-type"});
}

TEST(AltaAttack, rationalFunctionsAreChecked) {
    const std::string head = "#ALTA FUNC HEADER\n#DIM 2 1\n#PARAM_IN RUSIN_TH_TD\n";
    const std::string start = head + "#FUNC rational_function\n#MIN 0 0\n#MAX 1.5 1.5\n";
    const std::string whole = start + "#NP 2\n#NQ 1\n0 0 1\n1 0 -.5\n0 0 1\n";
    cutEverywhere(function, whole + "#FUNC nonlinear_function_diffuse\nkd 1\n");
    refused(function, "#ALTA FUNC HEADER\n#DIM 1 1\n#FUNC rational_function\n",
            {"line 3", "input=COS_TH"});
    refused(function, "#ALTA FUNC HEADER\n#DIM 3 1\n#PARAM_IN COS_TH\n#FUNC rational_function\n",
            {"3 coordinates", "COS_TH has 1"});
    refused(function, whole + "0 0 1\n", {"more coefficients than those of 1"});
    refused(function, start + "#NP 2\n#NQ 1\n0 0 1\n1 0 1\n", {"before its last coefficient"});
    refused(function, start + "#NP 1e9\n", {"#NP"});
    refused(function, start + "#NP 1.5\n", {"#NP"});
    refused(function, start + "#NP 1\n#NQ 1\n0 0 nan\n", {"coefficient is nan"});
    refused(function, start + "#NP 1\n#NQ 1\n0 500 1\n", {"degree 2 is 500"});
    refused(function, start + "#NP 1\n#NQ 1\n0 1\n", {"2 numbers, expected 2 degrees"});
    refused(function, start + "#NP 1\n#NQ 1\n0 0 1\n0 0 0\n", {"denominator is 0"});
    refused(function, start + "0 0 1\n", {"no #MIN, #MAX, #NP and #NQ"});
    refused(function, start + "#BASIS CHEBYSHEV\n", {"expected LEGENDRE"});
    refused(function, head + "#FUNC rational_function\n#MIN 0\n", {"#MIN has to have 2"});
    refused(function, head + "#FUNC rational_function\n#MIN 0 inf\n", {"#MIN has to have 2"});
    refused(function,
            head + "#FUNC rational_function\n#MIN 1 0\n#MAX 0 1\n#NP 1\n#NQ 1\n0 0 1\n0 0 1\n",
            {"#MIN 1 is above"});
}

// A pole, an overflow and a quotient of two zeros are finite numbers.
TEST(AltaAttack, rationalFunctionsStayFinite) {
    const std::string head =
        "#ALTA FUNC HEADER\n#DIM 1 1\n#PARAM_IN COS_TH\n#FUNC rational_function\n#MIN 0\n#MAX 1\n";
    for (const char* body :
         {"#NP 1\n#NQ 1\n0 1\n1 1\n", "#NP 1\n#NQ 1\n1 1\n1 1\n", "#NP 1\n#NQ 1\n0 -1\n1 1\n",
          "#NP 1\n#NQ 1\n100 1e150\n100 1e-150\n"}) {
        const auto brdf = readAltaFunction(head + body, "f");
        for (const double theta : {0.0, 59.0, 60.0, 61.0, 89.99}) {
            const Direction h = directionFromAngles(radians(theta), 0);
            const double f = evaluate(*brdf, h, h)[0];
            EXPECT_TRUE(std::isfinite(f) && f >= 0) << body << theta << " " << f;
        }
    }
}

// On the horizon f cos is 0 whatever f is, and the cosine of 90 degrees may round to either side.
TEST(Alta, rowsOfFTimesCosineOnTheHorizonAreLeftOutAndCounted) {
    const std::string head =
        "#DIM 3 1\n#PARAM_IN ISOTROPIC_TL_TV_PROJ_DPHI\n"
        "#PARAM_OUT INV_STERADIAN_COSINE_FACTOR\n";
    // hypot of the second and the third is above pi/2 by an ulp, and pi/2 itself.
    const Samples samples = readAlta(head +
                                         "0.25 -0.5372439848258255 -1.4760657170467744 0.5\n"
                                         "0.25 1.5707963267948966 0 0.5\n0.25 0 0 0.5\n",
                                     "f");
    ASSERT_EQ(samples.size(), 1u);
    EXPECT_DOUBLE_EQ(samples.values[0], 0.5);
    EXPECT_EQ(samples.census.values, 3u);
    EXPECT_EQ(samples.census.belowHorizon, 2u);

    const std::string path = test::sharedFolder() + "/data/alta/retro-gray-tape.dat";
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
    std::stringstream text;
    text << std::ifstream(path).rdbuf();
    std::string all = text.str(), line;
    std::size_t rows = 0, horizontal = 0;
    while (std::getline(text, line)) {
        if (line.empty() || line[0] == '#') continue;
        std::istringstream numbers(line);
        double theta = 0, x = 0, y = 0;
        numbers >> theta >> x >> y;
        ++rows;
        horizontal += std::fabs(std::hypot(x, y) - pi / 2) < 1e-9;
    }
    ASSERT_GT(horizontal, 5u);
    const Samples tape = readAlta("#PARAM_OUT INV_STERADIAN_COSINE_FACTOR\n" + all, "f");
    EXPECT_EQ(tape.size(), rows - horizontal);
    for (const Direction& wo : tape.wo) EXPECT_GT(wo.z, 1e-9);
}

}  // namespace
}  // namespace hshfit::brdfs
