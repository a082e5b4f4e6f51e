#include "runners.h"

#include <hshfit/error.h>

#include <cstdlib>
#include <memory>

namespace hshfit::shaders {
namespace {

using Kind = gpu::ComputeResource::Kind;

gpu::DeviceChoice::Kind deviceOfTests() {
    return std::getenv("HSHFIT_TEST_GPU") != nullptr ? gpu::DeviceChoice::Kind::gpu
                                                     : gpu::DeviceChoice::Kind::software;
}

BoundShader lastRun;
std::vector<float> lastFound;

/// The textures of a job, with basis texels at binding `basis` and harmonics at `harmonics`.
std::vector<gpu::ComputeResource> texturesOf(const ShaderJob& job, Kind texture,
                                             std::uint32_t basis, std::uint32_t harmonics) {
    std::vector<gpu::ComputeResource> resources;
    const std::vector<float> block = blockNumbers(job);
    if (block.empty())
        resources.push_back({.binding = 0,
                             .kind = texture,
                             .texels = job.payload.coefficients,
                             .levels = job.levels});
    else
        resources.push_back({.binding = 0, .kind = Kind::uniforms, .numbers = block});
    if (job.payload.basisTexels)
        resources.push_back(
            {.binding = basis, .kind = texture, .texels = *job.payload.basisTexels});
    if (!job.harmonics.empty())
        resources.push_back({.binding = harmonics,
                             .kind = texture,
                             .texels = job.harmonics[0],
                             .levels = {job.harmonics.begin() + 1, job.harmonics.end()}});
    return resources;
}

BoundShader computeShader(Api api, const ShaderJob& job, std::string program, bool combined) {
    BoundShader shader{
        .api = api,
        .program = std::move(program),
        .resources = texturesOf(job, combined ? Kind::sampledTexture : Kind::texture, 2, 5),
        .invocations = job.pairs.wo.size(),
        .outputs = job.outputs()};
    if (!combined) shader.resources.push_back({.binding = 1, .kind = Kind::sampler});
    shader.resources.push_back({.binding = 3, .numbers = inputNumbers(job)});
    shader.resources.push_back({.binding = 4, .count = shader.invocations * shader.outputs});
    return shader;
}

std::vector<float> components(const std::vector<Direction>& directions) {
    std::vector<float> result;
    for (const Direction& d : directions)
        for (const double v : {d.x, d.y, d.z}) result.push_back(static_cast<float>(v));
    return result;
}

}  // namespace

std::unique_ptr<gpu::ComputeDevice> vulkanDevice(bool validate) {
    try {
        return std::make_unique<gpu::ComputeDevice>(
            gpu::DeviceChoice{.kind = deviceOfTests(), .name = {}, .validate = validate});
    } catch (const NumericError& error) {
        throw Missing(error.what());
    }
}

std::vector<float> runHere(const BoundShader& shader) {
    std::vector<float> found = shader.api == Api::vulkan
                                   ? runOn(*vulkanDevice(true), shader)
                                   : GlContext(shader.api, deviceOfTests()).run(shader);
    lastRun = shader;
    lastFound = found;
    return found;
}

void keepLast(const std::string& kind, gpu::Language language, const std::string& name,
              const Wanted& wanted, const Bounds& bounds) {
    const char* folder = std::getenv("HSHFIT_KEEP_SHADERS");
    const bool cpp = language == gpu::Language::metal || language == gpu::Language::osl;
    if (folder == nullptr || cpp) return;
    if (largestDifference(wanted, lastFound) > bounds.here())
        throw std::logic_error(kind + ", " + name +
                               ": the shader that ran last gives other values");
    for (const gpu::LanguageEntry& entry : gpu::languages())
        if (entry.language == language)
            keepShader(folder, {kind, std::string(entry.name), name, lastRun, wanted, bounds});
}

std::vector<float> runVulkan(const ShaderJob& job, const std::vector<std::uint32_t>& spirv,
                             bool combined) {
    return runHere(computeShader(Api::vulkan, job,
                                 {reinterpret_cast<const char*>(spirv.data()), 4 * spirv.size()},
                                 combined));
}

std::vector<float> runOpenGl(const ShaderJob& job, const std::string& source) {
    return runHere(computeShader(Api::openGl, job, source, true));
}

std::vector<float> runOpenGlEs(const ShaderJob& job, const std::string& source) {
    constexpr int side = Pairs::side;
    BoundShader shader{.api = Api::openGlEs,
                       .program = source,
                       .resources = texturesOf(job, Kind::sampledTexture, 1, 7),
                       .invocations = job.pairs.wo.size(),
                       .outputs = job.outputs()};
    shader.resources.push_back(vectorTexture(2, side, side, 3, components(job.pairs.wo)));
    shader.resources.push_back(vectorTexture(3, side, side, 3, components(job.pairs.wi)));
    const std::size_t colours = job.lights();
    const std::size_t slots = colours == 0 ? 0 : job.environment.values.size() / colours;
    std::vector<float> lights;
    for (std::size_t i = 0; i < colours; ++i)
        for (std::size_t j = 0; j < slots; ++j)
            lights.push_back(static_cast<float>(job.environment.values[j * colours + i]));
    if (!lights.empty())
        shader.resources.push_back(
            vectorTexture(4, static_cast<int>(slots), static_cast<int>(colours), 1, lights));
    const std::vector<float> places(job.places.begin(), job.places.end());
    if (!places.empty()) shader.resources.push_back(vectorTexture(6, side, side, 3, places));
    return runHere(shader);
}

}  // namespace hshfit::shaders
