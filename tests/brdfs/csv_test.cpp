// Tables of samples with named columns: names, units, separators, quantities and conventions.

#include "places.h"
#include "skip_without.h"

#include <brdfs/catalog.h>
#include <brdfs/measured/scattered/csv.h>
#include <brdfs/measured/scattered/scattered.h>
#include <brdfs/measured_files.h>
#include <brdfs/sample_checks.h>

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

namespace hshfit::brdfs {
namespace {

using test::atDegrees;
using Values = std::vector<double>;

void expectDirection(const Direction& got, const Direction& expected) {
    test::expectDirection(got, expected, 1e-9);
}

std::string factOf(const Samples& samples, std::string_view name) {
    for (const auto& [key, value] : samples.facts)
        if (key == name && std::holds_alternative<std::string>(value))
            return std::get<std::string>(value);
    return "";
}

void refused(const std::string& text, const std::vector<std::string>& parts,
             const CsvOptions& options = {}) {
    test::expectInputError([&] { readCsv(text, "f", options); }, parts);
}

/// One pair, 30/10 to 60/190 degrees with f = 0.25, in the ways that tables are written.
TEST(Csv, OnePairInManyTables) {
    const std::string tables[] = {
        "theta_i,phi_i,theta_o,phi_o,brdf\n30,10,60,190,0.25\n",
        "Theta_i (deg), Phi_i (deg), Theta_r (deg), Phi_r (deg), BRDF (1/sr)\n30,10,60,190,0.25",
        "theta_i_rad\tphi_i_rad\ttheta_o_rad\tphi_o_rad\tf_r\n"
        "0.5235987755982988\t0.17453292519943295\t1.0471975511965976\t3.3161255787892263\t0.25\n",
        "\xef\xbb\xbf\"theta_i\";\"phi_i\";\"theta_o\";\"phi_o\";\"BRDF\";;\r\n"
        "\"30\";10;60;190;0,25;;\r\n;;;;;;\r\n",
        "# a laboratory\n# theta_i phi_i theta_s phi_s bsdf\n30  10 60 190   2.5e-1\n",
        "src_z\tsrc_a\tview_z\tview_a\tBRF\n 30.0\t10.0\t60.0\t190.0\t0.7853981633974483\n",
        "BRF values of a tile\nSZA,SAA,VZA,VAA,value\n30,10,60,190,0.7853981633974483\n",
        "brdf,phi_o,theta_o,phi_i,theta_i,temperature,operator\n0.25,190,60,10,30,21.5,me\n",
        "\u03b8_i [\u00b0],\u03c6_i [\u00b0],\u03b8_o [\u00b0],\u03c6_o "
        "[\u00b0],f\n30,10,60,190,0.25",
        "wi_x,wi_y,wi_z,wo_x,wo_y,wo_z,brdf\n0.49240387650610395,0.08682408883346515,"
        "0.8660254037844387,-0.8528685319524433,-0.15038373318043525,0.5,0.25\n"};
    for (const std::string& table : tables) {
        SCOPED_TRACE(table);
        const Samples samples = readCsv(table, "f");
        ASSERT_EQ(samples.size(), 1u);
        expectDirection(samples.wi[0], atDegrees(30, 10));
        expectDirection(samples.wo[0], atDegrees(60, 190));
        EXPECT_NEAR(samples.values[0], 0.25, 1e-15);
        EXPECT_EQ(samples.channels.kind, Channels::Kind::grey);
    }
}

TEST(Csv, ChannelsAreWavelengthsColoursOrRows) {
    const Samples named = readCsv("aoi,vza,raa,600nm,0.55 um,brdf_500nm\n30,60,180,6,5.5,5\n", "f");
    EXPECT_EQ(named.channels.wavelengths, (Values{500, 550, 600}));
    EXPECT_EQ(named.values, (Values{5, 5.5, 6}));
    const Samples numbers = readCsv("aoi,vza,raa,600,550\n30,60,180,6,5.5\n", "f");
    EXPECT_EQ(numbers.channels.wavelengths, (Values{550, 600}));
    const Samples rgb = readCsv("aoi,vza,raa,BRDF_B,BRDF_G,BRDF_R\n30,60,180,3,2,1\n", "f");
    EXPECT_EQ(rgb.channels.kind, Channels::Kind::rgb);
    EXPECT_EQ(rgb.values, (Values{1, 2, 3}));
    EXPECT_EQ(readCsv("aoi,vza,raa,f_r,f_g,f_b\n30,60,180,1,2,3\n", "f").values, (Values{1, 2, 3}));
    const Samples rows = readCsv(
        "wavelength (um),aoi,vza,raa,brdf\n0.633,30,60,180,2\n0.532,30,60,180,1\n"
        "0.532,30,60,180,3\n0.633,30,60,180,4\n0.633,30,10,180,9\n",
        "f");
    EXPECT_EQ(rows.channels.wavelengths, (Values{532, 633}));
    EXPECT_EQ(rows.values, (Values{1, 2, 3, 4}));  // two measurements of one pair
    ASSERT_EQ(rows.leftOut.size(), 1u);
    EXPECT_EQ(rows.leftOut[0].substr(0, 2), "1 ");
}

/// A detector at alpha in the plane of incidence and beta out of it: Rz(phi_i) applied to
/// (-sin alpha cos beta, sin beta, cos alpha cos beta).
TEST(Csv, SignedAnglesAreInThePlaneOfIncidence) {
    const Samples samples =
        readCsv("Incident_angle,Measure_angle,550nm\n10,10,0.9\n10,-10,0.5\n10,0,0.7\n", "f");
    ASSERT_EQ(samples.size(), 3u);
    expectDirection(samples.wo[0], mirrored(samples.wi[0]));
    expectDirection(samples.wo[1], samples.wi[1]);
    const Samples out = readCsv("theta_i,phi_i,theta_o,out_of_plane,brdf\n20,90,40,30,1\n", "f");
    const double a = radians(40), b = radians(30);
    // Turned by 90 degrees: (x, y) becomes (-y, x).
    expectDirection(out.wo[0],
                    {-std::sin(b), -std::sin(a) * std::cos(b), std::cos(a) * std::cos(b)});
    const std::string minus = "theta_i,theta_o,brdf\n30,30,0.1\n30,-30,9\n";
    refused(minus, {"forward=minus", "forward=plus"});
    CsvOptions options;
    options.forward = CsvOptions::Forward::minus;
    const Samples turned = readCsv(minus, "f", options);
    expectDirection(turned.wo[1], mirrored(turned.wi[1]));
    options.forward = CsvOptions::Forward::plus;
    const Samples retro = readCsv(minus, "f", options);
    expectDirection(retro.wo[1], retro.wi[1]);
}

TEST(Csv, ARelativeAzimuthStartsAtTheLightOrTheMirrorDirection) {
    const std::string table = "theta_i,theta_o,phi,brdf\n30,50,0,1\n30,50,70,1\n";
    const Samples light = readCsv(table, "f");
    expectDirection(light.wo[0], atDegrees(50, 0));
    expectDirection(light.wo[1], atDegrees(50, 70));
    CsvOptions options;
    options.azimuth = CsvOptions::Azimuth::mirror;
    expectDirection(readCsv(table, "f", options).wo[1], atDegrees(50, 250));
    const std::string ahead = "theta_i,theta_o,phi,brdf\n30,30,180,1\n30,30,0,9\n";
    refused(ahead, {"azimuth=mirror", "azimuth=light"});
    const Samples turned = readCsv(ahead, "f", options);
    expectDirection(turned.wo[1], mirrored(turned.wi[1]));
    options.azimuth = CsvOptions::Azimuth::light;
    EXPECT_EQ(readCsv(ahead, "f", options).size(), 2u);
}

TEST(Csv, UncertaintiesAndScansAreKept) {
    const Samples one = readCsv("aoi,vza,raa,brdf,sigma,scan\n30,60,180,2,0.1,7\n", "f");
    EXPECT_EQ(one.sigmas, (Values{0.1}));
    EXPECT_EQ(one.scans, (Values{7}));
    const Samples percent = readCsv("aoi,vza,raa,brdf,uncertainty (%)\n30,60,180,2,3\n", "f");
    EXPECT_NEAR(percent.sigmas.at(0), 0.06, 1e-15);
    const Samples each =
        readCsv("aoi,vza,raa,600nm,500nm,sigma_500nm,sigma_600nm\n30,60,180,6,5,0.5,0.6\n", "f");
    EXPECT_EQ(each.sigmas, (Values{0.5, 0.6}));
    const Samples factor = readCsv("aoi,vza,raa,brf,sigma\n30,60,180,1,0.1\n", "f");
    EXPECT_NEAR(factor.values[0], 1 / pi, 1e-15);
    EXPECT_NEAR(factor.sigmas[0], 0.1 / pi, 1e-15);
}

TEST(Csv, MissingValuesAreLeftOutAndCounted) {
    const Samples samples = readCsv(
        "aoi,vza,raa,500nm,600nm\n30,60,180,1,2\n30,50,180,,2\n30,40,180,NaN,NA\n30,30,180,0,0\n",
        "f");
    EXPECT_EQ(samples.size(), 2u);
    ASSERT_FALSE(samples.leftOut.empty());
    EXPECT_EQ(samples.leftOut[0], "2 rows without a value");
    CsvOptions options;
    options.zerosMeasured = false;
    EXPECT_EQ(readCsv("aoi,vza,raa,brdf\n30,60,180,1\n30,30,180,0\n", "f", options).size(), 1u);
}

TEST(Csv, TheAnswerSaysHowAmbiguousNamesWereTaken) {
    const Samples plain = readCsv("aoi,vza,raa,550nm\n30,60,180,1\n", "f");
    EXPECT_EQ(factOf(plain, "quantity"), "brdf (not stated by the file)");
    EXPECT_EQ(factOf(plain, "angles"), "degrees (by their values)");
    EXPECT_EQ(factOf(readCsv("aoi,vza,raa,brf\n0.6,0.9,3,1\n", "f"), "angles"),
              "radians (by their values)");
    refused("aoi,vza,raa,reflectance\n30,60,180,1\n", {"quantity=brdf"});
    refused("BRF and BRDF\naoi,vza,raa,550nm\n30,60,180,1\n", {"quantity=radiance-factor"});
    CsvOptions options;
    options.quantity = StatedQuantity::radianceFactor;
    EXPECT_EQ(readCsv("aoi,vza,raa,reflectance\n30,60,180,1\n", "f", options).size(), 1u);
    refused("aoi,vza,raa,brdf\n0.1,0.2,0.3,1\n", {"angles=degrees"});
    refused("aoi (rad),vza (deg),raa,brdf\n0.1,0.2,0.3,1\n", {"beside each other"});
}

TEST(Csv, FilesOpenWithOptionsAndNamesThatOpenTheSame) {
    const test::TemporaryFile file("aoi,vza,raa,550nm\n30,60,180,1\n30,50,180,0.5\n", ".csv");
    const Direction wi = atDegrees(30, 0), wo = atDegrees(60, 180);
    EXPECT_NEAR(evaluate(*open(file.path()), wi, wo)[0], 1, 1e-12);
    const auto factor = open(file.path() + ":quantity=radiance-factor,scale=2");
    EXPECT_NEAR(evaluate(*factor, wi, wo)[0], 2 / pi, 1e-12);
    EXPECT_NEAR(evaluate(*open(factor->name()), wi, wo)[0], 2 / pi, 1e-12);
    const test::TemporaryFile brf("aoi,vza,raa,brf\n30,60,180,1\n", ".txt");
    EXPECT_NEAR(evaluate(*open(brf.path()), wi, wo)[0], 1 / pi, 1e-12);
    const auto stated = open(brf.path() + ":quantity=brdf");
    EXPECT_NEAR(evaluate(*open(stated->name()), wi, wo)[0], 1, 1e-12);
}

TEST(CsvAttack, FieldsAreChecked) {
    const std::string names = "theta_i,phi_i,theta_o,phi_o,brdf\n";
    refused("", {"names of the columns", "theta_i"});
    refused("x,y\n1,2\n", {"names of the columns"});
    refused(names, {"no rows"});
    refused("theta_i,theta_o\n30,30\n", {"no column of values"});
    refused("theta_i,theta_o,phi,time\n30,30,0,1\n", {"no column of values"});
    refused("theta_i,aoi,theta_o,brdf\n", {"two columns", "theta_i", "aoi"});
    refused("theta_i,theta_o,phi,phi_o,brdf\n", {"relative azimuth"});
    refused("theta_i,theta_o,brdf,brf\n", {"2 columns of values"});
    refused("theta_i,theta_o,500nm,500nm\n", {"two columns for 500 nm"});
    refused("theta_i,theta_o,btdf\n", {"'btdf' is no BRDF"});
    refused("theta_i,theta_o,phi_d,brdf\n", {"'phi_d'", "unknown kind"});
    refused("wi_x,wi_y,wi_z,wo_z,brdf\n", {"all of wi_x"});
    refused("theta_i,theta_o,brdf,sigma_500nm\n", {"sigma_NAME"});
    refused(names + "30,0,30,180\n", {"line 2", "4 cells", "5 columns"});
    refused(names + "30,0,30,x,1\n", {"line 2", "'x' is no number", "phi_o"});
    refused(names + "30,0,,180,1\n", {"line 2", "theta_o"});
    refused(names + "30,0,130,180,1\n", {"line 2", "theta_o is 130", "90 degrees"});
    refused(names + "30,0,30,180,1e999\n", {"line 2", "inf"});
    refused("theta_i,theta_o,phi,brdf,sigma\n30,30,0,1,0\n", {"line 2", "sigma is 0"});
    refused("wi_x,wi_y,wi_z,wo_x,wo_y,wo_z,brdf\n1,1,1,0,0,1,1\n", {"line 2", "length"});
    refused("wavelength,theta_i,theta_o,phi,brdf\n0,30,30,0,1\n", {"line 2", "wavelength 0"});
    refused(std::string(300, '\n') + names, {"names of the columns"});
}

TEST(CsvAttack, EveryTruncationIsReadOrRefused) {
    const std::string text =
        "# lab\nwavelength,theta_i,phi_i,theta_o,phi_o,brdf,sigma,scan\n"
        "550,30,0,30,180,1,0.1,2\n650,30,0,30,180,1,0.1,2\n";
    EXPECT_EQ(readCsv(text, "f").size(), 1u);
    for (std::size_t size = 0; size < text.size(); ++size) {
        const std::string cut = text.substr(0, size);
        try {
            readCsv(cut, "f");
        } catch (const InputError&) {
        }
    }
}

TEST(CsvShared, InPlaneScansOfTheFieldAreSamples) {
    const std::string path =
        test::sharedFolder() + "/data/field/measured/05-foreign-extension/inplane.csv";
    SKIP_WITHOUT(path);
    const auto brdf = open(path);
    const Direction wi = atDegrees(10, 0);
    EXPECT_NEAR(evaluate(*brdf, wi, mirrored(wi))[0], 0.9, 1e-12);
    EXPECT_NEAR(evaluate(*brdf, wi, wi)[0], 0.5, 1e-12);
}

}  // namespace
}  // namespace hshfit::brdfs
