// Real files of laboratories and programs (../shared/data/field/files) by parsers of this test:
// every stored value is a sample, and f at its directions is the value.

#include "places.h"
#include "skip_without.h"

#include <brdfs/catalog.h>
#include <brdfs/measured/scattered/scattered.h>
#include <brdfs/measured_files.h>

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>

namespace hshfit::brdfs {
namespace {

std::string field(const std::string& name) {
    return test::sharedFolder() + "/data/field/files/" + name;
}

using Rows = std::vector<std::vector<double>>;

/// The rows after the first line that begins with `last`, commas as blanks.
Rows rowsAfter(const std::string& path, const std::string& last) {
    std::ifstream file(path);
    std::string line;
    while (std::getline(file, line) && !line.starts_with(last)) {
    }
    Rows rows;
    while (std::getline(file, line)) {
        for (char& c : line)
            if (c == ',' || c == '\r') c = ' ';
        std::istringstream numbers(line);
        std::vector<double> row;
        for (double x; numbers >> x;) row.push_back(x);
        if (!row.empty()) rows.push_back(row);
    }
    return rows;
}

/// Checks f at the directions of each row above the horizon; the number of values compared.
std::size_t expectValues(const Brdf& brdf, const Rows& rows, std::size_t first,
                         const std::function<DirectionPair(const std::vector<double>&)>& pairOf) {
    std::size_t compared = 0;
    for (const std::vector<double>& row : rows) {
        const DirectionPair pair = pairOf(row);
        if (!(pair.wi.z > 1e-6) || !(pair.wo.z > 1e-6)) continue;
        const std::vector<double> f = evaluate(brdf, pair.wi, pair.wo);
        for (std::size_t c = 0; c < f.size(); ++c, ++compared)
            EXPECT_NEAR(f[c], std::max(0., row[first + c]), 1e-6 * std::fabs(row[first + c]) + 1e-9)
                << "row " << (&row - rows.data()) << " channel " << c;
    }
    return compared;
}

TEST(FieldFiles, AstmSamplesAreReturned) {
    const std::string path = field("astm/garnet_red_RGB.astm");
    SKIP_WITHOUT(path);
    const auto brdf = open(path + ":exchange=no,mirror=no");
    const Rows rows = rowsAfter(path, "VARS");
    const std::size_t values = expectValues(*brdf, rows, 4, [](const std::vector<double>& row) {
        return DirectionPair{directionFromAngles(row[0], row[1]),
                             directionFromAngles(row[2], row[3])};
    });
    std::printf("%zu rows, %zu values\n", rows.size(), values);
    EXPECT_GT(values, 3000u);
}

/// The view is the normal in all rows: one place, of which f is the mean, so that samples are
/// compared.
TEST(FieldFiles, AltaRowsAreSamples) {
    const std::string path = field("alta/brdf_small_simu_two_layers_txt.alta");
    SKIP_WITHOUT(path);
    const auto pairs = measuredPairs(*open(path));
    const Samples& samples = pairs->samples;
    const Rows rows = rowsAfter(path, "#ALTA_END_HEADER");
    ASSERT_EQ(samples.size(), rows.size());
    for (std::size_t k = 0; k < rows.size(); ++k) {
        // ISOTROPIC_TV_TL_DPHI: the view, the light, the azimuth between them.
        EXPECT_NEAR(polarAngle(samples.wo[k]), rows[k][0], 1e-12);
        EXPECT_NEAR(polarAngle(samples.wi[k]), rows[k][1], 1e-12);
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_EQ(samples.values[3 * k + c], rows[k][3 + c]) << k;
    }
    std::printf("%zu rows\n", rows.size());
}

}  // namespace
}  // namespace hshfit::brdfs
