// Slang modules: their differentiable functions, the findings of slang_rules.h, and modules of
// lighting run as HLSL. The tests of the other languages run the other modules as HLSL.
#include "../forms/form_samples.h"
#include "runners.h"
#include "slang_rules.h"
#include "variants.h"

#include <hshfit/error.h>
#include <hshfit/gpu/forms/form_shader.h>
#include <hshfit/gpu/slang.h>
#include <hshfit/lighting/lighting_shader.h>

#include <gtest/gtest.h>

#include <regex>
#include <utility>

namespace hshfit::shaders {
namespace {

using gpu::Language;

std::string moduleOf(const gpu::FormPayload& payload, gpu::Storage storage) {
    return gpu::fileText(Language::slang,
                         gpu::formShaderSource(Language::slang, payload, {.storage = storage}),
                         "paint 1_hsh");
}

// Lookups have no derivative, and a struct would have to state its own.
TEST(Slang, FormsOfConstantsAreDifferentiableAndNothingElse) {
    for (const samples::FormSample& sample : samples::halfwaySamples()) {
        if (!sample.form.added.empty()) continue;
        const gpu::FormPayload payload = gpu::packForm(sample.form);
        const bool spectral = payload.form.head.channels.kind == Channels::Kind::spectral;
        for (const gpu::Storage storage :
             {gpu::Storage::constants, gpu::Storage::block, gpu::Storage::texture})
            EXPECT_EQ(moduleOf(payload, storage).find("[Differentiable]\npublic float") !=
                          std::string::npos,
                      storage == gpu::Storage::constants && !spectral)
                << sample.name;
    }
    const std::string text = gpu::shaderSource(Language::slang, variants().front().payload, {});
    EXPECT_EQ(gpu::slangModule(text, "m").find("[Differentiable]"), std::string::npos);
}

TEST(Slang, BreachesAreFound) {
    const std::string text =
        moduleOf(gpu::packForm(samples::halfwaySamples().front().form), gpu::Storage::constants);
    ASSERT_TRUE(breachesOf(text).empty()) << breachesOf(text).front();
    ASSERT_NE(text.find("no_diff step("), text.npos);
    for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
             {"module \"paint 1_hsh\";\n", ""},
             {"public float3 hsh_eval", "float3 hsh_eval"},
             {"no_diff step", "step"},
             {"abs\\(wi.z\\)", "no_diff abs(wi.z)"},
             {"abs\\(wi.z\\)", "floor(wi.z)"},
             {"\\}\n$", ""}}) {
        const std::string broken = std::regex_replace(text, std::regex(from), to);
        EXPECT_NE(broken, text) << from;
        EXPECT_FALSE(breachesOf(broken).empty()) << from;
    }
}

/// A compute shader around a lighting module without Slang's words, with the registers that it
/// needs.
std::string lightingProgram(const lighting::LightingShader& shader, const std::string& call) {
    std::string text = moduleAsHlsl(lighting::lightingShaderSource(Language::slang, shader));
    text =
        std::regex_replace(text, std::regex(R"((Texture2D<float4> \w+);)"), "$1 : register(t0);");
    text =
        std::regex_replace(text, std::regex(R"((TextureCube<float4> \w+);)"), "$1 : register(t2);");
    return text +
           "RWStructuredBuffer<float4> result : register(u4);\n"
           "[numthreads(1, 1, 1)]\n"
           "void main(uint3 id : SV_DispatchThreadID) {\n"
           "    float3 n = float3(0.0, 0.0, 1.0), wo = normalize(float3(id.x, 1.0, 2.0)), "
           "light[9];\n"
           "    for (int k = 0; k < 9; ++k) light[k] = n;\n"
           "    result[id.x] = float4(" +
           call + ", 1.0);\n}\n";
}

TEST(Slang, LightingModulesKeepTheRulesAndCompileAsHlsl) {
    using Kind = lighting::LightingShader::Kind;
    const std::pair<Kind, std::string> models[] = {
        {Kind::coefficients, "hsh_coefficients(n, wo, light)"},
        {Kind::splitSum, "hsh_splitSum(n, wo, light)"},
        {Kind::cosines, "hsh_ltc(n, wo, n, wo, -n, -wo)"},
        {Kind::prefiltered, "hsh_prefiltered(n, wo)"}};
    for (const auto& [kind, call] : models) {
        lighting::LightingShader shader;
        shader.kind = kind;
        shader.order = 3;
        shader.levels = 6;
        shader.engine = &lighting::prefilterNamed("three");
        shader.lobes = 2;
        shader.texels = 5;
        try {
            EXPECT_FALSE(toSpirv(Language::hlsl, lightingProgram(shader, call)).empty()) << call;
            EXPECT_THROW(toSpirv(Language::hlsl, lightingProgram(shader, "nothing(n)")), Refused);
        } catch (const Missing& missing) {
            GTEST_SKIP() << missing.what();
        } catch (const Refused& refused) {
            ADD_FAILURE() << call << ": " << refused.what();
        }
    }
}

TEST(Slang, WhatIsNoModuleIsRefused) {
    EXPECT_THROW(gpu::slangModule("float f;\n", "f"), std::logic_error);
    EXPECT_THROW(gpu::slangModule("// HLSL, shader model 5 or 6.\n\n", "a\"b"), UsageError);
}

}  // namespace
}  // namespace hshfit::shaders
