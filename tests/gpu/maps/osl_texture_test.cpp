// OpenImageIO's texture system, which OSL looks up textures by, on the EXR files of an export: the
// width of the filter that the OSL shader states gives the level that it means.

#include "sample_maps.h"
#include "temporary_folder.h"

#include <hshfit/files/file_set.h>
#include <hshfit/material_maps/exports/map_export.h>

#include <OpenImageIO/texture.h>
#include <OpenImageIO/ustring.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace {

using namespace hshfit;

/// As the snippet has it (templates/osl.mustache).
float widthOf(float lod, float last, float side) {
    const float level = std::clamp(lod, 0.0F, last), finer = std::floor(level);
    return std::exp2(finer) * (1 + level - finer) / side;
}

TEST(OslTexture, FilterWidthsGiveTheLevelsOfTheShader) {
    const test::TemporaryFolder folder;
    for (const test::SampleMap& sample :
         {test::SampleMap{.name = "a", .width = 16, .height = 16},
          test::SampleMap{.name = "b", .width = 32, .height = 8},
          test::SampleMap{.name = "c", .form = "low-rank", .width = 12, .height = 20}}) {
        const std::string place = folder / sample.name;
        std::filesystem::create_directory(place);
        const auto map = test::writeSampleMap(sample, place);
        FileSet files(place, false);
        writeMapExr(*map, "m", files);
        files.commit();
        const auto system = OIIO::TextureSystem::create(false);
        const OIIO::ustring file(place + "/m.map.exr");
        const MapSidecar& s = map->sidecar();
        const auto last = static_cast<float>(mostLevel(gpu::Language::osl, s.levels));
        std::mt19937 random(2);
        std::uniform_real_distribution<float> uniform(0, 1);
        for (int k = 0; k < 400; ++k) {
            const float u = uniform(random), v = uniform(random);
            const float lod = k % 4 == 0 ? std::floor(uniform(random) * (last + 1))
                                         : uniform(random) * (last + 0.5F) - 0.25F;
            const std::size_t layer = static_cast<std::size_t>(k) % s.layers();
            OIIO::TextureOpt options;
            options.interpmode = OIIO::TextureOpt::InterpBilinear;
            options.swrap = options.twrap = OIIO::TextureOpt::WrapClamp;
            options.subimage = static_cast<int>(layer);
            const float width =
                widthOf(lod, last, static_cast<float>(std::min(sample.width, sample.height)));
            float found[4] = {};
            ASSERT_TRUE(system->texture(file, options, u, v, width, 0, 0, width, 4, found))
                << system->geterror();
            double expected[4] = {};
            for (const MapCorner& corner :
                 mapCorners(s.levels,
                            {static_cast<double>(u), static_cast<double>(v),
                             static_cast<double>(std::min(lod, last))},
                            Wrap::clamp)) {
                const auto numbers = map->numbers(corner.level, corner.column, corner.row);
                for (std::size_t lane = 0; lane < 4; ++lane)
                    expected[lane] += corner.share * numbers[layer * 4 + lane];
            }
            for (int lane = 0; lane < 4; ++lane)
                EXPECT_NEAR(found[lane], expected[lane], 2e-4) << sample.name << " lod " << lod;
        }
        OIIO::TextureSystem::destroy(system);
    }
}

}  // namespace
