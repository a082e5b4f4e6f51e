// The sky of Hosek and Wilkie: tables made here, in the layout of the authors' files, for which the
// model has closed forms; and files that are refused.
#include "hosek_wilkie_file.h"
#include "temporary_file.h"
#include "temporary_folder.h"

#include <hshfit/error.h>
#include <hshfit/light/catalog.h>
#include <hshfit/light/internal/hosek_wilkie_sky.h>
#include <hshfit/light/light_samples.h>
#include <hshfit/light/sky.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <string>

namespace hshfit {
namespace {

using test::hosekWilkieFile;
using test::HosekWilkiePlace;
using test::HosekWilkieValue;
using test::plainHosekWilkie;

constexpr double unit = 0.683;  // 1 W/m^2/sr in 1000 cd/m^2

Direction sunAt(double elevation) {
    return directionFromAngles(radians(90 - elevation), 0.7);
}

SkyLight skyOf(const std::string& space, const HosekWilkieValue& value, double turbidity,
               double albedo, double elevation) {
    return hosekWilkieSky(hosekWilkieTablesIn(hosekWilkieFile(space, value), "made"), "made",
                          turbidity, albedo, sunAt(elevation));
}

/// Nine coefficients in the order A B C D E F G I H, and a radiance of 1.
HosekWilkieValue constant(const std::array<double, 9>& values) {
    return [values](const HosekWilkiePlace& place) {
        return place.coefficient == 9 ? 1 : values[static_cast<std::size_t>(place.coefficient)];
    };
}

/// The formula as the paper prints it (equations 8 and 9), with its letters.
double printed(const std::array<double, 9>& x, double theta, double gamma) {
    const auto [A, B, C, D, E, F, G, I, H] = x;
    const double chi =
        (1 + std::pow(std::cos(gamma), 2)) / std::pow(1 + H * H - 2 * H * std::cos(gamma), 3.0 / 2);
    return (1 + A * std::exp(B / (std::cos(theta) + 0.01))) *
           (C + D * std::exp(E * gamma) + F * std::pow(std::cos(gamma), 2) + G * chi +
            I * std::sqrt(std::cos(theta)));
}

constexpr std::array<double, 9> typical{-1.1, -0.2, 1, 2, -2, 0.5, 0.1, 1, 0.7};

/// Sum over rings of equal steps of the root of the height; independent of the quadrature of skies.
double horizontalIrradiance(const SkyLight& sky) {
    double sum = 0;
    constexpr int rings = 900, azimuths = 1440;
    for (int r = 0; r < rings; ++r) {
        const double u = (r + 0.5) / rings, z = u * u;
        double ring = 0;
        for (int j = 0; j < azimuths; ++j)
            ring += radianceOf(sky,
                               directionFromAngles(std::acos(z), 2 * pi * (j + 0.5) / azimuths))[1];
        sum += z * 2 * u * ring;
    }
    return sum * 2 * pi / rings / azimuths;
}

TEST(HosekWilkieSky, ConstantTablesGiveTheFormulaAsPrinted) {
    const double elevation = 35;
    const Direction sun = sunAt(elevation);
    const SkyLight sky = skyOf("RGB", plainHosekWilkie, 4.3, 0.4, elevation);
    for (int t = 0; t <= 9; ++t) {
        for (int p = 0; p < 12; ++p) {
            const double theta = radians(9.999 * t);
            const Direction d = directionFromAngles(theta, radians(30 * p));
            const double gamma = std::acos(std::clamp(dot(d, sun), -1.0, 1.0));
            const Rgb found = radianceOf(sky, d);
            for (std::size_t c = 0; c < 3; ++c) {
                const double expected =
                    unit * (10 + 2 * static_cast<double>(c)) * printed(typical, theta, gamma);
                EXPECT_NEAR(found[c], expected, 1e-9 * expected);
            }
        }
    }
    EXPECT_EQ(radianceOf(sky, {0.6, 0, -0.8}), Rgb{});
    // At the horizon cos(theta) is 0, where the root has its steepest slope.
    EXPECT_NEAR(radianceOf(sky, {-std::sin(0.7), std::cos(0.7), 0})[0],
                unit * 10 * printed(typical, pi / 2, pi / 2), 1e-6);
}

/// Each number between the tables of albedos 0 and 1 and of whole turbidities is on a line.
TEST(HosekWilkieSky, AlbedoAndTurbidityAreInterpolatedLinearly) {
    const auto value = [](const HosekWilkiePlace& p) {
        if (p.coefficient == 9) return 2 + 3.0 * p.albedo + 0.5 * p.turbidity + p.channel;
        if (p.coefficient == 2) return 1 + 0.7 * p.albedo + 0.2 * p.turbidity * p.turbidity;
        return p.coefficient == 1 ? -0.2 : 0.0;
    };
    for (const double turbidity : {1.0, 1.25, 5.0, 9.5, 10.0}) {
        for (const double albedo : {0.0, 0.3, 1.0}) {
            const double low = std::floor(turbidity), t = turbidity - low;
            const double square = (1 - t) * low * low + t * (low + 1) * (low + 1);
            const Rgb found = radianceOf(skyOf("RGB", value, turbidity, albedo, 50), {0, 0, 1});
            for (std::size_t c = 0; c < 3; ++c)
                EXPECT_NEAR(found[c],
                            unit * (2 + 3 * albedo + 0.5 * turbidity + static_cast<double>(c)) *
                                (1 + 0.7 * albedo + 0.2 * square),
                            1e-9)
                    << turbidity << ' ' << albedo;
        }
    }
}

/// The control points of the polynomial sum of a_k t^k, k = 0 to 5, are the sums of
/// a_k binomial(i, k) / binomial(5, k); t is the cube root of the elevation over 90 degrees.
TEST(HosekWilkieSky, ElevationRunsThroughABezierCurveOfItsCubeRoot) {
    constexpr double a[] = {2, -1, 3, 0.5, -0.25, 4};
    const auto binomial = [](int n, int k) {
        double result = 1;
        for (int j = 1; j <= k; ++j) result = result * (n - j + 1) / j;
        return result;
    };
    const auto value = [&](const HosekWilkiePlace& p) {
        if (p.coefficient == 2) return 1.0;
        if (p.coefficient != 9) return 0.0;
        double control = 0;
        for (int k = 0; k <= p.point; ++k) control += a[k] * binomial(p.point, k) / binomial(5, k);
        return control;
    };
    for (const double elevation : {0.0, 0.5, 7.0, 30.0, 61.0, 90.0}) {
        const double t = std::cbrt(elevation / 90);
        double expected = 0;
        for (int k = 5; k >= 0; --k) expected = expected * t + a[k];
        EXPECT_NEAR(radianceOf(skyOf("RGB", value, 3, 0, elevation), {0.6, 0, 0.8})[1],
                    unit * expected, 1e-9)
            << elevation;
    }
}

/// The irradiance of each term in closed form, then of all of it by a sum over the sky.
TEST(HosekWilkieSky, IrradianceIsThatOfTheClosedForm) {
    const auto irradiance = [](const std::array<double, 9>& x, double elevation) {
        return skyIrradiance(skyOf("RGB", constant(x), 2, 0, elevation))[0] / unit;
    };
    EXPECT_NEAR(irradiance({0, -1, 1, 0, 0, 0, 0, 0, 0}, 40), pi, 1e-6);
    EXPECT_NEAR(irradiance({0, -1, 0, 0, 0, 0, 0, 1, 0}, 40), 4 * pi / 5, 2e-6);
    for (const double elevation : {90.0, 40.0, 3.0}) {
        const double z = std::sin(radians(elevation));
        EXPECT_NEAR(irradiance({0, -1, 0, 0, 0, 1, 0, 0, 0}, elevation), pi / 4 * (1 + z * z),
                    2e-6);
    }
    const double e = -3;
    EXPECT_NEAR(irradiance({0, -1, 0, 1, e, 0, 0, 0, 0}, 90),
                2 * pi * (1 + std::exp(e * pi / 2)) / (e * e + 4), 2e-6);
    for (const double elevation : {0.5, 20.0, 75.0}) {
        const SkyLight sky = skyOf("RGB", constant(typical), 3, 0, elevation);
        EXPECT_NEAR(skyIrradiance(sky)[1], horizontalIrradiance(sky),
                    2e-5 * horizontalIrradiance(sky))
            << elevation;
    }
}

/// XYZ of the white of Rec. 709 is grey, and each of X, Y, Z the column of the matrix that IEC
/// 61966-2-1 prints.
TEST(HosekWilkieSky, XyzBecomesLinearRec709) {
    const auto with = [](const Rgb& xyz) {
        return radianceOf(skyOf(
                              "XYZ",
                              [&](const HosekWilkiePlace& p) {
                                  if (p.coefficient == 9)
                                      return xyz[static_cast<std::size_t>(p.channel)];
                                  return p.coefficient == 2 ? 1.0 : 0.0;
                              },
                              3, 0, 30),
                          {0, 0, 1});
    };
    for (const double value : with({0.9505, 1, 1.0890})) EXPECT_NEAR(value, unit, 3e-4);
    const Rgb blue = with({0.5, 1, 2});
    EXPECT_NEAR(blue[1], unit * (-0.9689 * 0.5 + 1.8758 + 0.0415 * 2), 1e-3);
    EXPECT_NEAR(blue[2], unit * (0.0557 * 0.5 - 0.2040 + 1.0570 * 2), 1e-3);
    EXPECT_EQ(blue[0], 0) << "3.2406 X - 1.5372 Y - 0.4986 Z is below 0";
}

/// Luminance by the published integral of ybar, 106.857 nm, and by its published values every 10 nm
/// (CIE 15, table T.4) for the part that is linear from 520 to 560 and to 600 nm.
TEST(HosekWilkieSky, WavelengthsBecomeColourByTheCurvesOfTheCie) {
    const auto with = [](double at560) {
        const auto value = [=](const HosekWilkiePlace& p) {
            if (p.coefficient == 9) return p.channel == 6 ? at560 : 1.0;
            return p.coefficient == 2 ? 1.0 : 0.0;
        };
        return radianceOf(skyOf("", value, 3, 0, 30), {0, 0, 1});
    };
    const Rgb equal = with(1);
    EXPECT_NEAR(luminanceOf(equal), unit * 106.857, 0.02);
    // Back to XYZ by the matrix that IEC 61966-2-1 prints: equal energy has X = Y = Z.
    const double cieX = 0.4124 * equal[0] + 0.3576 * equal[1] + 0.1805 * equal[2];
    const double cieZ = 0.0193 * equal[0] + 0.1192 * equal[1] + 0.9505 * equal[2];
    EXPECT_NEAR(cieX, unit * 106.865, 0.05);
    EXPECT_NEAR(cieZ, unit * 106.892, 0.05);
    const double triangle = 10 * (0.25 * 0.862 + 0.5 * 0.954 + 0.75 * 0.99495 + 0.995 +
                                  0.75 * 0.952 + 0.5 * 0.87 + 0.25 * 0.757);
    EXPECT_NEAR(luminanceOf(equal) - luminanceOf(with(0.5)), unit * 0.5 * triangle, 0.05);
}

TEST(HosekWilkieSky, RadianceAndIrradianceScaleItsColour) {
    const test::TemporaryFolder folder;
    const std::string data = (folder.path() / "sky.h").string();
    std::ofstream(data) << hosekWilkieFile("XYZ", [](const HosekWilkiePlace& p) {
        return plainHosekWilkie(p) * (p.coefficient == 9 && p.channel == 2 ? 1.2 : 1);
    });
    const std::string spec = "hosek-wilkie:data=" + data + ",elevation=40,albedo=0.3";
    const auto plain = std::get<SkyLight>(parseLights(spec).lights[0]);
    const Rgb zenith = radianceOf(plain, {0, 0, 1});
    const auto scaled = std::get<SkyLight>(parseLights(spec + ",radiance=3").lights[0]);
    EXPECT_NEAR(luminanceOf(radianceOf(scaled, {0, 0, 1})), 3, 1e-12);
    EXPECT_NEAR(radianceOf(scaled, {0, 0, 1})[2] / zenith[2], 3 / luminanceOf(zenith), 1e-12);
    const auto lit = std::get<SkyLight>(parseLights(spec + ",irradiance=2,ground=1/2/3").lights[0]);
    EXPECT_NEAR(luminanceOf(skyIrradiance(lit)), 2, 1e-5);
    EXPECT_EQ(radianceOf(lit, {0, 0, -1}), (Rgb{1, 2, 3}));
    // A relative path is seen from the folder of the scene.
    EXPECT_NO_THROW(parseLights("hosek-wilkie:data=sky.h,elevation=40", folder.path().string()));
}

TEST(HosekWilkieSky, KeysOutOfRangeAreRefused) {
    const test::TemporaryFolder folder;
    std::ofstream(folder.path() / "sky.h") << hosekWilkieFile("RGB", plainHosekWilkie);
    std::ofstream(folder.path() / "other.h") << "int main() { return 0; }\n";
    const auto messageOf = [&](const std::string& keys) -> std::string {
        try {
            parseLights("hosek-wilkie:" + keys, folder.path().string());
        } catch (const Error& error) {
            return fmt::format("{} {}", static_cast<int>(error.code()), error.what());
        }
        return "no error";
    };
    for (const auto& [keys, code, words] :
         {std::tuple("data=sky.h,elevation=40,turbidity=0.9", '2', "1 to 10"),
          {"data=sky.h,elevation=40,turbidity=10.1", '2', "1 to 10"},
          {"data=sky.h,elevation=-0.1", '2', "0 to 90"},
          {"data=sky.h,elevation=90.1", '2', "0 to 90"},
          {"data=sky.h,elevation=40,albedo=1.01", '2', "0 to 1"},
          {"data=sky.h,elevation=40,albedo=-0.1", '2', "0 to 1"},
          {"data=sky.h", '2', "elevation has to be given"},
          {"elevation=40", '2', "data has to be given"},
          {"data=sky.h,elevation=40,radiance=1,irradiance=1", '2', "one of the two"},
          {"data=none.h,elevation=40", '3', "none.h"},
          {"data=other.h,elevation=40", '3', "no tables of the Hosek-Wilkie sky"}}) {
        const std::string message = messageOf(keys);
        EXPECT_EQ(message[0], code) << message;
        EXPECT_NE(message.find(words), std::string::npos) << keys << ": " << message;
    }
}

std::string refusal(const std::string& text) {
    try {
        hosekWilkieTablesIn(text, "made.h");
    } catch (const InputError& error) {
        return error.what();
    }
    return "no error";
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
}

TEST(HosekWilkieTables, FilesOfTheAuthorsLayoutAreRead) {
    const std::string rgb = hosekWilkieFile("RGB", plainHosekWilkie);
    const auto tables = hosekWilkieTablesIn(rgb, "made");
    ASSERT_EQ(tables.channels.size(), 3U);
    EXPECT_EQ(tables.channels[2].radiance, std::vector<double>(120, 14));
    EXPECT_EQ(tables.channels[0].shape.size(), 1080U);
    EXPECT_EQ(hosekWilkieTablesIn(hosekWilkieFile("", plainHosekWilkie), "made").channels.size(),
              11U);
    // Line ends of DOS, qualifiers, sizes, other arrays, comments, tabs, exponents of three digits.
    std::string other =
        "#include <math.h>\r\nextern \"C\" {\nstatic const double sun[2][2] = {{1, "
        "2}, {x, y}}; // datasetRGB1[] = { 1 };\n" +
        rgb;
    other = replaced(other, "double datasetRGB1[]", "static const double datasetRGB1[2][10 * 54]");
    other = replaced(other, "\t-1.1000000000000001e+00,", " -1.1e+000 /* A */ , ");
    for (std::size_t at = other.find('\n'); at != std::string::npos; at = other.find('\n', at + 2))
        other.replace(at, 1, "\r\n");
    EXPECT_EQ(hosekWilkieTablesIn(other, "made").channels[0].shape, tables.channels[0].shape);
    // The last number may be without a comma behind it.
    const std::size_t end = rgb.find(",\n};");
    EXPECT_NO_THROW(hosekWilkieTablesIn(std::string(rgb).erase(end, 1), "made"));
}

TEST(HosekWilkieTables, WrongFilesAreRefusedInOneLine) {
    const std::string rgb = hosekWilkieFile("RGB", plainHosekWilkie);
    const std::string number = "\t-1.1000000000000001e+00,";
    const std::pair<std::string, const char*> cases[] = {
        {"", "has no tables"},
        {"just words", "has no tables"},
        {std::string("\x89PNG\r\n\x1a\n\0\0", 10), "has no tables"},
        {replaced(rgb, "datasetRGB2[]", "datasetRGB9[]"), "the array datasetRGB2 is missing"},
        {replaced(rgb, "datasetRGBRad3[]", "x[]"), "the array datasetRGBRad3 is missing"},
        {replaced(rgb, "datasetRGB2[]", "datasetRGB1[]"), "a second array datasetRGB1"},
        {rgb + hosekWilkieFile("XYZ", plainHosekWilkie), "the tables of one kind"},
        {rgb + "double datasetXYZ1[] = {1};", "datasetXYZ1 has 1 numbers; valid: 1080"},
        {replaced(rgb, number, ""), "datasetRGB1 has 1079 numbers; valid: 1080"},
        {replaced(rgb, number, number + number), "datasetRGB1 has 1081 numbers"},
        {replaced(rgb, "1.0000000000000000e+01,", ""),
         "datasetRGBRad1 has 119 numbers; valid: 120"},
        {replaced(rgb, number, "\tnan,"), "'nan' in the array datasetRGB1 is no finite number"},
        {replaced(rgb, number, "\t-inf,"), "'-inf'"},
        {replaced(rgb, number, "\t1e999,"), "'1e999'"},
        {replaced(rgb, number, "\t0x10,"), "'0x10'"},
        {replaced(rgb, number, "\t1.0f,"), "'1.0f'"},
        {replaced(rgb, number, "\t1.0"), "is in the place of a comma"},
        {replaced(rgb, number, "\t1.0,,"), "',' in the array"},
        {replaced(rgb, number, "\t{1.0},"), "'{' in the array"},
        {replaced(rgb, "*/", ""), "has no tables"},
        {replaced(rgb, number, "\t\x01\x1b[31m,"), "line 8: "},
    };
    for (const auto& [text, words] : cases) {
        const std::string message = refusal(text);
        EXPECT_NE(message.find(words), std::string::npos) << words << ": " << message;
        EXPECT_TRUE(message.starts_with("made.h")) << message;
        EXPECT_EQ(message.find_first_of("\n\x1b"), std::string::npos);
    }
}

/// A file is refused wherever it breaks off.
TEST(HosekWilkieTables, TruncatedFilesAreRefused) {
    const std::string rgb = hosekWilkieFile("RGB", plainHosekWilkie);
    const std::size_t last = rgb.rfind("};", rgb.find("double* datasetsRGB"));
    for (std::size_t size = 0; size <= last; size += 997)
        EXPECT_NE(refusal(rgb.substr(0, size)), "no error") << size;
    EXPECT_NE(refusal(rgb.substr(0, last)), "no error");
    EXPECT_EQ(refusal(rgb.substr(0, last + 2)), "no error");
    EXPECT_NE(refusal(rgb.substr(0, rgb.size() / 2)).find("the file ends within the array dataset"),
              std::string::npos);
}

/// Finite numbers may still give infinite radiance: at the horizon, or where H is 1 at the sun.
TEST(HosekWilkieTables, TablesWithoutAFiniteSkyAreRefused) {
    for (const std::pair<int, double>& changed :
         {std::pair(1, 30.0), {8, 1.0}, {8, -1.0}, {4, 400.0}, {2, 1e200}, {9, 1e12}}) {
        const auto table = [&](const HosekWilkiePlace& p) {
            return p.coefficient == changed.first ? changed.second : plainHosekWilkie(p);
        };
        EXPECT_THROW(skyOf("RGB", table, 3, 0, 40), InputError) << changed.first;
    }
}

}  // namespace
}  // namespace hshfit
