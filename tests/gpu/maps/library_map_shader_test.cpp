// Shaders of maps of coordinates in a library, in seven languages on the renderers in software,
// against sums in double precision, and at centres of texels against the texels' BRDFs.

#include "../filtered_maps/sample_descriptions.h"
#include "../shaders/runners.h"
#include "map_places.h"
#include "sample_maps.h"
#include "temporary_folder.h"

#include <hshfit/error.h>
#include <hshfit/gpu/vulkan/spirv.h>
#include <hshfit/library_maps/exports/library_map_shader.h>

#include <jobs/maps/library_svbrdf.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <random>

namespace hshfit::shaders {
namespace {

using gpu::Language;

struct Sample {
    std::string name, parameters, precision = "float16";
    std::size_t width = 16, height = 8, components = 6;
};
std::vector<Sample> samples() {
    return {{.name = "colours",
             .parameters = R"({"alpha": "@a:0.2:0.6", "kd": "@rgb:0.05:0.6", "F0": 0.05})"},
            {.name = "grey, float32",
             .parameters = R"({"alpha": "@a:0.2:0.6", "kd": 0.3, "F0": "@f:0.02:0.9"})",
             .precision = "float32",
             .width = 4,
             .height = 16,
             .components = 3}};
}

/// A map with its job, and the values that are expected: [pair][channel].
struct Proof {
    Sample sample;
    std::unique_ptr<LibraryMap> map;
    MapFunctions functions;
    ShaderJob job;
    std::vector<double> expected = {};
    std::vector<double> texels = {};  ///< of the BRDF of the texel at whose centre a place is

    MapPlace place(std::size_t k) const {
        return {job.places[3 * k], job.places[3 * k + 1], job.places[3 * k + 2]};
    }
};

ShaderJob jobOf(const LibraryMap& map, const MapFunctions& functions) {
    const LibrarySidecar& s = map.sidecar();
    const auto level = [&](std::size_t k) {
        gpu::Texels of;
        of.width = static_cast<int>(s.levels[k].width);
        of.height = static_cast<int>(s.levels[k].height);
        of.layers = s.layout.layers();
        of.number = s.number;
        of.bytes = {map.texture().level(k).begin(), map.texture().level(k).end()};
        return of;
    };
    gpu::Payload payload;
    payload.head.channels = s.channels;
    payload.coefficients = level(0);
    ShaderJob job = makeJob(std::move(payload), 1);
    job.form = "library";  // without light
    for (std::size_t k = 1; k < s.levels.size(); ++k) job.levels.push_back(level(k));
    job.harmonics.push_back(functions.sums.table->texels());
    job.places = test::mapPlaces(s.levels, job.pairs.wo.size(), 0.2);
    return job;
}

void addExpected(Proof& proof) {
    const auto& levels = proof.map->sidecar().levels;
    for (std::size_t k = 0; k < proof.job.pairs.wo.size(); ++k) {
        const Direction &wo = proof.job.pairs.wo[k], &wi = proof.job.pairs.wi[k];
        const MapPlace place = proof.place(k);
        const std::vector<double> f =
            mapValue(*proof.map, proof.functions, place, Wrap::clamp, wo, wi);
        proof.expected.insert(proof.expected.end(), f.begin(), f.end());
        std::vector<double> texel(f.size(), std::nan(""));
        if (k % 3 == 0) {
            const auto level = static_cast<std::size_t>(place.level);
            const auto at = [&](double u, std::size_t side) {
                return static_cast<std::size_t>(u * static_cast<double>(side));
            };
            texel = evaluate(*proof.map->texel(level, at(place.u, levels[level].width),
                                               at(place.v, levels[level].height)),
                             wi, wo);
        }
        proof.texels.insert(proof.texels.end(), texel.begin(), texel.end());
    }
}

const std::vector<Proof>& proofs() {
    static const test::TemporaryFolder folder;
    static const std::vector<Proof> all = [] {
        std::vector<Proof> made;
        for (const Sample& sample : samples()) {
            const std::string place = folder / std::to_string(made.size());
            std::filesystem::create_directory(place);
            const std::string description = test::writeDescription({.name = sample.name,
                                                                    .model = "ggx",
                                                                    .parameters = sample.parameters,
                                                                    .width = sample.width,
                                                                    .height = sample.height,
                                                                    .turned = false},
                                                                   place);
            jobs::SvbrdfOptions options;
            options.form = "library";
            options.precision = sample.precision;
            options.components = sample.components;
            options.checks = 0;
            jobs::librarySvbrdf(description, place + "/map", options);
            auto map = std::make_unique<LibraryMap>(place + "/map/material.json");
            MapFunctions functions = tabledFunctions(*map);
            ShaderJob job = jobOf(*map, functions);
            made.push_back({sample, std::move(map), std::move(functions), std::move(job)});
            addExpected(made.back());
        }
        return made;
    }();
    return all;
}

/// Largest differences of ln(f + 0.001): of all, and at centres from the texels' BRDFs.
struct Gap {
    double all = 0, texels = 0;
};
Gap gapOf(const Proof& proof, Language language, const std::vector<float>& found) {
    const std::size_t channels = proof.job.channels();
    const auto last = static_cast<double>(mostLevel(language, proof.map->sidecar().levels));
    Gap gap;
    for (std::size_t k = 0; k < proof.job.pairs.wo.size(); ++k) {
        // Beyond the last level of OSL there is another value.
        if (language == Language::osl && proof.place(k).level > last) continue;
        for (std::size_t c = 0; c < channels; ++c) {
            const double value = static_cast<double>(found[k * proof.job.outputs() + c]);
            const auto off = [&](double from) {
                const double d = std::abs(std::log((value + 1e-3) / (from + 1e-3)));
                return d < 1e30 ? d : 1e30;
            };
            gap.all = std::max(gap.all, off(proof.expected[k * channels + c]));
            const double texel = proof.texels[k * channels + c];
            const double lowest = std::min(proof.job.pairs.wo[k].z, proof.job.pairs.wi[k].z);
            // tableError has pairs from a thousandth above the horizon on.
            if (!std::isnan(texel) && lowest > 1e-3) gap.texels = std::max(gap.texels, off(texel));
        }
    }
    return gap;
}

/// In single precision, on maps whose neighbours have nothing in common; a GPU may blend with
/// weights of 8 bits.
constexpr Bounds bounds{2e-3, 5e-2};

/// Differences of f relative to f + 0.001, which equal differences of ln(f + 0.001) as long as both
/// are small.
Wanted wantedOf(const Proof& proof) {
    std::vector<double> scales = proof.expected;
    for (double& scale : scales) scale += 1e-3;
    return writtenTwice(proof.job, proof.expected, scales);
}

void prove(Language language, Run runner = {}) {
    if (!runner) runner = runnerOf(language);
    for (const Proof& proof : proofs()) {
        const std::string snippet = libraryMapShader(language, *proof.map, proof.functions, {});
        std::vector<float> found;
        try {
            found = runner(proof.job, wrapped(language, proof.job, snippet));
        } catch (const Missing& reason) {
            GTEST_SKIP() << reason.what();
        } catch (const Refused& reason) {
            FAIL() << proof.sample.name << ": " << reason.what();
        }
        const Gap gap = gapOf(proof, language, found);
        std::cout << fmt::format("{:<20} sums {:.1e}  texels {:.3f}, stated {:.3f}\n",
                                 proof.sample.name, gap.all, gap.texels,
                                 proof.functions.error.largest);
        EXPECT_LE(gap.all, bounds.here()) << proof.sample.name;
        EXPECT_LE(gap.texels, 1.5 * proof.functions.error.largest) << proof.sample.name;
        keepLast("library map", language, proof.sample.name, wantedOf(proof), bounds);
    }
}

TEST(LibraryMapShader, GlslOnVulkan) {
    prove(Language::glsl);
}
TEST(LibraryMapShader, HlslOnVulkan) {
    prove(Language::hlsl);
}
TEST(LibraryMapShader, SlangOnVulkan) {
    prove(Language::slang);
}
TEST(LibraryMapShader, WgslOnVulkan) {
    prove(Language::wgsl);
}
TEST(LibraryMapShader, GlslOnOpenGl) {
    prove(Language::glsl, runOpenGl);
}
TEST(LibraryMapShader, GlslEsOnOpenGlEs) {
    prove(Language::glslEs);
}
TEST(LibraryMapShader, MetalAsCpp) {
    prove(Language::metal);
}
TEST(LibraryMapShader, OslAsCpp) {
    prove(Language::osl);
}

/// A shader with a fault gives something else: the test can fail.
TEST(LibraryMapShader, FaultsShow) {
    const Proof& proof = proofs().front();
    const std::string snippet = libraryMapShader(Language::metal, *proof.map, proof.functions, {});
    const std::pair<std::string, std::string> faults[] = {
        {"level(lod)", "level(0.0f)"},
        {"3 * g + 2, lod", "3 * g + 1, lod"},
        {"uv, 0, lod", "uv, 1, lod"},
        {"weight * (upper - lower)", "(upper - lower)"},
    };
    for (const auto& [right, wrong] : faults) {
        const std::string broken = withFault(snippet, right, wrong);
        try {
            const auto found =
                run(Language::metal, proof.job, wrapped(Language::metal, proof.job, broken));
            EXPECT_GT(gapOf(proof, Language::metal, found).all, 5 * bounds.here()) << wrong;
        } catch (const Missing& reason) {
            GTEST_SKIP() << reason.what();
        }
    }
}

/// A map of another form has the light of an environment: both are functions of one program.
TEST(LibraryMapShader, GoesWithTheShaderOfAnotherMap) {
    if (!gpu::compilesGlsl()) GTEST_SKIP() << "built without glslang";
    const test::TemporaryFolder folder;
    const auto other = test::writeSampleMap(
        {.name = "other", .form = "low-rank", .width = 8, .height = 8}, folder.path().string());
    const Proof& proof = proofs().front();
    const auto source = [&](const std::string& prefix) {
        return "#version 450\n#define SKY_MAP_BINDING binding = 3\n#define SKY_SHARED_BINDING "
               "binding = 4\nlayout(local_size_x = 1) in;\n" +
               libraryMapShader(Language::glsl, *proof.map, proof.functions, {}) +
               mapShader(Language::glsl, other->sidecar(),
                         {.prefix = prefix, .environmentOrder = 3}) +
               "layout(binding = 5) buffer Out { vec4 q; };\nvoid main() {\n    vec3 n = vec3(0.0, "
               "0.0, 1.0);\n    vec3 env[9];\n    for (int k = 0; k < 9; k++) "
               "env[k] = n;\n    q = vec4(hsh_eval(vec2(0.5), 0.0, n, n) + sky_shade(vec2(0.5), "
               "0.0, "
               "n, env), 1.0);\n}\n";
    };
    EXPECT_NO_THROW(gpu::compileGlsl(source("sky")));
    EXPECT_THROW(gpu::compileGlsl(source("hsh")), NumericError);
}

}  // namespace
}  // namespace hshfit::shaders
