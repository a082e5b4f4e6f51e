#include "bound_shader.h"

#include <algorithm>

namespace hshfit::shaders {

std::string_view apiName(Api api) {
    switch (api) {
        case Api::vulkan:
            return "Vulkan";
        case Api::openGl:
            return "OpenGL";
        case Api::openGlEs:
            break;
    }
    return "OpenGL ES";
}

gpu::ComputeResource vectorTexture(std::uint32_t binding, int width, int height, std::size_t size,
                                   const std::vector<float>& numbers) {
    std::vector<double> rgba(numbers.size() / size * 4, 0.0);
    for (std::size_t i = 0; i < numbers.size(); ++i)
        rgba[i / size * 4 + i % size] = static_cast<double>(numbers[i]);
    return {.binding = binding,
            .kind = gpu::ComputeResource::Kind::sampledTexture,
            .shape = gpu::ComputeResource::Shape::flat,
            .texels = gpu::encode(rgba, width, height, 1, gpu::Number::float32)};
}

std::vector<float> runOn(const gpu::ComputeDevice& device, const BoundShader& shader) {
    std::vector<std::uint32_t> words(shader.program.size() / 4);
    std::copy_n(shader.program.data(), words.size() * 4, reinterpret_cast<char*>(words.data()));
    const std::size_t before = device.messages().size();
    std::vector<float> found;
    {
        gpu::ComputeProgram program(device, words, shader.resources);
        program.run(static_cast<std::uint32_t>(shader.invocations / 64));
        found = program.read(shader.written);
    }
    found.resize(shader.invocations * shader.outputs);
    const std::vector<std::string> messages = device.messages();
    if (messages.size() > before) throw Refused(messages[before]);
    return found;
}

}  // namespace hshfit::shaders
