#include "runners.h"

#include <hshfit/error.h>
#include <hshfit/gpu/vulkan/compute.h>

#include <cstdlib>
#include <memory>

namespace hshfit::shaders {

std::unique_ptr<gpu::ComputeDevice> vulkanDevice(bool validate) {
    using Kind = gpu::DeviceChoice::Kind;
    try {
        return std::make_unique<gpu::ComputeDevice>(gpu::DeviceChoice{
            .kind = std::getenv("HSHFIT_TEST_GPU") != nullptr ? Kind::gpu : Kind::software,
            .name = {},
            .validate = validate});
    } catch (const NumericError& error) {
        throw Missing(error.what());
    }
}

std::vector<float> runVulkan(const ShaderJob& job, const std::vector<std::uint32_t>& spirv,
                             bool combined) {
    using Kind = gpu::ComputeResource::Kind;
    const auto device = vulkanDevice(true);
    const std::size_t pairs = job.pairs.wo.size(), outputs = pairs * job.outputs();
    const Kind texture = combined ? Kind::sampledTexture : Kind::texture;
    std::vector<gpu::ComputeResource> resources{
        {.binding = 3, .numbers = inputNumbers(job)},
        {.binding = 4, .count = outputs},
    };
    const std::vector<float> block = blockNumbers(job);
    if (block.empty())
        resources.push_back({.binding = 0,
                             .kind = texture,
                             .texels = job.payload.coefficients,
                             .levels = job.levels});
    else
        resources.push_back({.binding = 0, .kind = Kind::uniforms, .numbers = block});
    if (!combined) resources.push_back({.binding = 1, .kind = Kind::sampler});
    if (job.payload.basisTexels)
        resources.push_back({.binding = 2, .kind = texture, .texels = *job.payload.basisTexels});
    if (!job.harmonics.empty())
        resources.push_back({.binding = 5,
                             .kind = texture,
                             .texels = job.harmonics[0],
                             .levels = {job.harmonics.begin() + 1, job.harmonics.end()}});
    std::vector<float> found;
    {
        gpu::ComputeProgram program(*device, spirv, std::move(resources));
        program.run(static_cast<std::uint32_t>(pairs / 64));
        found = program.read(4);
    }
    found.resize(outputs);
    const std::vector<std::string> messages = device->messages();
    if (!messages.empty()) throw Refused(messages.front());
    return found;
}

}  // namespace hshfit::shaders
