// Full-size files put together from measured samples on the plane phi_d = 90 deg (float32, scales
// applied) and a fit elsewhere.

#include "places.h"

#include <brdfs/measured/merl.h>

#include <brdfs/measured_files.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

namespace hshfit {
namespace {

using brdfs::MerlBrdf;

std::vector<float> sliceOf(const std::string& material) {
    std::ifstream file(test::sharedFolder() + "/data/merl_slices/" + material + ".slice",
                       std::ios::binary);
    std::vector<float> values(90 * 90 * 3);
    file.read(reinterpret_cast<char*>(values.data()),
              static_cast<std::streamsize>(values.size() * sizeof(float)));
    EXPECT_TRUE(file) << material;
    return values;
}

class MerlHybrid : public testing::TestWithParam<const char*> {};

TEST_P(MerlHybrid, theMeasuredPlaneIsReproduced) {
    const std::string material = GetParam();
    const std::string tool = test::sharedFolder() + "/tools/merl_hybrid.py";
    if (!std::filesystem::exists(tool)) GTEST_SKIP() << "no " << tool;
    if (std::system("/usr/bin/python3 -c 'import numpy' 2>/dev/null") != 0) {
        GTEST_SKIP() << "python3-numpy is not installed";
    }
    const test::TemporaryFile file;
    ASSERT_EQ(std::system(("/usr/bin/python3 '" + tool + "' " + material + " '" + file.path() +
                           "' > /dev/null")
                              .c_str()),
              0);
    const std::vector<float> slice = sliceOf(material);
    const MerlBrdf brdf(file.path());
    int compared = 0, above = 0;
    for (int h = 0; h < 90; ++h) {
        for (int d = 0; d < 90; ++d) {
            const auto [wi, wo] = brdfs::merlDirections(h, d, 90);
            if (brdfs::merlBelowHorizon(h, d, 90)) continue;
            ++above;
            const std::vector<double> f = evaluate(brdf, wi, wo);
            for (int c = 0; c < 3; ++c) {
                const double expected = slice[3 * (90 * d + h) + c];
                // At theta_h = 0 or theta_d = 0 phi_d does not exist: the cell itself is read.
                const double value =
                    h == 0 || d == 0 ? brdf.stored(c, brdf.layout().cell(h, d, 90)) : f[c];
                if (expected < 0) continue;
                ++compared;
                EXPECT_NEAR(value, expected, 1e-6 * expected + 1e-9) << h << " " << d << " " << c;
            }
        }
    }
    EXPECT_GT(compared, 3 * above * 9 / 10);
    EXPECT_NO_THROW(brdf.checkIntact());
}

INSTANTIATE_TEST_SUITE_P(Materials, MerlHybrid,
                         testing::Values("chrome-steel", "pink-fabric", "white-paint"),
                         [](const auto& material) {
                             std::string name = material.param;
                             std::erase(name, '-');
                             return name;
                         });

}  // namespace
}  // namespace hshfit
