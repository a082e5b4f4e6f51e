// Look-up tables of OpenMATERIAL that are written are read back, with the fields that the schema
// requires.

#include <brdfs/catalog.h>
#include <brdfs/measured/scattered/xompt.h>
#include <brdfs/measured_files.h>
#include <hshfit/error.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <regex>
#include <sstream>

namespace hshfit::brdfs {
namespace {

std::string written(const Brdf& brdf, const std::string& options) {
    const Writer& writer = *std::ranges::find(writers(), "xompt", &Writer::name);
    const test::TemporaryFile file("", ".xompt");
    writer.write(brdf, file.path(), parseParameters("xompt", writer.parameters, options),
                 {.force = true});
    std::ostringstream text;
    text << std::ifstream(file.path(), std::ios::binary).rdbuf();
    return text.str();
}

TEST(XomptWriter, ValuesAreReadBack) {
    const auto brdf = open("ggx:alpha=.4,F0=.5,kd=.1");
    const Samples samples =
        readXompt(written(*brdf, "theta=4,phi=6,last=60,wavelength=632.8"), "f");
    EXPECT_EQ(samples.channels.wavelengths, (std::vector<double>{632.8}));
    // For each incidence the normal once, and 3 polar angles with 6 azimuths.
    ASSERT_EQ(samples.size(), 4u * (1 + 3 * 6));
    for (std::size_t k = 0; k < samples.size(); ++k)
        EXPECT_NEAR(samples.values[k], evaluate(*brdf, samples.wi[k], samples.wo[k])[0],
                    1e-9 * samples.values[k]);
}

TEST(XomptWriter, SpectraKeepTheirWavelengths) {
    const test::TemporaryFile file("aoi,vza,raa,450nm,550.5nm\n30,30,180,0.2,0.3\n", ".csv");
    const auto brdf = open(file.path());
    const Samples samples = readXompt(written(*brdf, "theta=3,phi=4,last=60"), "f");
    EXPECT_EQ(samples.channels.wavelengths, (std::vector<double>{450, 550.5}));
    bool found = false;
    for (std::size_t k = 0; k < samples.size(); ++k)
        if (std::fabs(polarAngle(samples.wi[k]) - radians(30)) < 1e-6 &&
            std::fabs(samples.wo[k].x + .5) < 1e-6 && std::fabs(samples.wo[k].y) < 1e-5) {
            EXPECT_NEAR(samples.values[2 * k], .2, 1e-6);
            EXPECT_NEAR(samples.values[2 * k + 1], .3, 1e-6);
            found = true;
        }
    EXPECT_TRUE(found);
}

TEST(XomptWriter, TheFieldsOfTheSchemaAreThere) {
    const auto root = nlohmann::json::parse(
        written(*open("lambert"), "theta=3,phi=4,license=CC0-1.0,author=a laboratory"));
    const auto& metadata = root["metadata"];
    for (const char* key : {"name", "uuid", "materialVersion", "openMaterial3dVersion",
                            "copyrights", "license", "authors", "sources"})
        EXPECT_TRUE(metadata.contains(key)) << key;
    EXPECT_EQ(metadata["license"], "CC0-1.0");
    EXPECT_EQ(metadata["authors"][0], "a laboratory");
    EXPECT_TRUE(std::regex_match(
        metadata["uuid"].get<std::string>(),
        std::regex("[0-9a-f]{8}-[0-9a-f]{4}-[0-9a-f]{4}-[0-9a-f]{4}-[0-9a-f]{12}")));
    const auto& rows = root["brdf"]["lookupTable"];
    EXPECT_TRUE(std::is_sorted(rows.begin(), rows.end()));
    for (const auto& row : rows) EXPECT_EQ(row.size(), 5u);
}

TEST(XomptWriter, ColoursAndAnisotropyAreRefused) {
    EXPECT_THROW(written(*open("lambert:kd=.1/.2/.3"), ""), UsageError);
    EXPECT_THROW(written(*open("ggx:ax=.1,ay=.4"), ""), UsageError);
}

}  // namespace
}  // namespace hshfit::brdfs
