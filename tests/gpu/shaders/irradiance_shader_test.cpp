// The functions that engines are given for nine coefficients, compiled and run on Vulkan.

#include "runners.h"
#include "variants.h"

#include <hshfit/irradiance/conventions.h>
#include <hshfit/irradiance/geomerics.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string_view>

namespace hshfit::shaders {
namespace {

/// A compute shader that writes the function's value at wi of every pair, in place of `shade`.
std::string program(const Convention& convention, const ShaderJob& job,
                    const std::string& function) {
    const bool hlsl = convention.hlsl;
    const std::string name = convention.name == "three" ? "irradiance" : "irradianceOverPi";
    const std::string body = fmt::format(
        "    int k = int({}.x);\n"
        "    {} e = {}({}(inputs[6 * k + 3], inputs[6 * k + 4], inputs[6 * k + 5]));\n"
        "    for (int i = 0; i < {}; ++i) outputs[k * {} + i] = i < {} ? 0.0 : e[i - {}];\n}}\n",
        hlsl ? "id" : "gl_GlobalInvocationID", hlsl ? "float3" : "vec3", name,
        hlsl ? "float3" : "vec3", job.outputs(), job.outputs(), 2 * job.channels(),
        2 * job.channels());
    if (hlsl) {
        return function +
               "RWStructuredBuffer<float> inputs : register(u3);\n"
               "RWStructuredBuffer<float> outputs : register(u4);\n"
               "[numthreads(64, 1, 1)]\nvoid main(uint3 id : SV_DispatchThreadID) {\n" +
               body;
    }
    return "#version 450\n" + function +
           "layout(local_size_x = 64) in;\n"
           "layout(std430, binding = 3) readonly buffer Input { float inputs[]; };\n"
           "layout(std430, binding = 4) writeonly buffer Output { float outputs[]; };\n"
           "void main() {\n" +
           body;
}

/// Coefficients of radiance that is positive, so that functions that clamp change nothing.
NineRgb someLight() {
    NineRgb nine{};
    nine[0] = {3.5, 3.7, 4.1};
    for (std::size_t k = 1; k < 9; ++k)
        for (std::size_t c = 0; c < 3; ++c)
            nine[k][c] = 0.3 * std::sin(static_cast<double>(7 * k + 3 * c + 1));
    return nine;
}

TEST(IrradianceShaders, RunAndGiveTheIrradianceOfEveryEngine) {
    const NineRgb radiance = someLight(), irradiance = irradianceOf(radiance);
    for (const Convention& convention : conventions()) {
        ShaderJob job = makeJob(variants().front().payload, 2);
        const std::vector<Direction> normals = normalLattice(job.pairs.wi.size());
        for (std::size_t k = 0; k < normals.size(); ++k)
            job.pairs.wi[k] = convention.toEngine(normals[k]);
        const gpu::Language language = convention.hlsl ? gpu::Language::hlsl : gpu::Language::glsl;
        std::vector<float> found;
        try {
            const std::string source = program(convention, job, engineShader(convention, radiance));
            found = runVulkan(job, toSpirv(language, source), language == gpu::Language::glsl);
        } catch (const Missing& reason) {
            GTEST_SKIP() << reason.what();
        } catch (const Refused& reason) {
            FAIL() << convention.name << ": " << reason.what();
        }
        Wanted wanted;
        for (std::size_t k = 0; k < normals.size(); ++k) {
            wanted.values.resize(wanted.values.size() + 2 * job.channels(), 0.0);
            wanted.scales.resize(wanted.values.size(), 1.0);
            const Rgb expected = convention.bands == 2 ? geomericsIrradiance(radiance, normals[k])
                                                       : evaluateNine(irradiance, normals[k]);
            for (std::size_t c = 0; c < 3; ++c) {
                wanted.values.push_back(expected[c] / (convention.name == "three" ? 1 : pi));
                wanted.scales.push_back(std::abs(wanted.values.back()));
            }
        }
        const double worst = largestDifference(wanted, found);
        // The constants of Godot's and three.js' functions have six digits.
        const Bounds bounds{3e-6, 1e-5};
        EXPECT_LE(worst, bounds.here()) << convention.name;
        keepLast("irradiance", language, std::string(convention.name), wanted, bounds);
        RecordProperty(std::string(convention.name), fmt::format("{:.1e}", worst));
    }
}

TEST(IrradianceShaders, AWrongNameIsRefused) {
    const Convention& convention = *selectConventions("unity").front();
    const ShaderJob job = makeJob(variants().front().payload, 2);
    std::string text = engineShader(convention, someLight());
    text.replace(text.find("n.xyzz"), 6, "n.xyzq");
    try {
        EXPECT_THROW(toSpirv(gpu::Language::hlsl, program(convention, job, text)), Refused);
    } catch (const Missing& reason) {
        GTEST_SKIP() << reason.what();
    }
}

}  // namespace
}  // namespace hshfit::shaders
