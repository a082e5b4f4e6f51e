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
    const auto shorter = [&](float level) {
        return std::max(std::floor((side + 0.5F) * std::exp2(-level)), 1.0F);
    };
    const float level = std::clamp(lod, 0.0F, last), finer = std::floor(level);
    return (1 + level - finer) / (level > finer ? 2 * shorter(finer + 1) : shorter(finer));
}

/// Compares lookups of an EXR file with `numbers(level, column, row)[layer * 4 + lane]`.
template <class Numbers>
void compare(const std::string& path, std::span<const LevelSize> levels, std::size_t layers,
             const Numbers& numbers) {
    const auto system = OIIO::TextureSystem::create(false);
    const OIIO::ustring file(path);
    const auto last = static_cast<float>(mostLevel(gpu::Language::osl, levels));
    const auto side = static_cast<float>(std::min(levels[0].width, levels[0].height));
    std::mt19937 random(2);
    std::uniform_real_distribution<float> uniform(0, 1);
    for (int k = 0; k < 400; ++k) {
        const float u = uniform(random), v = uniform(random);
        const float lod = k % 4 == 0 ? std::floor(uniform(random) * (last + 1))
                                     : uniform(random) * (last + 0.5F) - 0.25F;
        const std::size_t layer = static_cast<std::size_t>(k) % layers;
        OIIO::TextureOpt options;
        options.interpmode = OIIO::TextureOpt::InterpBilinear;
        options.swrap = options.twrap = OIIO::TextureOpt::WrapClamp;
        options.subimage = static_cast<int>(layer);
        const float width = widthOf(lod, last, side);
        float found[4] = {};
        ASSERT_TRUE(system->texture(file, options, u, v, width, 0, 0, width, 4, found))
            << system->geterror();
        double expected[4] = {};
        for (const MapCorner& corner : mapCorners(levels,
                                                  {static_cast<double>(u), static_cast<double>(v),
                                                   static_cast<double>(std::min(lod, last))},
                                                  Wrap::clamp)) {
            const auto texel = numbers(corner.level, corner.column, corner.row);
            for (std::size_t lane = 0; lane < 4; ++lane)
                expected[lane] += corner.share * texel[layer * 4 + lane];
        }
        for (int lane = 0; lane < 4; ++lane)
            EXPECT_NEAR(found[lane], expected[lane], 2e-4) << path << " lod " << lod;
    }
    OIIO::TextureSystem::destroy(system);
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
        compare(place + "/m.map.exr", map->sidecar().levels, map->sidecar().layers(),
                [&](std::size_t level, std::size_t column, std::size_t row) {
                    return map->numbers(level, column, row);
                });
    }
}

/// Maps of filtered lobes go on where a side is odd.
TEST(OslTexture, FilterWidthsGiveTheLevelsOfOddSides) {
    const test::TemporaryFolder folder;
    const std::vector<LevelSize> levels{{13, 22}, {6, 11}, {3, 5}, {1, 2}, {1, 1}};
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(-1, 1);
    std::vector<std::vector<double>> values;
    std::vector<gpu::Texels> texels;
    for (const LevelSize& size : levels) {
        values.emplace_back(size.width * size.height * 4);
        for (double& value : values.back()) value = uniform(random);
        texels.push_back(gpu::encode(values.back(), static_cast<int>(size.width),
                                     static_cast<int>(size.height), 1, gpu::Number::float32));
    }
    FileSet files(folder.path().string(), false);
    writeTextureExr("map", "odd.exr",
                    {.levels = levels,
                     .layers = 1,
                     .number = gpu::Number::float32,
                     .bytes = [&](std::size_t level) -> std::span<const std::byte> {
                         return texels[level].bytes;
                     }},
                    files);
    files.commit();
    compare(folder / "odd.exr", levels, 1,
            [&](std::size_t level, std::size_t column, std::size_t row) {
                const double* at = &values[level][(row * levels[level].width + column) * 4];
                return std::vector<double>(at, at + 4);
            });
}

/// A table of functions has one level and many more rows than columns; the file goes on with levels
/// that the shader never reads.
TEST(OslTexture, TablesOfOneLevelAreFiltered) {
    const test::TemporaryFolder folder;
    const std::vector<LevelSize> levels{{9, 150}};
    std::mt19937 random(6);
    std::uniform_real_distribution<double> uniform(-1, 1);
    std::vector<double> values(9 * 150 * 4 * 2);
    for (double& value : values) value = uniform(random);
    const gpu::Texels texels = gpu::encode(values, 9, 150, 2, gpu::Number::float16);
    const std::vector<double> stored = gpu::decode(texels);
    FileSet files(folder.path().string(), false);
    writeTextureExr("functions", "table.exr",
                    {.levels = levels,
                     .layers = 2,
                     .number = gpu::Number::float16,
                     .bytes = [&](std::size_t) { return std::span(texels.bytes); }},
                    files);
    files.commit();
    compare(folder / "table.exr", levels, 2, [&](std::size_t, std::size_t column, std::size_t row) {
        std::vector<double> texel;
        for (std::size_t layer = 0; layer < 2; ++layer) {
            const double* at = &stored[((layer * 150 + row) * 9 + column) * 4];
            texel.insert(texel.end(), at, at + 4);
        }
        return texel;
    });
}

}  // namespace
