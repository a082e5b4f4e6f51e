// Files with a material for an engine: rows, words and refusals; HLSL by glslang. Pictures:
// tests/gpu/renderers.
#include "asymmetric.h"

#include <hshfit/error.h>
#include <hshfit/gpu/containers/targets.h>
#include <hshfit/gpu/engines/engine_files.h>
#include <hshfit/lighting/prefilter.h>

#include <gtest/gtest.h>

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>

namespace hshfit::gpu {
namespace {

/// Coefficients per outgoing direction.
EngineMaterial sampled(const EngineFile& row, const Channels& channels) {
    const Payload payload =
        pack(samples::asymmetric("hsh", 3, OutgoingSet::parabolic(8, 8), channels, 1), {});
    return {.name = "paint",
            .title = "a \"lacquer\" */ `${x}",
            .prefix = "hsh",
            .snippet = shaderSource(row.language, payload, {.environmentOrder = 0}),
            .texels = samplerTexels(payload.coefficients)};
}

/// A formula with its numbers in the text.
EngineMaterial constant() {
    return {.name = "paint",
            .title = "grey",
            .prefix = "hsh",
            .snippet = "float hsh_eval(float3 wo, float3 wi) {\n    return 0.3 * wo.z;\n}\n"};
}

TEST(EngineFiles, RowsAreThoseOfTheTargets) {
    std::set<std::string_view> modules, rows;
    for (const Target& target : targets())
        if (target.kind == Target::Kind::module && target.name != "three")
            modules.insert(target.name);
    for (const EngineFile& row : engineFiles()) {
        rows.insert(row.target);
        if (!row.prefilter.empty()) {
            EXPECT_NO_THROW(lighting::prefilterNamed(row.prefilter)) << row.suffix;
        }
    }
    EXPECT_EQ(rows, modules);
}

TEST(EngineFiles, WordsAreFilledInAndEndNothingEarly) {
    for (const EngineFile& row : engineFiles()) {
        if (!row.textures) continue;
        for (const Channels& channels : {Channels::grey(), Channels::rgb()}) {
            EngineMaterial material = sampled(row, channels);
            material.lookUps = "vec3 hsh_prefiltered(vec3 n, vec3 wo) { return n; } // `${x}\n";
            material.lookUpTexels.assign(8, 0.5F);
            material.lookUpWidth = 2;
            material.lookUpHeight = 1;
            const std::string text = engineFile(row, material);
            EXPECT_EQ(text.find("{{"), text.npos) << row.suffix << ": a word is not filled in";
            EXPECT_NE(text.find("hsh_eval"), text.npos) << row.suffix;
            EXPECT_EQ(text.find("*/ `"), text.npos) << row.suffix << ": a comment ends early";
            if (row.script) {
                EXPECT_EQ(text.find("// `$"), text.npos) << row.suffix << ": a literal ends early";
            }
        }
    }
}

TEST(EngineFiles, RefusalsSayWhatWouldBeRight) {
    const EngineFile* constants = nullptr;
    for (const EngineFile& row : engineFiles())
        if (!row.textures) constants = &row;
    ASSERT_NE(constants, nullptr);
    try {
        engineFile(*constants, sampled(*constants, Channels::rgb()));
        FAIL() << "a texture is taken";
    } catch (const UsageError& error) {
        EXPECT_NE(std::string(error.what()).find("form halfway"), std::string::npos);
    }
    EXPECT_NO_THROW(engineFile(*constants, constant()));
    for (const char* name : {"", "a b", "../a", "a'b", "a\"", "a\n"}) {
        EngineMaterial material = constant();
        material.name = name;
        EXPECT_THROW(engineFile(*constants, material), UsageError) << name;
    }
}

/// The exit code of a compiler with `file` and an output after its options, or 77 where it is not
/// installed.
int compiled(const std::string& program, const std::string& options, const std::string& file,
             const std::string& text) {
    const auto folder =
        std::filesystem::temp_directory_path() /
        ("hshfit-engines-" + std::to_string(::testing::UnitTest::GetInstance()->random_seed()) +
         std::to_string(getpid()));
    std::filesystem::create_directories(folder);
    std::ofstream(folder / file) << text;
    const std::string line = "command -v " + program + " >/dev/null || exit 77; " + program + " " +
                             options + " -o " + (folder / "compiled").string() + " " +
                             (folder / file).string();
    const int status = std::system(line.c_str());
    std::filesystem::remove_all(folder);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

/// Whether glslang takes a pixel shader of HLSL.
int compiles(const std::string& text) {
    return compiled("glslangValidator", "-D -e main -V -S frag", "a.frag", text);
}

/// The head and the main of an engine's editor around its file.
std::string program(const EngineFile& row, const std::string& text, bool textures) {
    const std::string inputs =
        "float3 n : NORMAL, float3 a : TANGENT, float3 v : VIEW, float3 l : LIGHT";
    if (row.suffix == "_unreal.ush") {
        const std::string set = textures ? "m.strip = Strip; m.stripSampler = StripSampler; " : "";
        // A sampler of the snippet's own would be no declaration then.
        return "#define hsh_sampler 1\nTexture2D Strip;\nSamplerState StripSampler;\n" + text +
               "float4 main(" + inputs + ") : SV_Target { HshfitMaterial m; " + set +
               "return float4(m.reflected(n, a, v, l), 1.0); }\n";
    }
    const std::string set = textures ? ", array" : "";
    return "#define hsh_sampler 1\nstruct UnityTexture2DArray { Texture2DArray<float4> tex; "
           "SamplerState samplerstate; "
           "};\n"
           "#define half3 float3\n"
           "#define SAMPLE_TEXTURE2D_ARRAY_LOD(t, s, uv, k, l) t.SampleLevel(s, float3(uv, k), l)\n"
           "Texture2DArray<float4> Array; SamplerState ArraySampler;\n" +
           text + "float4 main(" + inputs +
           ") : SV_Target { UnityTexture2DArray array; array.tex = Array; array.samplerstate = "
           "ArraySampler; "
           "float3 f; Hshfit_float(n, a, v, l" +
           set + ", f); return float4(f, 1.0); }\n";
}

TEST(EngineFiles, HlslOfUnrealAndOfGraphsCompiles) {
    if (compiles("float4 main() : SV_Target { return 0.0; }\n") == 77)
        GTEST_SKIP() << "glslangValidator is not installed (glslang-tools)";
    ASSERT_NE(compiles("float4 main() : SV_Target { return nothing; }\n"), 0);
    for (const EngineFile& row : engineFiles()) {
        if (row.suffix != "_unreal.ush" && row.suffix != "_graph.hlsl") continue;
        EXPECT_EQ(compiles(program(row, engineFile(row, constant()), false)), 0) << row.suffix;
        EXPECT_EQ(compiles(program(row, engineFile(row, sampled(row, Channels::rgb())), true)), 0)
            << row.suffix;
    }
}

TEST(EngineFiles, FilamentsCompilerTakesTheMaterial) {
    const auto takes = [](const EngineMaterial& material) {
        const auto row = std::ranges::find(engineFiles(), "filament", &EngineFile::target);
        return compiled("matc", "-p mobile", "a.mat", engineFile(*row, material));
    };
    EngineMaterial material = constant();
    material.snippet = "float hsh_eval(vec3 wo, vec3 wi) { return 0.3 * wo.z; }\n";
    const int found = takes(material);
    if (found == 77) GTEST_SKIP() << "matc is not installed (libfilament-tools)";
    EXPECT_EQ(found, 0);
    for (const bool along : {false, true}) {
        material.lookUps = std::string("vec3 hsh_prefiltered(vec3 n, ") +
                           (along ? "vec3 tangent, " : "") +
                           "vec3 wo) { return HSH_PREFILTERED_TEXEL(1, 0).xyz * "
                           "HSH_PREFILTERED_LIGHT(n, wo.z).xyz; }\n";
        material.along = along;
        material.lookUpTexels.assign(8, 0.5F);
        material.lookUpWidth = 2;
        material.lookUpHeight = 1;
        EXPECT_EQ(takes(material), 0) << along;
    }
    material.snippet = "float hsh_eval(vec3 wo, vec3 wi) { return nothing; }\n";
    EXPECT_NE(takes(material), 0);
}

}  // namespace
}  // namespace hshfit::gpu
