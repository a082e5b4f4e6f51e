// The nine coefficients that Ramamoorthi & Hanrahan (2001) published for Debevec's probes, from the
// pictures of these probes. The pictures have another scale and resolution than the pictures of
// 2001: hence one factor for each, and a tolerance of 1 % of the norm.

#include <hshfit/bases/sh.h>
#include <hshfit/irradiance/irradiance.h>
#include <hshfit/light/light_projection.h>
#include <hshfit/light/picture_light.h>

#include "places.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

using namespace hshfit;

namespace {

/// Nine rows of "env,l,m,R,G,B".
NineRgb published(const std::string& path, const std::string& probe) {
    std::ifstream in(path);
    NineRgb nine{};
    std::size_t found = 0;
    for (std::string line; std::getline(in, line);) {
        if (!line.starts_with(probe + ",")) continue;
        std::istringstream fields(line.substr(probe.size() + 1));
        char comma = 0;
        int l = 0, m = 0;
        Rgb rgb{};
        fields >> l >> comma >> m >> comma >> rgb[0] >> comma >> rgb[1] >> comma >> rgb[2];
        nine[static_cast<std::size_t>(slotOf(l, m))] = rgb;
        ++found;
    }
    EXPECT_EQ(found, 9u);
    return nine;
}

struct Probe {
    const char *file, *name;
    PictureLayout layout;
    double ratio;  ///< of the picture's scale to the table's
};

TEST(PublishedProbes, NineCoefficientsFollowFromTheirPictures) {
    const std::string shared = test::sharedFolder() + "/data";
    if (!std::filesystem::exists(shared + "/env")) GTEST_SKIP() << shared << "/env is absent";
    const Probe probes[] = {
        {"grace_probe_angular.hdr", "grace", PictureLayout::angular, 3.197},
        {"rnl_probe_latlong.hdr", "eucalyptus", PictureLayout::latlong, 9.98},
        {"stpeters_probe_latlong.hdr", "stpeters", PictureLayout::latlong, 9.975},
    };
    for (const Probe& probe : probes) {
        const PictureLight picture =
            readPictureLight(shared + "/env/" + probe.file, 1, {.layout = probe.layout});
        const std::vector<Light> lights{picture};
        const LightCoefficients light =
            projectLight(lights, *bases::makeSh(3, {}), {.maxLevel = 1});
        NineRgb ours{};
        for (std::size_t k = 0; k < 9; ++k)
            for (std::size_t c = 0; c < 3; ++c) ours[k][c] = light.at(c)[k] / probe.ratio;
        // Theirs: x to the right of the picture's middle, y up, z to the middle.
        const NineRgb turned = inAxes(ours, [](const Direction& d) {
            return Direction{-d.y, d.z, d.x};
        });
        const NineRgb theirs = published(shared + "/tables/irradiance_sh9_debevec.csv", probe.name);
        double difference = 0, all = 0;
        for (std::size_t k = 0; k < 9; ++k) {
            for (std::size_t c = 0; c < 3; ++c) {
                difference += std::pow(turned[k][c] - theirs[k][c], 2);
                all += theirs[k][c] * theirs[k][c];
            }
        }
        EXPECT_LT(std::sqrt(difference / all), 0.01) << probe.name;
    }
}

}  // namespace
