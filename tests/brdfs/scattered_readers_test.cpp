// The readers of scattered samples, on files written here byte by byte and on real ones.

#include "places.h"
#include "skip_without.h"

#include <brdfs/catalog.h>
#include <brdfs/measured/scattered/alta.h>
#include <brdfs/measured/scattered/alta_parameters.h>
#include <brdfs/measured/scattered/astm.h>
#include <brdfs/measured/scattered/cornell.h>
#include <brdfs/measured/scattered/nist.h>
#include <brdfs/measured/scattered/scatmech.h>
#include <brdfs/measured/scattered/scattered.h>
#include <brdfs/measured/text_reader.h>
#include <brdfs/measured_files.h>
#include <hshfit/projection/albedo.h>

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

namespace hshfit::brdfs {
namespace {

using test::TemporaryFile;

void expectNear(const Direction& a, const Direction& b, double tolerance = 1e-12) {
    EXPECT_NEAR(a.x, b.x, tolerance);
    EXPECT_NEAR(a.y, b.y, tolerance);
    EXPECT_NEAR(a.z, b.z, tolerance);
}

// The C library rounds correctly, and so has every path of our reader.
TEST(TextNumbers, areThoseOfTheCLibrary) {
    std::mt19937_64 engine(5);
    std::vector<std::string> texts{"0",
                                   "-0",
                                   "5.",
                                   ".5",
                                   "-.5",
                                   "9007199254740992",
                                   "9007199254740993",
                                   "0.1",
                                   "1e5",
                                   "1.5E-3",
                                   "123456789012345678",
                                   "0.0000000000000000001",
                                   "00000000000000000000000.25"};
    for (int k = 0; k < 200000; ++k) {
        char text[64];
        const int decimals = static_cast<int>(engine() % 21);
        std::snprintf(
            text, sizeof text, "%.*f", decimals,
            std::ldexp(static_cast<double>(engine() >> 11), -static_cast<int>(engine() % 70)) *
                (engine() % 2 ? 1 : -1));
        texts.emplace_back(text);
    }
    for (const std::string& text : texts) {
        std::string_view rest = text;
        double value = 0;
        ASSERT_TRUE(takeNumber(rest, value)) << text;
        EXPECT_TRUE(rest.empty()) << text;
        EXPECT_EQ(std::bit_cast<std::uint64_t>(value),
                  std::bit_cast<std::uint64_t>(std::strtod(text.c_str(), nullptr)))
            << text;
    }
    for (std::string_view none : {"", "-", ".", "-.", "x", "+-1"}) {
        double value = 0;
        EXPECT_FALSE(takeNumber(none, value)) << none;
    }
}

TEST(TextNumbers, linesEndInAnyWay) {
    TextReader reader("1\r\n2\n\n3\r4\r\r5", "f");
    std::string lines;
    while (reader.next()) lines += std::string(reader.line()) + "|";
    EXPECT_EQ(lines, "1|2||3|4||5|");
    EXPECT_EQ(reader.lineNumber(), 7u);
}

const std::string cornellText =
    "# Cornell\r\n\r\n# num wls\r\n3\r\n# wls\r\n400 550\r\n700\r\n\r\n"
    "0.5 0 0.25 3.14159265358979 0.1 0.2 0.3\r\n"
    "0.5 0.1 1.25 -0.5 1 2 3";

TEST(Cornell, rowsAndWavelengthsAreRead) {
    const Samples samples = readCornell(cornellText, "f");
    ASSERT_EQ(samples.size(), 2u);
    EXPECT_EQ(samples.channels.wavelengths, (std::vector<double>{400, 550, 700}));
    EXPECT_EQ(samples.values, (std::vector<double>{0.1, 0.2, 0.3, 1, 2, 3}));
    expectNear(samples.wo[0], {-std::sin(0.25), 0, std::cos(0.25)});
    expectNear(samples.wi[1], directionFromAngles(0.5, 0.1));
}

const std::string astmText =
    "LAB_NAME Somewhere\r\nSAMPLE_NAME \"paint\"\r\nNUM_POINTS 2\r\n"
    "VARS theta_i,phi_i,theta_s,phi_s,Red,Green,Blue\r\n"
    "0.5,0,0.25,3.1,0.1,0.2,0.3\r\n0.5,0.1,-1.25,-0.5,1,2,3\r\n";

TEST(Astm, rowsAreRead) {
    const Samples samples = readAstm(astmText, "f");
    ASSERT_EQ(samples.size(), 2u);
    EXPECT_EQ(samples.channels.kind, Channels::Kind::rgb);
    expectNear(samples.wo[1], directionFromAngles(1.25, pi - 0.5));
    const Samples spectral = readAstm("VARS theta_s, theta_i, 400nm, 500 nm\n0.2,0.1,7,8\n", "f");
    EXPECT_EQ(spectral.channels.wavelengths, (std::vector<double>{400, 500}));
    expectNear(spectral.wi[0], directionFromAngles(0.1, 0));
    const Samples inDegrees =
        readAstm("VARS theta_i,phi_i,theta_s,phi_s,BRDF\n30,0,60,180,2\n", "f", true);
    expectNear(inDegrees.wo[0], directionFromAngles(pi / 3, pi));
    EXPECT_EQ(inDegrees.channels.kind, Channels::Kind::grey);
}

std::string nistRow(const std::string& start) {
    std::string row = start;
    for (int k = 0; k < 15; ++k) row += ",0.01";
    return row + "\n";
}

const std::string nistNames = "lambda,thetai,phi,thetar,phir,f_r11\n";

TEST(Nist, wavelengthsBecomeChannelsAndIncompletePairsAreLeftOut) {
    const Samples samples =
        readNist(nistNames + nistRow("0.633,-30,0,45,10,0.3") + nistRow("0.532,-30,0,45,10,0.25") +
                     nistRow("0.532,-30,0,50,10,0.7"),
                 "f");
    ASSERT_EQ(samples.size(), 1u);
    EXPECT_EQ(samples.channels.wavelengths, (std::vector<double>{532, 633}));
    EXPECT_EQ(samples.values, (std::vector<double>{0.25, 0.3}));
    expectNear(samples.wi[0], {-0.5, 0, std::sqrt(0.75)});
    ASSERT_EQ(samples.leftOut.size(), 1u);
    EXPECT_EQ(samples.leftOut[0].substr(0, 2), "1 ");
}

/// Every parametrisation against the definition of its coordinates, computed from the directions
/// that the reader found.
TEST(Alta, parametrisationsMeanWhatTheySay) {
    struct Case {
        const char* name;
        std::vector<double> x;
        std::function<std::vector<double>(const Direction& v, const Direction& l)> coordinates;
    };
    const auto half = [](const Direction& v, const Direction& l) {
        const double x = v.x + l.x, y = v.y + l.y, z = v.z + l.z;
        const double size = std::sqrt(x * x + y * y + z * z);
        return Direction{x / size, y / size, z / size};
    };
    const auto thetaD = [=](const Direction& v, const Direction& l) {
        return std::acos(dot(half(v, l), v));
    };
    const auto between = [](const Direction& a, const Direction& b) {
        return azimuth(a) - azimuth(b);
    };
    const auto back = [](const Direction& v, const Direction& l) {
        const double x = v.x - l.x, y = v.y - l.y, z = v.z + l.z;
        const double size = std::sqrt(x * x + y * y + z * z);
        return Direction{x / size, y / size, z / size};
    };
    using D = const Direction&;
    const std::vector<Case> cases{
        {"COS_TH", {0.8}, [=](D v, D l) { return std::vector{half(v, l).z}; }},
        {"COS_TLV", {-0.3}, [](D v, D l) { return std::vector{dot(v, l)}; }},
        {"COS_TLR", {0.4}, [](D v, D l) { return std::vector{dot(v, mirrored(l))}; }},
        {"COS_TK", {0.7}, [=](D v, D l) { return std::vector{back(v, l).z}; }},
        {"COS_TH_TD",
         {0.8, 0.9},
         [=](D v, D l) {
             return std::vector{half(v, l).z, std::cos(thetaD(v, l))};
         }},
        {"RUSIN_TH_TD",
         {0.4, 0.3},
         [=](D v, D l) {
             return std::vector{polarAngle(half(v, l)), thetaD(v, l)};
         }},
        {"RUSIN_TH_PH_TD",
         {0.4, 1.0, 0.3},
         [=](D v, D l) {
             return std::vector{polarAngle(half(v, l)), azimuth(half(v, l)), thetaD(v, l)};
         }},
        {"RUSIN_TH_TD_PD",
         {0.4, 0.3, 0.7},
         [=](D v, D l) {
             // phi_d is the angle about h from the plane of h and the normal, measured so that
             // the view at phi_d = 0 is tilted further away from the normal.
             const Direction h = half(v, l);
             const Direction t{h.z * h.x / std::hypot(h.x, h.y), h.z * h.y / std::hypot(h.x, h.y),
                               -std::hypot(h.x, h.y)};
             const Direction b{-h.y / std::hypot(h.x, h.y), h.x / std::hypot(h.x, h.y), 0};
             return std::vector{polarAngle(h), thetaD(v, l), std::atan2(dot(v, b), dot(v, t))};
         }},
        {"RUSIN_VH",
         {0.6, 0, 0.8},
         [=](D v, D l) {
             return std::vector{half(v, l).x, half(v, l).y, half(v, l).z};
         }},
        {"SCHLICK_VK",
         {0.6, 0, 0.8},
         [=](D v, D l) {
             return std::vector{back(v, l).x, back(v, l).y, back(v, l).z};
         }},
        {"SCHLICK_TL_TK_PROJ_DPHI",
         {0.5, 0.2, 0.1},
         [=](D v, D l) {
             // K here is the half vector of the view and the mirrored light.
             const Direction k = back(v, l);
             const double phi = azimuth(k) - azimuth(l), theta = polarAngle(k);
             return std::vector{polarAngle(l), theta * std::cos(phi), theta * std::sin(phi)};
         }},
        {"RETRO_TL_TVL_PROJ_DPHI",
         {0.5, 0.2, 0.1},
         [=](D v, D l) {
             const double apart = std::acos(dot(v, l));
             // The spherical triangle of the normal, L and V.
             const double c =
                 (v.z - l.z * std::cos(apart)) / (std::sin(polarAngle(l)) * std::sin(apart));
             const double s = std::sin(between(v, l)) * std::sin(polarAngle(v)) / std::sin(apart);
             return std::vector{polarAngle(l), apart * c, apart * s};
         }},
        {"STEREOGRAPHIC",
         {0.3, 0.1, -0.2, 0.4},
         [](D v, D l) {
             return std::vector{v.x / (1 + v.z), v.y / (1 + v.z), l.x / (1 + l.z), l.y / (1 + l.z)};
         }},
        {"SPHERICAL_TL_PL_TV_PV",
         {0.3, 0.1, 0.2, 2.4},
         [](D v, D l) {
             return std::vector{polarAngle(l), azimuth(l), polarAngle(v), azimuth(v)};
         }},
        {"ISOTROPIC_TV_TL_DPHI",
         {0.3, 0.8, 0.6},
         [=](D v, D l) {
             return std::vector{polarAngle(v), polarAngle(l), between(v, l)};
         }},
        {"ISOTROPIC_TL_TV_PROJ_DPHI",
         {0.3, 0.4, 0.6},
         [=](D v, D l) {
             return std::vector{polarAngle(l), polarAngle(v) * std::cos(between(v, l)),
                                polarAngle(v) * std::sin(between(v, l))};
         }},
        {"STARK_3D",
         {0.3, 0.4, 0.6},
         [](D v, D l) {
             const Direction b{(l.x - v.x) / 2, (l.y - v.y) / 2, (l.z - v.z) / 2};
             const Direction h{(l.x + v.x) / 2, (l.y + v.y) / 2, 0};
             return std::vector{std::hypot(h.x, h.y), std::sqrt(dot(b, b)),
                                std::atan2(b.y, b.x) - std::atan2(h.y, h.x)};
         }},
        {"STARK_2D",
         {0.3, 0.4},
         [](D v, D l) {
             const Direction b{(l.x - v.x) / 2, (l.y - v.y) / 2, (l.z - v.z) / 2};
             return std::vector{std::hypot(l.x + v.x, l.y + v.y) / 2, std::sqrt(dot(b, b))};
         }},
        {"NEUMANN_3D",
         {0.3, 0.4, 0.6},
         [](D v, D l) {
             // ALTA's core adds B to the view.
             return std::vector{std::hypot(l.x + v.x, l.y + v.y) / 2,
                                std::hypot(l.x - v.x, l.y - v.y) / 2,
                                std::atan2(v.y - l.y, v.x - l.x)};
         }},
        {"NEUMANN_2D",
         {0.3, 0.4},
         [](D v, D l) {
             return std::vector{std::hypot(l.x + v.x, l.y + v.y) / 2,
                                std::hypot(l.x - v.x, l.y - v.y) / 2};
         }},
        {"CARTESIAN",
         {0.6, 0, 0.8, 0, 0.28, 0.96},
         [](D v, D l) { return std::vector{v.x, v.y, v.z, l.x, l.y, l.z}; }},
    };
    for (const Case& c : cases) {
        const AltaParameters* parameters = altaParameters(c.name);
        ASSERT_TRUE(parameters) << c.name;
        ASSERT_EQ(parameters->count, c.x.size()) << c.name;
        Direction wi, wo;
        altaDirections(*parameters, c.x.data(), {"f", "line", 1}, wi, wo);
        EXPECT_NEAR(dot(wi, wi), 1, 1e-12) << c.name;
        EXPECT_NEAR(dot(wo, wo), 1, 1e-12) << c.name;
        EXPECT_GT(wi.z, 0) << c.name;
        EXPECT_GT(wo.z, 0) << c.name;
        const std::vector<double> found = c.coordinates(wo, wi);
        for (std::size_t k = 0; k < c.x.size(); ++k) EXPECT_NEAR(found[k], c.x[k], 1e-9) << c.name;
    }
}

std::string altaStream(bool big, std::size_t announced) {
    std::string text =
        "#DIM 4 1\n#PARAM_IN SPHERICAL_TL_PL_TV_PV\n#PARAM_OUT INV_STERADIAN\n"
        "#FORMAT binary\n#VERSION 0\n#PRECISION ieee754-double\n#SAMPLE_COUNT " +
        std::to_string(announced) + "\n#ENDIAN " + (big ? "big" : "little") + "\n#BEGIN_STREAM\n";
    for (const double value : {0.1, 0.2, 0.3, 0.4, 5.0, 0.2, 0.3, 0.4, 0.5, 6.0}) {
        std::string bytes(8, '\0');
        std::memcpy(bytes.data(), &value, 8);
        if (big) std::reverse(bytes.begin(), bytes.end());
        text += bytes;
    }
    return text + "\n#END_STREAM\n";
}

TEST(Alta, binaryStreamsOfBothByteOrdersAreRead) {
    for (const bool big : {false, true}) {
        const Samples samples = readAlta(altaStream(big, 2), "f");
        ASSERT_EQ(samples.size(), 2u);
        EXPECT_EQ(samples.values, (std::vector<double>{5, 6}));
        expectNear(samples.wi[1], directionFromAngles(0.2, 0.3));
        expectNear(samples.wo[1], directionFromAngles(0.4, 0.5));
    }
}

TEST(Alta, segmentsCosinesAndColoursAreRead) {
    const Samples bounded = readAlta(
        "#DIM 4 1\n#VS 2\n#PARAM_IN SPHERICAL_TL_PL_TV_PV\n"
        "#PARAM_OUT INV_STERADIAN_COSINE_FACTOR\n0.1 0 0.3 0 2 1.5 2.5\n",
        "f");
    ASSERT_EQ(bounded.size(), 1u);
    EXPECT_NEAR(bounded.values[0], 2 / std::cos(0.3), 1e-14);
    EXPECT_EQ(bounded.leftOut.size(), 1u);
    const Samples white =
        readAlta("#DIM 1 3\n#PARAM_IN COS_TH\n#PARAM_OUT XYZ_COLOR\n0.5 0.9505 1 1.089\n", "f");
    for (const double channel : white.values) EXPECT_NEAR(channel, 1, 2e-4);  // D65
}

TEST(Alta, fittedFunctionsAreEvaluated) {
    const auto brdf = readAltaFunction(
        "#ALTA FUNC HEADER\n#DIM 6 1\n#PARAM_IN CARTESIAN\n#ALTA HEADER END\n\n"
        "#FUNC nonlinear_function_diffuse\nkd 0.25\n\n#FUNC nonlinear_function_blinn\nKs 2\nN 3\n",
        "f");
    const double thetaH = 0.4;
    const Direction h = directionFromAngles(thetaH, 1);
    EXPECT_NEAR(evaluate(*brdf, h, h)[0], 0.25 + 2 * std::pow(std::cos(thetaH), 3), 1e-14);
}

/// R_n^l by its explicit sum (Born & Wolf), and the sum of the terms as the paper prints it.
double explicitRadial(int n, int l, double r) {
    double sum = 0;
    for (int s = 0; s <= (n - l) / 2; ++s) {
        sum += (s % 2 ? -1 : 1) * std::tgamma(n - s + 1) /
               (std::tgamma(s + 1) * std::tgamma((n + l) / 2 - s + 1) *
                std::tgamma((n - l) / 2 - s + 1)) *
               std::pow(r, n - 2 * s);
    }
    return sum;
}

TEST(Scatmech, evaluatesItsTerms) {
    struct Row {
        int n, m, l, p;
        double a;
    };
    const std::vector<Row> rows{{0, 0, 0, 0, 3.0},  {2, 0, 0, 0, 0.4}, {2, 2, 0, 1, 0.3},
                                {3, 1, 1, 0, -0.2}, {8, 4, 2, 0, 0.1}, {7, 7, 5, 1, 0.05}};
    std::string text;
    for (const Row& r : rows) {
        text += "1, 1, " + std::to_string(r.n) + ", " + std::to_string(r.m) + ", " +
                std::to_string(r.l) + ", " + std::to_string(r.l) + ", " + std::to_string(r.p) +
                ", " + std::to_string(r.a) + "\n";
    }
    text += "2, 2, 0, 0, 0, 0, 0, 99\n";
    const auto brdf = readScatmech(text, "f", "f", {.wavelength = 700});
    const double ti = 0.6, to = 1.1, phi = 0.8;
    double expected = 0;
    const double ri = std::sqrt(2) * std::sin(ti / 2), ro = std::sqrt(2) * std::sin(to / 2);
    for (const Row& r : rows) {
        const double divisor = r.n == 0 || (r.n == r.m && r.l == 0) ? 4
                               : r.n == r.m || r.l == 0             ? 2
                                                                    : 1;
        expected += r.a * std::pow(0.7, r.p) * std::sqrt((r.n + 1) * (r.m + 1) / divisor) /
                    (2 * pi) * std::cos(r.l * phi) *
                    (explicitRadial(r.n, r.l, ri) * explicitRadial(r.m, r.l, ro) +
                     explicitRadial(r.m, r.l, ri) * explicitRadial(r.n, r.l, ro));
    }
    ASSERT_GT(expected, 0);
    EXPECT_NEAR(evaluate(*brdf, directionFromAngles(ti, 2), directionFromAngles(to, 2.8))[0],
                expected, 1e-13);
}

std::string shared(const std::string& name) {
    return test::sharedFolder() + "/data/" + name;
}

/// The rows of the measurement against the published expansion. SCATMECH documents a factor
/// r(lambda), "usually the diffuse reflectance": the table stands for unit reflectance, so that the
/// factor between both has to be the reflectance of sintered PTFE, and be one number for all pairs
/// of directions. The pages open to us print no residual: what is left is printed here, and bounded
/// by 2 %.
TEST(Scatmech, reproducesTheMeasuredRowsOfPtfe) {
    const std::string table = shared("nist_ptfe/PTFE.coeff.csv");
    const std::string rows = shared("nist_ptfe/PTFE.data.csv");
    SKIP_WITHOUT(table);
    const auto expansion = open(table), data = open(rows);
    const Direction up{0, 0, 1};
    for (const double albedo : directionalAlbedo(*expansion, up)) EXPECT_NEAR(albedo, 1, 0.01);
    const auto reflectance = directionalAlbedo(*data, up);
    const auto& samples = dynamic_cast<const Scattered&>(*data).samples();
    ASSERT_EQ(expansion->channels().wavelengths, samples.channels.wavelengths);
    for (std::size_t c = 0; c < 4; ++c) {
        double sum = 0, squares = 0, worst = 0;
        for (std::size_t k = 0; k < samples.size(); ++k) {
            const double f = evaluate(*expansion, samples.wi[k], samples.wo[k])[c];
            const double relative = samples.values[4 * k + c] / (reflectance[c] * f) - 1;
            sum += relative;
            squares += relative * relative;
            worst = std::max(worst, std::fabs(relative));
        }
        const auto count = static_cast<double>(samples.size());
        std::printf(
            "%.0f nm: reflectance %.4f; rows over table times it: mean %+.4f, root mean square "
            "%.4f, greatest %.4f\n",
            samples.channels.wavelengths[c], reflectance[c], sum / count,
            std::sqrt(squares / count), worst);
        EXPECT_NEAR(sum / count, 0, 0.01);
        EXPECT_LT(std::sqrt(squares / count), 0.02);
    }
}

TEST(Shared, filesLoadAndGiveTheirSamplesBack) {
    const std::vector<std::pair<std::string, std::size_t>> files{
        {"alta/retro-gray-tape.dat", 7405}, {"alta/pink-felt-1d.alta", 90},
        {"cornell/cayman.brdf", 1439},      {"cornell/garnet_red.brdf", 1439},
        {"cornell/mystique.brdf", 1439},    {"nist_ptfe/PTFE.data.csv", 1824}};
    SKIP_WITHOUT(shared(files[0].first));
    for (const auto& [name, count] : files) {
        const auto brdf = open(shared(name));
        const auto* scattered = dynamic_cast<const Scattered*>(brdf.get());
        ASSERT_TRUE(scattered) << name;
        const Samples& samples = scattered->samples();
        EXPECT_EQ(samples.size(), count) << name;
        const std::size_t channels = samples.channels.count();
        // If several samples are images of each other, the mean is returned, so that the
        // comparison is of most samples, and the rest is the file's own defect of reciprocity.
        double missed = 0, total = 0;
        for (std::size_t k = 0; k < samples.size(); ++k) {
            if (!(samples.wi[k].z > 0) || !(samples.wo[k].z > 1e-9)) continue;
            const auto f = evaluate(*brdf, samples.wi[k], samples.wo[k]);
            for (std::size_t c = 0; c < channels; ++c) {
                const double expected = std::max(0.0, samples.values[k * channels + c]);
                missed += (f[c] - expected) * (f[c] - expected);
                total += expected * expected;
            }
        }
        std::printf("%s: %.2e between samples and f at them\n", name.c_str(),
                    std::sqrt(missed / total));
        EXPECT_LT(std::sqrt(missed / total), 0.05) << name;
    }
}

TEST(Shared, functionsOfAltaLoadOrSayWhyNot) {
    const std::string fit = shared("alta/nonlinear-example-01.brdf");
    SKIP_WITHOUT(fit);
    const auto brdf = open(fit);
    // kd + Ks at the normal, as the file lists them.
    const auto f = evaluate(*brdf, {0, 0, 1}, {0, 0, 1});
    EXPECT_NEAR(f[0], 0.001372370561 + 0.1285394675, 1e-12);
    EXPECT_NEAR(f[2], 0.002848470952 + 0.3648163434, 1e-12);
    test::expectInputError([&] { open(shared("alta/Kirby2.brdf")); },
                           {"UNKNOWN_INPUT", "input=COS_TH"});
}

TEST(Shared, theFormatIsToldByTheContent) {
    const std::vector<std::pair<std::string, std::string>> texts{
        {cornellText, "cornell"},
        {astmText, "astm"},
        {nistNames + nistRow("0.633,-30,0,45,10,0.3"), "nist"},
        {"1, 1, 0, 0, 0, 0, 0, 2\n", "scatmech"},
        {altaStream(false, 2), "alta"}};
    for (const auto& [text, name] : texts) {
        const TemporaryFile file(text, ".txt");
        const auto brdf = open(file.path());
        const auto facts = brdf->facts();
        ASSERT_FALSE(facts.empty());
        EXPECT_EQ(std::get<std::string>(facts[0].second), name);
    }
}

}  // namespace
}  // namespace hshfit::brdfs
