// One shader for the materials of a library, in every language, against the library's BRDFs.

#include "../shaders/runners.h"

#include <hshfit/error.h>
#include <hshfit/gpu/forms/library_shader.h>
#include <hshfit/material_library/log_terms.h>
#include <hshfit/material_library/shared_functions.h>

#include <brdfs/catalog.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>

namespace hshfit::shaders {
namespace {

namespace ml = material_library;
using gpu::Language;

/// Ten materials, grey ones among them, in a basis of six components.
const ml::Library& library() {
    static const ml::Library made = [] {
        const ml::LogSpace space;
        std::vector<ml::Measured> measured;
        for (const char* spec :
             {"lambert:kd=.3/.2/.1", "ggx:alpha=.2,F0=.9/.6/.3", "ggx:alpha=.1,F0=.05,kd=.4/.3/.1",
              "phong:exponent=40,ks=.3,kd=.2", "oren-nayar:sigma=.5", "ggx:alpha=.5,F0=.4",
              "beckmann:alpha=.3,F0=.9/.8/.7", "charlie:r=.4", "eon:roughness=.8",
              "lambert:kd=.02/.3/.02+ggx:alpha=.3,F0=.04"})
            measured.push_back(space.project(*brdfs::open(spec),
                                             fmt::format("m{}", measured.size()), spec, false));
        ml::LearnOptions options;
        options.components = 6;
        options.bytes = 60;
        return ml::learn(space, std::move(measured), {}, options,
                         {.log = 10, .maximum = 10, .flip = 10});
    }();
    return made;
}

gpu::SharedSums sums() {
    gpu::SharedSums all{.functions = ml::sharedFunctions(library().basis),
                        .offset = ml::logOffset,
                        .topFirst = std::log(ml::logOffset),
                        .topStep = 1 / ml::topsPerLog,
                        .parts = {},
                        .materials = {}};
    for (const auto& [function, scale] : ml::texelParts(library().basis))
        all.parts.push_back({function, scale});
    for (const ml::Material& material : library().materials) {
        const std::vector<double> row = ml::texelsOf(library().basis, material);
        all.materials.insert(all.materials.end(), row.begin(), row.end());
    }
    return all;
}

/// The evaluation that the runners call, of one material.
std::string evaluationOf(Language language, std::size_t material) {
    switch (language) {
        case Language::hlsl:
        case Language::slang:
            return fmt::format(
                "\nfloat3 hsh_eval(float3 wo, float3 wi) {{ return hsh_material({}, wo, wi); }}\n",
                material);
        case Language::wgsl:
            return fmt::format(
                "\nfn hsh_eval(wo: vec3<f32>, wi: vec3<f32>) -> vec3<f32> {{ return "
                "hsh_material({}, wo, wi); }}\n",
                material);
        case Language::metal:
            return fmt::format(
                "\ninline float3 hsh_eval(texture2d_array<float> coefficients, float3 wo, float3 "
                "wi) "
                "{{ return hsh_material(coefficients, {}, wo, wi); }}\n",
                material);
        default:
            return fmt::format(
                "\nvec3 hsh_eval(vec3 wo, vec3 wi) {{ return hsh_material({}, wo, wi); }}\n",
                material);
    }
}

/// A unit vector whose components are floats.
Direction rounded(const Direction& d) {
    const double length = std::hypot(d.x, d.y, d.z);
    const auto part = [&](double x) { return double{static_cast<float>(x / length)}; };
    return {part(d.x), part(d.y), part(d.z)};
}

/// Those of all forms; of every four, one of mirror directions, one within a thousandth of a radian
/// of these, and one with wi within a tenth of a degree of the horizon.
Pairs pairsWithLobes() {
    Pairs pairs = directionPairs();
    for (std::size_t k = 0; k < pairs.wi.size(); ++k) {
        const Direction &wo = pairs.wo[k], &wi = pairs.wi[k];
        if (k % 4 == 1) pairs.wi[k] = {-wo.x, -wo.y, wo.z};
        if (k % 4 == 2) pairs.wi[k] = rounded({-wo.x + 7e-4, -wo.y, wo.z});
        if (k % 4 == 3) pairs.wi[k] = rounded({wi.x, wi.y, 1.5e-3 * std::hypot(wi.x, wi.y)});
    }
    return pairs;
}

void prove(Language language, const gpu::SharedSums& all, double bound) {
    ASSERT_EQ(all.count(), library().materials.size());
    ASSERT_GT(all.stride(), 7u);
    ShaderJob job{{}, pairsWithLobes(), {.order = 0, .colours = 0, .values = {}}};
    job.payload.head.channels = Channels::rgb();
    job.payload.coefficients = gpu::materialTexels(all);
    job.form = "texture";
    const std::string source = gpu::libraryShaderSource(language, all, "hsh");
    for (const std::size_t n : {std::size_t{0}, std::size_t{3}, all.count() - 1}) {
        std::vector<float> found;
        try {
            found =
                runnerOf(language)(job, wrapped(language, job, source + evaluationOf(language, n)));
        } catch (const Missing& reason) {
            GTEST_SKIP() << reason.what();
        } catch (const Refused& reason) {
            FAIL() << reason.what();
        }
        const auto brdf = ml::open(library(), library().materials[n], "material");
        double worst = 0, sum = 0;
        for (std::size_t k = 0; k < job.pairs.wo.size(); ++k) {
            const Direction& wi = job.pairs.wi[k];
            std::vector<double> f(brdf->channels().count());
            brdf->eval(job.pairs.wo[k], {&wi.x, &wi.y, &wi.z, 1}, f.data());
            f.resize(3, f[0]);
            for (std::size_t c = 0; c < 3; ++c) {
                const double error = std::abs(found[6 * k + c] - f[c]) / (0.01 + f[c]);
                worst = std::max(worst, error);
                sum += error;
            }
        }
        std::cout << fmt::format("{} mean {:.1e}, largest {:.1e}\n", library().materials[n].name,
                                 sum / static_cast<double>(3 * job.pairs.wo.size()), worst);
        EXPECT_LE(worst, bound) << library().materials[n].name;
    }
}

/// Texels of functions are exact; halves of a material's own coefficients are rounded.
void prove(Language language) {
    prove(language, sums(), 2e-4);
    prove(language, gpu::foldedSums(sums()), 2e-2);
}

TEST(LibraryShader, GlslOnVulkan) {
    prove(Language::glsl);
}
TEST(LibraryShader, HlslOnVulkan) {
    prove(Language::hlsl);
}
TEST(LibraryShader, SlangOnVulkan) {
    prove(Language::slang);
}
TEST(LibraryShader, WgslOnVulkan) {
    prove(Language::wgsl);
}
TEST(LibraryShader, GlslEsOnOpenGlEs) {
    prove(Language::glslEs);
}
TEST(LibraryShader, MetalAsCpp) {
    prove(Language::metal);
}
TEST(LibraryShader, OslHasNone) {
    EXPECT_THROW(gpu::libraryShaderSource(Language::osl, sums(), "hsh"), UsageError);
}

// Components of more than 12 bits have two texels.
TEST(LibraryShader, TexelsHoldTheNumbersExactly) {
    const ml::Basis& basis = library().basis;
    EXPECT_GT(*std::ranges::max_element(basis.widths), 12);
    const std::vector<ml::TexelPart> parts = ml::texelParts(basis);
    const gpu::SharedSums all = sums();
    const std::vector<double> read = gpu::decode(gpu::materialTexels(all));
    for (std::size_t n = 0; n < all.count(); ++n) {
        const ml::Material& material = library().materials[n];
        for (std::size_t c = 0; c < material.channels; ++c) {
            const std::size_t bytes = basis.channelBytes();
            const ml::ChannelCode code =
                ml::unpack(basis, std::span(material.codes).subspan(c * bytes, bytes));
            std::vector<double> sum(basis.size(), 0.0);
            const std::size_t first = 4 * n * all.stride() + c;
            for (std::size_t p = 0; p < parts.size(); ++p)
                sum[parts[p].function - 1] += parts[p].scale * read[first + 4 * p];
            for (std::size_t k = 0; k < basis.size(); ++k)
                EXPECT_NEAR(sum[k], code.coordinates[k] / basis.step, 1e-6) << n << " " << k;
            EXPECT_NEAR(all.topFirst + all.topStep * read[first + 4 * parts.size()], code.top,
                        1e-12);
        }
    }
}

}  // namespace
}  // namespace hshfit::shaders
