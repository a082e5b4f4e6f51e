// Files of other programs, or of no BRDF at all, under extensions of formats: they are named for
// what they look like, and known formats are known under any extension.

#include "places.h"
#include "skip_without.h"

#include <brdfs/catalog.h>
#include <brdfs/measured/scattered/alta.h>
#include <brdfs/measured/scattered/scattered.h>
#include <brdfs/measured_files.h>
#include <hshfit/error.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

namespace hshfit::brdfs {
namespace {

using test::TemporaryFile;

void refused(const std::string& content, const char* extension,
             const std::vector<std::string>& parts) {
    SCOPED_TRACE(content.substr(0, 40) + extension);
    const TemporaryFile file(content, extension);
    std::vector<std::string> all{file.path(), "of no known format"};
    all.insert(all.end(), parts.begin(), parts.end());
    test::expectInputError([&] { open(file.path()); }, all);
}

TEST(Foreign, FilesAreNamedForWhatTheyLookLike) {
    const std::string pointer =
        "version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 34992012\n";
    for (const char* extension : {".binary", ".bsdf", ".csv", ".xml", ".json", ".unknown"}) {
        refused(pointer, extension, {"Git LFS pointer", "git lfs pull"});
        refused("<!DOCTYPE html>\n<html><body>&lt;WindowElement&gt;</body></html>\n", extension,
                {"web page"});
        refused("  <!doctype HTML><title><WindowElement></title>", extension, {"web page"});
        refused("PK\x03\x04 xl/worksheets", extension, {"Excel", "CSV"});
        refused("\x1f\x8b\x08 anything", extension, {"gzip", "unpack"});
        refused("\x89HDF\r\n\x1a\n", extension, {"HDF5", "CSV"});
    }
    for (const char* extension : {".binary", ".bsdf", ".brdf", ".csv", ".dat", ".unknown"}) {
        refused("404: Not Found", extension, {"error message of a server"});
        // A scan of pab-opto without its incident direction is known, and says what is missing.
        const TemporaryFile scan("#format: theta phi BSDF\n30 180 0.4\n", extension);
        test::expectInputError([&] { open(scan.path()); },
                               {scan.path(), "line 2", "#incident_angle"});
        refused("30 0 30 180 0.5\n30 0 40 180 0.4\n", extension, {"names of its columns"});
        refused("OPTIS - BSDF180 file v8.0\n", extension, {"Speos", "another kind"});
    }
    refused("{\"a\": 1}", ".binary", {"JSON of another program"});
    refused("<?xml version=\"1.0\"?><svg/>", ".binary", {"XML", "<WindowElement>"});
}

TEST(Foreign, TextUnderExtensionsOfBytesAndTheOtherWayRound) {
    refused("just some words\n", ".binary", {"text", "'merl' (.binary) is binary"});
    refused("just some words\n", ".pbsdf", {"text", "pbsdf"});
    refused(std::string("\1\2\0\3", 4), ".astm", {"no text", "'astm' (.astm) is text"});
    refused("just some words\n", ".unknown", {"known: merl"});
}

const std::string zemaxText =
    "# own\nSource  Measured\nSymmetry  PlaneSymmetrical\nSpectralContent  Monochrome\n"
    "ScatterType  BRDF\nSampleRotation  1\n0\nAngleOfIncidence  1\n10\nScatterAzimuth 2\n0 180\n"
    "ScatterRadial 2\n0 90\nMonochrome\nDataBegin\nTIS 0.1\n0.03 0.03\n0.03 0.03\nDataEnd\n";

TEST(Foreign, ContentComesBeforeTheExtension) {
    const std::string rows[] = {
        zemaxText, "Incident_angle,Measure_angle,550nm\n10,-10,0.5\n10,10,0.9\n",
        "{\"brdf\":{\"wavelengths\":[5.5e-07],\"lookupTable\":[[5.5e-07,0.0,0.0,0.0,0.3]]}}",
        "type bsdf_data\nformat angles=deg bsdf=value scale=1\n10 0\n10 0 0.5\n",
        "VARS theta_i,theta_s,BRDF\n0.1,0.1,0.5\n"};
    const char* const formats[] = {"zemax", "csv", "xompt", "fred", "astm"};
    for (const char* extension : {".binary", ".bsdf", ".xml", ".csv", ".json", ".txt"})
        for (std::size_t k = 0; k < std::size(rows); ++k) {
            const TemporaryFile file(rows[k], extension);
            const auto brdf = open(file.path());
            EXPECT_EQ(std::get<std::string>(brdf->facts()[0].second), formats[k]) << extension;
        }
}

/// Windows programs put a byte-order mark before text in UTF-8.
TEST(Foreign, AByteOrderMarkChangesNothing) {
    const std::string alta = "#DIM 2 1\n#PARAM_IN RUSIN_TH_TD\n0.1 0.2 0.5\n0.2 0.3 0.4\n";
    const std::string nist =
        "lambda,thetai,phi\n0.5,10,180,20,0,0.3,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0\n";
    const std::string texts[] = {
        zemaxText,
        alta,
        nist,
        "type bsdf_data\nformat angles=deg bsdf=value scale=1\n10 0\n10 0 0.5\n",
        "OPTIS - brdf surface file v8.0\n0\nown\n4\nabcd\n1 0\n1\n1 1\n30\n500\n20\n3 3\n0 180 "
        "360\n"
        "0 1 1 1\n45 1 1 1\n90 1 1 1\nEnd of file\n",
        "Incident_angle,Measure_angle,550nm\n10,-10,0.5\n10,10,0.9\n",
        "VARS theta_i,theta_s,BRDF\n0.1,0.1,0.5\n"};
    for (const std::string& text : texts) {
        SCOPED_TRACE(text.substr(0, 20));
        const TemporaryFile plain(text, ".txt"), marked("\xef\xbb\xbf" + text, ".txt");
        const auto a = open(plain.path()), b = open(marked.path());
        EXPECT_EQ(a->facts()[0], b->facts()[0]);
        EXPECT_EQ(measuredPairs(*a)->samples.values, measuredPairs(*b)->samples.values);
    }
}

TEST(Foreign, Utf16IsNamed) {
    const std::string text = "theta_i,theta_o,brdf\n10,20,0.5\n";
    std::string little = "\xff\xfe", big = "\xfe\xff";
    for (const char c : text) {
        little += {c, '\0'};
        big += {'\0', c};
    }
    for (const char* extension : {".csv", ".txt", ".unknown"}) {
        refused(little, extension, {"UTF-16", "save it as UTF-8"});
        refused(big, extension, {"UTF-16", "save it as UTF-8"});
    }
}

TEST(Foreign, RowsOfNistMayBeSeparatedBySemicolonsOrTabs) {
    const std::string commas =
        "lambda,thetai,phi\n0.5,10,180,20,0,0.3,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0\n";
    for (const char separator : {';', '\t'}) {
        std::string text = commas;
        std::ranges::replace(text, ',', separator);
        const TemporaryFile file(text, ".csv");
        const auto brdf = open(file.path());
        EXPECT_EQ(brdf->facts()[0], Fact("format", "nist"));
        EXPECT_EQ(measuredPairs(*brdf)->samples.values, std::vector<double>{0.3});
    }
}

/// A file in which every value has the mark of a direction that was not measured.
TEST(Foreign, TablesWithoutAMeasurementAreRefused) {
    const std::vector<float> marks(3 * 90 * 90, -1.0F);
    std::string slice(marks.size() * sizeof(float), '\0');
    std::memcpy(slice.data(), marks.data(), slice.size());
    const TemporaryFile none(slice, ".slice");
    test::expectInputError([&] { open(none.path()); }, {none.path(), "no value was measured"});
    const float measured = 0.1F;
    for (std::size_t c = 0; c < 3; ++c)
        std::memcpy(slice.data() + c * sizeof measured, &measured, sizeof measured);
    const TemporaryFile one(slice, ".slice");
    EXPECT_NO_THROW(open(one.path()));
    const TemporaryFile merl(test::merlFile([](int, int, int, int) { return -1.0; }), ".binary");
    test::expectInputError([&] { open(merl.path()); }, {merl.path(), "no value was measured"});
    const TemporaryFile some(
        test::merlFile([](int, int h, int, int) { return h == 0 ? 0.1 : -1.0; }), ".binary");
    EXPECT_NO_THROW(open(some.path()));
}

/// The doubles of rows as ALTA writes them.
std::string bytesOf(const std::vector<double>& numbers) {
    std::string bytes(numbers.size() * sizeof(double), '\0');
    std::memcpy(bytes.data(), numbers.data(), bytes.size());
    return bytes;
}

const std::string altaHeader =
    "#ALTA_BEGIN_HEADER\n#DIM 3  1\n#PARAM_IN ISOTROPIC_TV_TL_DPHI\n#PARAM_OUT INV_STERADIAN\n"
    "#VS 0\n#VERSION 0\n#FORMAT binary\n#ENDIAN little\n#PRECISION ieee754-double\n"
    "#SAMPLE_COUNT 2\n";

TEST(AltaStream, FilesWithoutMarksBeginAtTheFirstByteThatIsNoRemark) {
    const std::string rows = bytesOf({0.0, 0.2, 0.1, 0.31, 0.1, 0.2, 3.1, 0.52});
    const std::string end = "#ALTA_END_HEADER\n";
    for (const std::string& text :
         {altaHeader + end + rows, altaHeader + rows, altaHeader + end + rows + "\n"}) {
        const Samples samples = readAlta(text, "f");
        EXPECT_EQ(samples.values, (std::vector<double>{0.31, 0.52}));
    }
    // The low byte of the first double may be any byte, '#' too.
    std::string odd = bytesOf({0.0, 0.2, 0.1, 0.31, 0.1, 0.2, 3.1, 0.52});
    odd[0] = '#';
    EXPECT_EQ(readAlta(altaHeader + end + odd, "f").size(), 2u);
    for (const auto& refused :
         {std::pair(altaHeader + end + rows.substr(1), std::vector<std::string>{"too few"}),
          std::pair(altaHeader + end + rows + rows, std::vector<std::string>{"bytes after 2"}),
          std::pair(altaHeader + end, std::vector<std::string>{"too few"})})
        test::expectInputError([&] { readAlta(refused.first, "f"); }, refused.second);
}

TEST(AltaStream, TheFileOfTheFieldIsRead) {
    const std::string path =
        test::sharedFolder() + "/data/field/measured/04-alta-binary-no-marks/no_marks.alta";
    SKIP_WITHOUT(path);
    EXPECT_EQ(open(path)->facts().empty(), false);
}

TEST(AltaStream, StarksCoordinatesSayWhatIsExpected) {
    test::expectInputError([] { readAlta("#DIM 2 1\n#PARAM_IN STARK_2D\n1 1 1\n", "f"); },
                           {"STARK_2D coordinates 1, 1", "x^2 + y^2 up to 1"});
}

}  // namespace
}  // namespace hshfit::brdfs
