#include "runners.h"
#include "variants.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

namespace hshfit::shaders {
namespace {

using gpu::Language;

/// Relative to the largest value. A GPU blends texels with weights of 8 bits, off by up to 1/512
/// per axis, and neighbouring texels differ by up to twice the largest value. llvmpipe blends bytes
/// into bytes: a step of 1/255 in each of 49 lanes, which add up at random. A lookup in W texels is
/// placed to W 2^-25 for u in [1/2, 1), W 2^-25 for u W and as much for u W - 1/2, per axis;
/// neighbouring texels of noise differ by twice the largest value.
Bounds boundsOf(Language language, const Variant& variant) {
    const gpu::Texels& texels = variant.payload.coefficients;
    const double onGpu = variant.noise ? 2e-2 : texels.width > 1 ? 1e-2 : 1e-5;
    const bool cpp = language == Language::metal || language == Language::osl;
    if (texels.number == gpu::Number::unorm8 && texels.width > 1 && !cpp) return {1e-2, onGpu};
    return {variant.noise ? 2 * 3 * std::ldexp(texels.width + texels.height, -25) : 2e-6, onGpu};
}

std::string snippetOf(Language language, const ShaderJob& job) {
    return gpu::shaderSource(language, job.payload, {.environmentOrder = job.environment.order});
}

void prove(Language language, Run runner = {}) {
    if (!runner) runner = runnerOf(language);
    for (Variant& variant : variants()) {
        // Payloads that OSL does not take.
        if (language == Language::osl &&
            (variant.payload.basisTexels || isNormalised(variant.payload.coefficients.number)))
            continue;
        const Bounds bounds = boundsOf(language, variant);
        const ShaderJob job = makeJob(std::move(variant.payload), variant.environmentOrder);
        std::vector<float> found;
        try {
            found = runner(job, wrapped(language, job, snippetOf(language, job)));
        } catch (const Missing& reason) {
            GTEST_SKIP() << reason.what();
        } catch (const Refused& reason) {
            FAIL() << variant.name << ": " << reason.what();
        }
        const std::vector<double> expected = reference(job);
        const Difference difference = compare(job, expected, found);
        std::cout << fmt::format("{:<48} eval {:.1e}  shade {:.1e}\n", variant.name,
                                 difference.eval, difference.shade);
        EXPECT_LE(difference.eval, bounds.here()) << variant.name;
        EXPECT_LE(difference.shade, bounds.here()) << variant.name;
        keepLast("coefficients", language, variant.name, wantedOf(job, expected), bounds);
    }
}

TEST(ShaderProof, GlslOnVulkan) {
    prove(Language::glsl);
}
TEST(ShaderProof, HlslOnVulkan) {
    prove(Language::hlsl);
}
TEST(ShaderProof, SlangOnVulkan) {
    prove(Language::slang);
}
TEST(ShaderProof, WgslOnVulkan) {
    prove(Language::wgsl);
}
TEST(ShaderProof, GlslOnOpenGl) {
    prove(Language::glsl, runOpenGl);
}
TEST(ShaderProof, GlslEsOnOpenGlEs) {
    prove(Language::glslEs);
}
TEST(ShaderProof, MetalAsCpp) {
    prove(Language::metal);
}
TEST(ShaderProof, OslAsCpp) {
    prove(Language::osl);
}

/// kd / pi is one coefficient of HSH, kd / pi sqrt(2 pi); a constant light is one of SH, sqrt(4 pi)
/// times its radiance. The result is kd times the radiance, in every direction.
TEST(ShaderProof, LambertUnderAConstantLight) {
    constexpr double kd[] = {0.75, 0.5, 0.25};
    Coefficients c;
    c.basis = "hsh";
    c.order = 3;
    c.channels = Channels::rgb();
    c.outgoing = OutgoingSet::parabolic(8, 8);
    c.values.assign(64 * 3 * 9, 0.0);
    for (std::size_t p = 0; p < 64; ++p)
        for (std::size_t i = 0; i < 3; ++i) c.at(p, i)[0] = kd[i] / pi * std::sqrt(2 * pi);
    ShaderJob job = makeJob(gpu::pack(c, {.number = gpu::Number::float32}), 5);
    constexpr double radiance[] = {1, 2, 4};
    for (std::size_t k = 0; k < job.environment.values.size(); ++k)
        job.environment.values[k] = k < 3 ? radiance[k] * std::sqrt(4 * pi) : 0;
    for (const gpu::LanguageEntry& entry : gpu::languages()) {
        std::vector<float> found;
        try {
            found = run(entry.language, job,
                        wrapped(entry.language, job, snippetOf(entry.language, job)));
        } catch (const Missing& reason) {
            std::cout << entry.name << " not checked: " << reason.what() << '\n';
            continue;
        }
        for (std::size_t k = 0; k < job.pairs.wo.size(); ++k) {
            const bool above = job.pairs.wo[k].z > 0;
            for (std::size_t i = 0; i < 3; ++i) {
                const double f = above && job.pairs.wi[k].z > 0 ? kd[i] / pi : 0;
                ASSERT_NEAR(found[9 * k + i], f, 1e-6) << entry.name;
                ASSERT_NEAR(found[9 * k + 6 + i], above ? kd[i] * radiance[i] : 0, 2e-6)
                    << entry.name;
            }
        }
    }
}

}  // namespace
}  // namespace hshfit::shaders
