// Shaders of maps of filtered lobes, in six languages on the renderers in software, against the
// library's FilteredTexel and the models of level 0, in double precision.

#include "sample_descriptions.h"

#include "../shaders/runners.h"
#include "temporary_folder.h"

#include <hshfit/error.h>
#include <hshfit/filtered_maps/exports/filtered_sampler.h>
#include <hshfit/filtered_maps/exports/filtered_shader.h>
#include <hshfit/filtered_maps/exports/internal/lobe_numbers.h>

#include <jobs/maps/filtered.h>
#include <jobs/maps/lobe_text.h>
#include <jobs/source/filtered_texel_brdf.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <random>

namespace hshfit::shaders {
namespace {

using gpu::Language;
using test::SampleDescription;

/// A written map, with what its shader is made from.
struct Written {
    FilteredMap map;
    jobs::FacetLobes lobes;
    LobeText text;

    explicit Written(const std::string& file)
        : map(file),
          lobes(map.sidecar().model, map.sidecar().nodes),
          text(jobs::lobeText(lobes, file)) {}
    FilteredSampler sampler(Wrap wrap) const {
        const FilteredSidecar& s = map.sidecar();
        return {map, lobes.surface(s.terms, s.channels.count(), s.layout.albedos),
                lobes.table(map.harmonics() ? s.layout.order : 3), wrap};
    }
};

std::unique_ptr<Written> written(const SampleDescription& sample, const std::string& folder) {
    const std::string description = test::writeDescription(sample, folder);
    jobs::filteredMap(description, folder + "/map",
                      {.form = sample.form,
                       .harmonics = sample.harmonics,
                       .precision = sample.precision,
                       .mips = sample.mips,
                       .checks = 0});
    return std::make_unique<Written>(folder + "/map/material.json");
}

/// Places in and beyond the map: centres of texels of whole levels, places of level 0, and places
/// between levels.
std::vector<double> placesOf(const FilteredSidecar& map, std::size_t count, Wrap wrap) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(0, 1);
    const auto single = [](double value) { return static_cast<double>(static_cast<float>(value)); };
    const double beyond = wrap == Wrap::repeat ? 3 : 0.2;
    std::vector<double> places;
    for (std::size_t k = 0; k < count; ++k) {
        const double u = uniform(random), v = uniform(random);
        const std::size_t level = k / 3 % map.levels.size();
        const auto at = [&](double x, std::size_t side) {
            const auto length = static_cast<double>(side);
            if (k % 3 == 0) return single((std::floor(x * length) + 0.5) / length);
            return single(x * (1 + 2 * beyond) - beyond);
        };
        places.push_back(at(u, map.levels[level].width));
        places.push_back(at(v, map.levels[level].height));
        const double between =
            single(uniform(random) * (static_cast<double>(map.levels.size()) + 0.5) - 0.75);
        places.push_back(k % 3 == 0 ? static_cast<double>(level) : k % 6 == 1 ? 0.0 : between);
    }
    return places;
}

gpu::Texels texelsOf(const LevelTexture& texture, std::size_t level, const LevelSize& size,
                     std::size_t layers, gpu::Number number) {
    gpu::Texels of;
    of.width = static_cast<int>(size.width);
    of.height = static_cast<int>(size.height);
    of.layers = layers;
    of.number = number;
    of.bytes = {texture.level(level).begin(), texture.level(level).end()};
    return of;
}

ShaderJob jobOf(const FilteredMap& map, Wrap wrap) {
    const FilteredSidecar& s = map.sidecar();
    const auto level = [&](std::size_t k) {
        return texelsOf(map.texture(), k, s.levels[k], s.layers(), s.number);
    };
    gpu::Payload payload;
    payload.head.channels = s.channels;
    payload.coefficients = level(0);
    payload.basisTexels = lobeNumbers(s).texels;
    ShaderJob job = makeJob(std::move(payload), 1);
    job.form = "filtered";
    for (std::size_t k = 1; k < s.levels.size(); ++k) job.levels.push_back(level(k));
    job.places = placesOf(s, job.pairs.wo.size(), wrap);
    for (std::size_t k = 0; k < s.harmonicLevels().size(); ++k) {
        job.harmonics.push_back(
            texelsOf(*map.harmonics(), k, s.harmonicLevels()[k], s.harmonicLayers(), s.number));
    }
    return job;
}

MapPlace placeAt(const ShaderJob& job, std::size_t k) {
    return {job.places[3 * k], job.places[3 * k + 1], job.places[3 * k + 2]};
}

/// A sample's map with its job and what is expected of every language; made once.
struct Proof {
    SampleDescription sample;
    std::unique_ptr<Written> written;
    ShaderJob job;
    std::vector<double> expected;  ///< [pair][channel]
};

const std::vector<Proof>& proofs() {
    static const test::TemporaryFolder folder;
    static const std::vector<Proof> all = [] {
        std::vector<Proof> made;
        for (const SampleDescription& sample : test::sampleDescriptions()) {
            const std::string place = folder / std::to_string(made.size());
            std::filesystem::create_directory(place);
            Proof proof{
                .sample = sample, .written = written(sample, place), .job = {}, .expected = {}};
            proof.job = jobOf(proof.written->map, sample.wrap);
            const FilteredSampler sampler = proof.written->sampler(sample.wrap);
            for (std::size_t k = 0; k < proof.job.pairs.wo.size(); ++k) {
                const auto values = sampler.value(placeAt(proof.job, k), proof.job.pairs.wo[k],
                                                  proof.job.pairs.wi[k]);
                proof.expected.insert(proof.expected.end(), values.begin(), values.end());
            }
            made.push_back(std::move(proof));
        }
        return made;
    }();
    return all;
}

/// The largest difference, of the value and a thousandth of the largest value.
struct Gap {
    double all = 0, centres = 0;
    std::string where;
};
Gap gapOf(const Proof& proof, Language language, const std::vector<float>& found) {
    const std::size_t channels = proof.job.channels();
    const auto& levels = proof.written->map.sidecar().levels;
    const double last = static_cast<double>(mostLevel(language, levels));
    const double most = *std::ranges::max_element(proof.expected);
    EXPECT_GT(most, 0);
    Gap gap;
    for (std::size_t k = 0; k < proof.job.pairs.wo.size(); ++k) {
        const MapPlace place = placeAt(proof.job, k);
        // Beyond the last level of OSL there is another value.
        if (language == Language::osl && place.level > last) continue;
        for (std::size_t c = 0; c < channels; ++c) {
            const double expected = proof.expected[k * channels + c];
            double d =
                std::abs(static_cast<double>(found[k * proof.job.outputs() + c]) - expected) /
                (expected + 1e-3 * most);
            if (!(d < 1e30)) d = 1e30;
            if (d > gap.all) {
                gap.all = d;
                gap.where = fmt::format("pair {} ({}, {}, {}): {} for {}", k, place.u, place.v,
                                        place.level, found[k * proof.job.outputs() + c], expected);
            }
            if (k % 3 == 0) gap.centres = std::max(gap.centres, d);
        }
    }
    return gap;
}

std::string shaderOf(const Proof& proof, Language language) {
    return filteredShader(language, proof.written->map.sidecar(), proof.written->text,
                          {.wrap = proof.sample.wrap});
}

/// For places in single precision, on a surface whose neighbouring texels have nothing in common; a
/// GPU may blend with weights of 8 bits.
constexpr Bounds bounds{1e-3, 2e-2};

/// Differences relative to the value and a thousandth of the largest value.
Wanted wantedOf(const Proof& proof) {
    const double most = *std::ranges::max_element(proof.expected);
    std::vector<double> scales = proof.expected;
    for (double& scale : scales) scale += 1e-3 * most;
    return writtenTwice(proof.job, proof.expected, scales);
}

void prove(Language language, Run runner = {}) {
    if (!runner) runner = runnerOf(language);
    for (const Proof& proof : proofs()) {
        // The stub of OSL's `texture` knows one mode beyond the edge.
        if (language == Language::osl && proof.sample.wrap == Wrap::repeat) continue;
        std::vector<float> found;
        try {
            found = runner(proof.job, wrapped(language, proof.job, shaderOf(proof, language)));
        } catch (const Missing& reason) {
            GTEST_SKIP() << reason.what();
        } catch (const Refused& reason) {
            FAIL() << proof.sample.name << ": " << reason.what();
        }
        const Gap gap = gapOf(proof, language, found);
        std::cout << fmt::format("{:<48} {:.1e}, at centres {:.1e}\n", proof.sample.name, gap.all,
                                 gap.centres);
        EXPECT_LE(gap.all, bounds.here()) << proof.sample.name << ": " << gap.where;
        EXPECT_LE(gap.centres, bounds.here() / 10) << proof.sample.name;
        keepLast("filtered map", language, proof.sample.name, wantedOf(proof), bounds);
    }
}

TEST(FilteredShader, GlslOnVulkan) {
    prove(Language::glsl);
}
TEST(FilteredShader, HlslOnVulkan) {
    prove(Language::hlsl);
}
TEST(FilteredShader, SlangOnVulkan) {
    prove(Language::slang);
}
TEST(FilteredShader, WgslOnVulkan) {
    prove(Language::wgsl);
}
TEST(FilteredShader, GlslOnOpenGl) {
    prove(Language::glsl, runOpenGl);
}
TEST(FilteredShader, GlslEsOnOpenGlEs) {
    prove(Language::glslEs);
}
TEST(FilteredShader, MetalAsCpp) {
    prove(Language::metal);
}
TEST(FilteredShader, OslAsCpp) {
    prove(Language::osl);
}

/// A shader with a fault gives something else: the test can fail.
TEST(FilteredShader, FaultsShow) {
    const Proof& proof = proofs().back();
    const std::string snippet = shaderOf(proof, Language::metal);
    const std::pair<std::string, std::string> faults[] = {
        {"b0.y * b0.y + (a0.w - t.mx) * (a0.w - t.mx)", "b0.y * b0.y"},
        {"f.x + longer * e.x", "f.x"},
        {"lod - 1.0", "lod"},
        {"p[0 - m] * s[0 - m]", "p[0 - m] * c[0 - m]"},
        {"if (level <= 0.0)", "if (level <= 0.5)"},
    };
    for (const auto& [right, wrong] : faults) {
        const std::string broken = withFault(snippet, right, wrong);
        try {
            const auto found =
                run(Language::metal, proof.job, wrapped(Language::metal, proof.job, broken));
            EXPECT_GT(gapOf(proof, Language::metal, found).all, 10 * bounds.here()) << wrong;
        } catch (const Missing& reason) {
            GTEST_SKIP() << reason.what();
        }
    }
}

/// The reference of these tests agrees with `eval` at centres of texels.
TEST(FilteredShader, CentresAreTheTexelsThatOpenAsBrdfs) {
    for (const Proof& proof : proofs()) {
        const FilteredMap& map = proof.written->map;
        for (std::size_t k = 0; k < 45; k += 3) {
            const Direction &wo = proof.job.pairs.wo[k], &wi = proof.job.pairs.wi[k];
            if (!(wo.z > 0) || !(wi.z > 0)) continue;
            const MapPlace place = placeAt(proof.job, k);
            const auto level = static_cast<std::size_t>(place.level);
            const LevelSize& size = map.sidecar().levels[level];
            const auto brdf = jobs::openFilteredTexel(
                map.file(), level,
                static_cast<std::size_t>(place.u * static_cast<double>(size.width)),
                static_cast<std::size_t>(place.v * static_cast<double>(size.height)));
            std::vector<double> f(proof.job.channels());
            brdf->eval(wo, {&wi.x, &wi.y, &wi.z, 1}, f.data());
            // The place of a centre is rounded to single precision.
            for (std::size_t c = 0; c < f.size(); ++c) {
                const double expected = proof.expected[k * f.size() + c];
                EXPECT_NEAR(f[c] * wi.z, expected, 1e-4 * expected + 1e-6) << proof.sample.name;
            }
        }
    }
}

/// WebGL 2 and WebGPU have 256 layers; the message names the form that fits.
TEST(FilteredShader, HarmonicsOfTooManyLayersAreRefused) {
    const test::TemporaryFolder folder;
    const auto map = written(test::sampleDescriptions().back(), folder.path().string());
    FilteredSidecar sidecar = map->map.sidecar();
    ASSERT_EQ(sidecar.layout.order, 33);
    sidecar.layout.weights = 2;
    ASSERT_GT(sidecar.harmonicLayers(), 256U);
    const LobeText& text = map->text;
    for (const Language language : {Language::wgsl, Language::glslEs}) {
        try {
            filteredShader(language, sidecar, text, {});
            ADD_FAILURE() << "not refused";
        } catch (const UsageError& error) {
            EXPECT_NE(std::string(error.what()).find("ellipse"), std::string::npos) << error.what();
        }
    }
    EXPECT_NO_THROW(filteredShader(Language::hlsl, sidecar, text, {}));
}

}  // namespace
}  // namespace hshfit::shaders
