// Costs of compute shaders on an AMD GPU that need not be there: Mesa's driver compiles for it.
//
//     amd_costs FILE.spv…
//
// For each file a line with instructions, vector registers, spilled vector registers and inverse
// throughput (cost.h) for a Navi 21, or the family in RADV_FORCE_FAMILY. The first line has the
// device's name. Shaders may have sampled textures at bindings 0 and 1 and storage buffers at 3
// and 4. Exit code 77 where Mesa has no such driver.

#include "spirv_words.h"

#include <hshfit/error.h>
#include <hshfit/gpu/vulkan/cost.h>

#include <fmt/format.h>

#include <optional>
#include <vector>

namespace {

using hshfit::gpu::AmdCompiler;
using Kind = hshfit::gpu::ComputeResource::Kind;

constexpr int missing = 77;

}  // namespace

int main(int count, char** arguments) {
    std::optional<AmdCompiler> compiler;
    try {
        compiler.emplace();
    } catch (const hshfit::NumericError& error) {
        fmt::print(stderr, "amd_costs: {}\n", error.what());
        return missing;
    }
    const std::vector<hshfit::gpu::ComputeResource> resources{
        {.binding = 0, .kind = Kind::sampledTexture},
        {.binding = 1, .kind = Kind::sampledTexture},
        {.binding = 3},
        {.binding = 4}};
    fmt::print("{}\n", compiler->device());
    for (int k = 1; k < count; ++k) {
        try {
            const auto cost = compiler->costOf(hshfit::shaders::wordsOf(arguments[k]), resources);
            fmt::print("{} {} {} {} {}\n", cost.instructions, cost.registers, cost.spilled,
                       cost.cycles, arguments[k]);
        } catch (const std::exception& error) {
            fmt::print(stderr, "amd_costs: {}\n", error.what());
            return 1;
        }
    }
    return 0;
}
