#pragma once

#include <hshfit/gpu/vulkan/compute.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

/// Shaders together with all that they read, which run without the rest of the library.
namespace hshfit::shaders {

/// A tool, library or device is missing: the test skips with this reason.
struct Missing : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// A compiler or validator refused a shader, with its message.
struct Refused : std::runtime_error {
    using std::runtime_error::runtime_error;
};

enum class Api { vulkan, openGl, openGlEs };
std::string_view apiName(Api api);  ///< "Vulkan", "OpenGL", "OpenGL ES"

/// A shader and what it is run on. Compute shaders have 64 invocations a group and write a storage
/// buffer. A fragment shader (OpenGL ES) draws a square of pixels into four float targets; its
/// textures are bound by the names of egl_runner.cpp, and it has no buffers.
struct BoundShader {
    Api api = Api::vulkan;
    std::string program;  ///< SPIR-V of Vulkan, GLSL of the others
    std::vector<gpu::ComputeResource> resources = {};
    std::size_t invocations = 0;
    std::size_t outputs = 0;    ///< numbers of an invocation
    std::uint32_t written = 4;  ///< the binding of the buffer that a shader for Vulkan writes
};

/// A flat float32 texture of vectors of `size` numbers, for shaders that fetch without a filter.
gpu::ComputeResource vectorTexture(std::uint32_t binding, int width, int height, std::size_t size,
                                   const std::vector<float>& numbers);

/// The numbers that the invocations write, [invocation][output], of a shader for Vulkan. Throws
/// Refused with the first message of the validation layer.
std::vector<float> runOn(const gpu::ComputeDevice& device, const BoundShader& shader);

/// A context of OpenGL 4.5 or OpenGL ES 3 through EGL, without a surface. One at a time: contexts
/// of a device share its display, which ends with the first of them.
class GlContext {
public:
    /// Throws Missing where there is none of this kind.
    GlContext(Api api, gpu::DeviceChoice::Kind kind);
    GlContext(const GlContext&) = delete;
    GlContext& operator=(const GlContext&) = delete;
    ~GlContext();

    const std::string& renderer() const;  ///< as its driver gives it
    bool software() const;                ///< whether it computes on the processor
    /// The numbers that the invocations write, [invocation][output]. Throws Refused where the
    /// driver does not compile the shader.
    std::vector<float> run(const BoundShader& shader) const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace hshfit::shaders
