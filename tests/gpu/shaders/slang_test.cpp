// Slang modules: their differentiable functions, and what slang_rules.h finds. That they run as
// HLSL is held where the other languages are.
#include "../forms/form_samples.h"
#include "slang_rules.h"
#include "variants.h"

#include <hshfit/error.h>
#include <hshfit/gpu/forms/form_shader.h>
#include <hshfit/gpu/slang.h>

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

TEST(Slang, WhatIsNoModuleIsRefused) {
    EXPECT_THROW(gpu::slangModule("float f;\n", "f"), std::logic_error);
    EXPECT_THROW(gpu::slangModule("// HLSL, shader model 5 or 6.\n\n", "a\"b"), UsageError);
}

}  // namespace
}  // namespace hshfit::shaders
