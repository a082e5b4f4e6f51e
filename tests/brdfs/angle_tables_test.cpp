// Formats of tables: f on and between their entries. The values of the files are multilinear in the
// angles of the tables, so that interpolation as the formats define it returns the formula itself.

#include <brdfs/catalog.h>
#include <brdfs/measured/scattered/scattered.h>
#include <brdfs/measured/scattered/speos.h>
#include <brdfs/measured_files.h>
#include <brdfs/sample_checks.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

namespace hshfit::brdfs {
namespace {

using test::atDegrees;
using test::TemporaryFile;
using List = std::vector<double>;

List steps(double from, double to, double step) {
    List list;
    for (double x = from; x < to + step / 2; x += step) list.push_back(x);
    return list;
}

/// A Zemax file of value(incidence, azimuth, radius), angles in degrees.
std::string zemax(const std::function<double(double, double, double)>& value) {
    const List incidences{10, 30, 50}, azimuths = steps(0, 180, 20), radii = steps(0, 60, 10);
    std::string text = fmt::format(
        "Symmetry PlaneSymmetrical\nSpectralContent Monochrome\nScatterType BRDF\n"
        "SampleRotation 1\n0\nAngleOfIncidence {}\n{}\nScatterAzimuth {}\n{}\nScatterRadial {}\n"
        "{}\nMonochrome\nDataBegin\n",
        incidences.size(), fmt::join(incidences, " "), azimuths.size(), fmt::join(azimuths, " "),
        radii.size(), fmt::join(radii, " "));
    for (const double incidence : incidences) {
        text += "TIS 0.1\n";
        for (const double azimuth : azimuths) {
            for (const double radius : radii)
                text += fmt::format("{} ", value(incidence, azimuth, radius));
            text += "\n";
        }
    }
    return text + "DataEnd\n";
}

/// The direction at a radius from the mirror direction, in degrees; azimuth 0 is towards the
/// normal, the incidence is in the plane y = 0 with the light at -x.
Direction about(double incidence, double azimuth, double radius) {
    const double t = radians(incidence), a = radians(azimuth), r = radians(radius);
    const Direction s = atDegrees(incidence, 0), e{-std::cos(t), 0, std::sin(t)};
    return {s.x * std::cos(r) + e.x * std::sin(r) * std::cos(a), -std::sin(r) * std::sin(a),
            s.z * std::cos(r) + e.z * std::sin(r) * std::cos(a)};
}

TEST(AngleTables, ZemaxIsLinearInIncidenceAzimuthAndRadius) {
    const auto value = [](double i, double a, double r) {
        return 0.5 + 0.01 * i + r * (0.002 * a - 0.003 + 1e-4 * i);
    };
    const TemporaryFile file(zemax(value), ".bsdf");
    const auto brdf = open(file.path());
    for (const double incidence : {10.0, 13.0, 20.0, 30.0, 42.5})
        for (const double azimuth : {0.0, 7.0, 50.0, 100.0, 171.0, -33.0})
            for (const double radius : {0.0, 4.0, 10.0, 17.0, 30.0}) {
                const Direction wo = about(incidence, azimuth, radius);
                EXPECT_NEAR(evaluate(*brdf, atDegrees(incidence, 180), wo)[0],
                            value(incidence, std::fabs(azimuth), radius), 1e-9)
                    << incidence << ", " << azimuth << ", " << radius;
            }
}

/// The star and the diamond of highlights between the incidences of a table.
TEST(AngleTables, HighlightsAreRoundBetweenIncidences) {
    const auto value = [](double, double, double r) { return std::exp(-r / 10); };
    const TemporaryFile file(zemax(value), ".bsdf");
    const auto brdf = open(file.path());
    for (const double incidence : {20.0, 40.0})
        for (const double radius : {5.0, 15.0, 25.0}) {
            List ring;
            for (double azimuth = 0; azimuth < 360; azimuth += 5)
                ring.push_back(evaluate(*brdf, atDegrees(incidence, 180),
                                        about(incidence, azimuth, radius))[0]);
            const auto [least, most] = std::ranges::minmax(ring);
            const double below = radius - 5, above = radius + 5;
            const double expected = (value(0, 0, below) + value(0, 0, above)) / 2;
            EXPECT_NEAR(least, expected, 1e-9) << incidence << ", " << radius;
            EXPECT_NEAR(most, expected, 1e-9) << incidence << ", " << radius;
        }
}

TEST(AngleTables, NormalIncidenceOfAnIsotropicSampleHasNoAzimuth) {
    const auto value = [](double, double a, double r) { return 1 + a * r / 1000; };
    const TemporaryFile file(zemax(value), ".bsdf");
    const auto brdf = open(file.path());
    // Over the whole turn the azimuth is 90 degrees from the plane of incidence on average.
    for (double azimuth = 0; azimuth < 360; azimuth += 30)
        EXPECT_NEAR(evaluate(*brdf, {0, 0, 1}, atDegrees(15, azimuth))[0], 1 + 90 * 15 / 1000.0,
                    2e-3);
}

/// FRED's tables are about the normal.
TEST(AngleTables, FredIsLinearInTheAnglesAboutTheNormal) {
    const auto value = [](double theta, double phi) { return 0.3 + theta * (0.01 + phi / 1e4); };
    std::string text = "type bsdf_data\nformat angles=deg bsdf=value scale=1\n";
    for (const double incidence : {20.0, 50.0}) {
        text += fmt::format("{} 0\n0 0 0.3\n", incidence);
        for (const double theta : steps(10, 80, 10))
            for (const double phi : steps(0, 180, 20))
                text += fmt::format("{} {} {}\n", theta, phi, value(theta, phi));
    }
    const TemporaryFile file(text, ".txt");
    const auto brdf = open(file.path());
    for (const double theta : {3.0, 15.0, 44.0, 77.0})
        for (const double phi : {0.0, 33.0, 90.0, 175.0})
            EXPECT_NEAR(evaluate(*brdf, atDegrees(20, 180), atDegrees(theta, phi))[0],
                        value(theta, phi), 1e-9)
                << theta << ", " << phi;
}

/// A Speos table of 1 with entries of 0 from `zeros` degrees, for 10 % of reflectance.
std::string speos(double zeros) {
    const List thetas = steps(0, 90, 10), phis = steps(0, 360, 30);
    std::string text =
        fmt::format("OPTIS - brdf surface file v8.0\n0\nown\n4\nabcd\n1 0\n1\n2 1\n10 30\n500\n");
    for (int k = 0; k < 2; ++k) {
        text += fmt::format("10\n{} {}\n{}\n", thetas.size(), phis.size(), fmt::join(phis, " "));
        for (const double theta : thetas) {
            text += fmt::format("{}", theta);
            for (std::size_t p = 0; p < phis.size(); ++p) text += theta < zeros ? " 1" : " 0";
            text += "\n";
        }
    }
    return text + "End of file\n";
}

TEST(AngleTables, ZerosOfSpeosAreNotMeasuredUnlessTheUserSaysSo) {
    const TemporaryFile file(speos(65), ".brdf");
    const Direction wi = atDegrees(10, 180);
    const auto brdf = open(file.path());
    const auto& samples = dynamic_cast<const Scattered&>(*brdf).samples();
    // 70, 80 and 90 degrees at 12 azimuths and two incidences.
    ASSERT_EQ(samples.leftOut.size(), 1u);
    EXPECT_EQ(samples.leftOut[0], "72 values of 0 above the horizon (option zeros)");
    const double inside = evaluate(*brdf, wi, atDegrees(40, 20))[0];
    EXPECT_GT(inside, 0.03);
    EXPECT_NEAR(evaluate(*brdf, wi, atDegrees(66, 20))[0], inside, 1e-6);
    const auto kept = open(file.path() + ":zeros=values");
    EXPECT_TRUE(dynamic_cast<const Scattered&>(*kept).samples().leftOut.empty());
    EXPECT_NEAR(evaluate(*kept, wi, atDegrees(65, 20))[0], inside / 2, 1e-6);
    EXPECT_EQ(evaluate(*kept, wi, atDegrees(75, 20))[0], 0);
}

}  // namespace
}  // namespace hshfit::brdfs
