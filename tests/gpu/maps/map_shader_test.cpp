// Shaders of maps of materials, in six languages on the renderers in software, against the
// library's texels: filters and levels by sums in double precision, light by quadrature.

#include "map_places.h"
#include "sample_maps.h"

#include "../shaders/runners.h"
#include "temporary_folder.h"

#include <hshfit/error.h>
#include <hshfit/gpu/payload.h>
#include <hshfit/material_maps/exports/shared_numbers.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <map>
#include <random>

namespace hshfit::shaders {
namespace {

using gpu::Language;
using test::SampleMap;

constexpr std::size_t shadeEvery = 61;

MapPlace placeAt(const ShaderJob& job, std::size_t k) {
    return {job.places[3 * k], job.places[3 * k + 1], job.places[3 * k + 2]};
}

ShaderJob jobOf(const MaterialMap& map, Wrap wrap, int bands = 5) {
    const MapSidecar& s = map.sidecar();
    const auto texels = [&](std::size_t level) {
        gpu::Texels of;
        of.width = static_cast<int>(s.levels[level].width);
        of.height = static_cast<int>(s.levels[level].height);
        of.layers = s.layers();
        of.number = s.number;
        of.bytes = {map.level(level).begin(), map.level(level).end()};
        if (isNormalised(s.number)) of.scales.resize(4 * of.layers);
        return of;
    };
    gpu::Payload payload;
    payload.head.channels = s.channels;
    payload.coefficients = texels(0);
    if (s.form != "outgoing") payload.basisTexels = sharedNumbers(s).texels;
    ShaderJob job = makeJob(std::move(payload), bands);
    for (std::size_t level = 1; level < s.levels.size(); ++level)
        job.levels.push_back(texels(level));
    job.places = test::mapPlaces(s.levels, job.pairs.wo.size(), wrap == Wrap::repeat ? 3 : 0.2);
    return job;
}

/// The coefficients at a place: weighted sums of the coefficients of texels.
Coefficients blended(const MaterialMap& map, const MapPlace& place, Wrap wrap) {
    Coefficients sum;
    for (const MapCorner& corner : mapCorners(map.sidecar().levels, place, wrap)) {
        const Coefficients texel = map.coefficients(corner.level, corner.column, corner.row);
        if (sum.values.empty()) {
            sum = texel;
            std::fill(sum.values.begin(), sum.values.end(), 0.0);
        }
        for (std::size_t k = 0; k < sum.values.size(); ++k)
            sum.values[k] += corner.share * texel.values[k];
    }
    return sum;
}

/// As `reference` gives it; light for every `shadeEvery`th pair, through a payload of one texel.
std::vector<double> mapReference(const MaterialMap& map, const ShaderJob& job, Wrap wrap) {
    std::vector<double> expected;
    for (std::size_t k = 0; k < job.pairs.wo.size(); ++k) {
        if (k % shadeEvery == 0) {
            ShaderJob one = makeJob(
                gpu::pack(blended(map, placeAt(job, k), wrap), {.number = gpu::Number::float32}),
                job.environment.order);
            one.pairs = {{job.pairs.wo[k]}, {job.pairs.wi[k]}};
            one.world = job.world;
            const std::vector<double> values = reference(one);
            expected.insert(expected.end(), values.begin(), values.end());
            continue;
        }
        const std::vector<double> q =
            mapValue(map, placeAt(job, k), wrap, job.pairs.wo[k], job.pairs.wi[k]);
        expected.insert(expected.end(), q.begin(), q.end());
        for (const double value : q) expected.push_back(std::max(value, 0.0));
        expected.insert(expected.end(), job.lights(), std::nan(""));
    }
    return expected;
}

/// A test's map with its job and what is expected of every language; made once.
struct Proof {
    SampleMap sample;
    std::unique_ptr<MaterialMap> map;
    ShaderJob job;
    std::vector<double> expected;
};
const std::vector<Proof>& proofs(bool world) {
    static std::map<bool, std::vector<Proof>> made;
    std::vector<Proof>& all = made[world];
    if (!all.empty()) return all;
    for (const SampleMap& sample : test::sampleMaps()) {
        const test::TemporaryFolder folder;
        Proof proof{.sample = sample,
                    .map = test::writeSampleMap(sample, folder.path().string()),
                    .job = {},
                    .expected = {}};
        proof.job = jobOf(*proof.map, sample.wrap);
        proof.job.world = world;
        proof.expected = mapReference(*proof.map, proof.job, sample.wrap);
        all.push_back(std::move(proof));
    }
    return all;
}

/// Relative to the largest value. A lookup is placed to W 2^-25 per axis and a few 2^-24 between
/// levels, and neighbouring texels of noise differ by twice the largest value. The weights of a GPU
/// are off by up to 1/512 per axis and between levels.
Bounds boundsOf(const SampleMap& sample) {
    return {2 * 3 * std::ldexp(static_cast<double>(sample.width + sample.height) + 8, -24), 2e-2};
}

void prove(Language language, Run runner = {}, bool world = false) {
    if (!runner) runner = runnerOf(language);
    for (const Proof& proof : proofs(world)) {
        // The stub of OSL's `texture` knows one mode beyond the edge.
        if (language == Language::osl && proof.sample.wrap == Wrap::repeat) continue;
        const std::string snippet =
            mapShader(language, proof.map->sidecar(), {.wrap = proof.sample.wrap});
        std::vector<float> found;
        try {
            found = runner(proof.job, wrapped(language, proof.job, snippet));
        } catch (const Missing& reason) {
            GTEST_SKIP() << reason.what();
        } catch (const Refused& reason) {
            FAIL() << proof.sample.name << ": " << reason.what();
        }
        // Beyond the last level of OSL another is expected.
        std::vector<double> expected = proof.expected;
        const auto last = static_cast<double>(mostLevel(language, proof.map->sidecar().levels));
        for (std::size_t k = 0; k < expected.size(); ++k) {
            const double level = placeAt(proof.job, k / proof.job.outputs()).level;
            if (language == Language::osl && level > last) expected[k] = std::nan("");
        }
        const Difference difference = compare(proof.job, expected, found);
        std::cout << fmt::format("{:<40} eval {:.1e}  shade {:.1e}\n", proof.sample.name,
                                 difference.eval, difference.shade);
        const Bounds bounds = boundsOf(proof.sample);
        EXPECT_LE(difference.eval, bounds.here()) << proof.sample.name;
        EXPECT_LE(difference.shade, bounds.here()) << proof.sample.name;
        keepLast(world ? "map, light in the world" : "map", language, proof.sample.name,
                 wantedOf(proof.job, expected), bounds);
        // Centres of texels are exact but for single precision.
        std::vector<double> centres = expected;
        for (std::size_t k = 0; k < centres.size(); ++k)
            if (k / proof.job.outputs() % 3 != 0) centres[k] = std::nan("");
        EXPECT_LE(compare(proof.job, centres, found).eval, 3e-6) << proof.sample.name;
    }
}

TEST(MapShader, GlslOnVulkan) {
    prove(Language::glsl);
}
TEST(MapShader, HlslOnVulkan) {
    prove(Language::hlsl);
}
TEST(MapShader, SlangOnVulkan) {
    prove(Language::slang);
}
TEST(MapShader, WgslOnVulkan) {
    prove(Language::wgsl);
}
TEST(MapShader, GlslOnOpenGl) {
    prove(Language::glsl, runOpenGl);
}
TEST(MapShader, GlslEsOnOpenGlEs) {
    prove(Language::glslEs);
}
TEST(MapShader, MetalAsCpp) {
    prove(Language::metal);
}
TEST(MapShader, OslAsCpp) {
    prove(Language::osl);
}
TEST(MapShader, LightInTheWorldOnVulkan) {
    prove(Language::glsl, {}, true);
}

/// Light of fewer bands than the functions of a map have meets some of these functions alone.
TEST(MapShader, LightOfTwoBandsIsThatOfTheQuadrature) {
    for (const Proof& proof : proofs(false)) {
        const Wrap wrap = proof.sample.wrap;
        const ShaderJob job = jobOf(*proof.map, wrap, 2);
        const std::string snippet =
            mapShader(Language::metal, proof.map->sidecar(), {.environmentOrder = 2, .wrap = wrap});
        try {
            const auto found = run(Language::metal, job, wrapped(Language::metal, job, snippet));
            const Difference difference = compare(job, mapReference(*proof.map, job, wrap), found);
            EXPECT_LE(difference.shade, boundsOf(proof.sample).here()) << proof.sample.name;
        } catch (const Missing& reason) {
            GTEST_SKIP() << reason.what();
        } catch (const Refused& reason) {
            ADD_FAILURE() << proof.sample.name << ": " << reason.what();
        }
    }
}

/// A shader with a fault gives something else: the test can fail.
TEST(MapShader, FaultsShow) {
    const Proof& proof = proofs(false).front();
    const std::string snippet = mapShader(Language::metal, proof.map->sidecar(), {});
    const std::pair<std::string, std::string> faults[] = {
        {"level(lod)", "level(0.0f)"},
        {"node1 + 0, lod", "node0 + 0, lod"},
        {"min(floor(nodeX)", "min(floor(nodeX + 0.5f)"},
    };
    for (const auto& [right, wrong] : faults) {
        const std::string broken = withFault(snippet, right, wrong);
        try {
            const auto found =
                run(Language::metal, proof.job, wrapped(Language::metal, proof.job, broken));
            EXPECT_GT(compare(proof.job, proof.expected, found).eval, 1e-2) << wrong;
        } catch (const Missing& reason) {
            GTEST_SKIP() << reason.what();
        }
    }
}

TEST(MapShader, MoreLayersThanALanguageHasAreRefused) {
    const test::TemporaryFolder folder;
    const auto map = test::writeSampleMap(
        {.name = "", .order = 4, .outgoing = "8x8", .mirror = false, .width = 2, .height = 2},
        folder.path().string());
    ASSERT_GT(map->sidecar().layers(), 256U);
    EXPECT_THROW(mapShader(Language::wgsl, map->sidecar(), {}), UsageError);
    EXPECT_THROW(mapShader(Language::glslEs, map->sidecar(), {}), UsageError);
    EXPECT_NO_THROW(mapShader(Language::hlsl, map->sidecar(), {}));
}

}  // namespace
}  // namespace hshfit::shaders
