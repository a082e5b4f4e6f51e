// Files of other programs, or of no BRDF at all, under extensions of formats: they are named for
// what they look like, and known formats are known under any extension.

#include "places.h"
#include "skip_without.h"

#include <brdfs/catalog.h>
#include <brdfs/measured/scattered/alta.h>
#include <brdfs/measured_files.h>
#include <hshfit/error.h>

#include <gtest/gtest.h>

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

TEST(Foreign, ContentComesBeforeTheExtension) {
    const std::string zemax =
        "# own\nSource  Measured\nSymmetry  PlaneSymmetrical\nSpectralContent  Monochrome\n"
        "ScatterType  BRDF\nSampleRotation  1\n0\nAngleOfIncidence  1\n10\nScatterAzimuth 2\n0 "
        "180\n"
        "ScatterRadial 2\n0 90\nMonochrome\nDataBegin\nTIS 0.1\n0.03 0.03\n0.03 0.03\nDataEnd\n";
    const std::string rows[] = {
        zemax, "Incident_angle,Measure_angle,550nm\n10,-10,0.5\n10,10,0.9\n",
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
    // The low byte of the first double may be any, also that of '#'.
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
