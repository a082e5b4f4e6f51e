#pragma once

#include <hshfit/gpu/texels.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace hshfit::gpu::inline vulkan {

/// The device to run on.
struct DeviceChoice {
    enum class Kind {
        any,       ///< a GPU if there is one, else a renderer in software
        gpu,       ///< no renderer in software
        software,  ///< a renderer in software
    };
    Kind kind = Kind::any;
    std::string name = {};  ///< a part of the device's name; empty: the first
    /// Collect the messages of Khronos' validation layer, where it is installed.
    bool validate = false;
};

/// A Vulkan device with a queue for compute shaders.
class ComputeDevice {
public:
    /// Throws NumericError where there is no such device, with those that there are.
    explicit ComputeDevice(const DeviceChoice& choice = {});
    ComputeDevice(const ComputeDevice&) = delete;
    ComputeDevice& operator=(const ComputeDevice&) = delete;
    ~ComputeDevice();

    const std::string& name() const;  ///< as its driver gives it
    /// Whether it computes on the processor: its times say nothing of a GPU.
    bool software() const { return software_; }
    std::vector<std::string> messages() const;  ///< of the validation layer

    struct Parts;
    Parts& parts() const { return *parts_; }

private:
    std::unique_ptr<Parts> parts_;
    std::string name_;
    bool software_ = false;
};

/// A thing at a binding of descriptor set 0.
struct ComputeResource {
    enum class Kind {
        sampledTexture,  ///< a texture with its sampler
        texture,         ///< the texture alone
        sampler,         ///< linear, between levels too, clamped to the edge
        uniforms,        ///< a uniform block of `numbers`
        buffer,          ///< a storage buffer that begins with `numbers`
    };
    enum class Shape {
        array,  ///< sampler2DArray
        flat,   ///< sampler2D, of one layer
        cube,   ///< samplerCube; the layers are +x -x +y -y +z -z
    };
    std::uint32_t binding = 0;
    Kind kind = Kind::buffer;
    Shape shape = Shape::array;  ///< of a texture
    Texels texels = {};
    std::vector<Texels> levels = {};  ///< of a texture, after its first: half as wide and high
    std::vector<float> numbers = {};
    std::size_t count = 0;  ///< floats of a storage buffer, at least numbers.size()
};

/// A compute shader with its resources, on a device that outlives it.
class ComputeProgram {
public:
    ComputeProgram(const ComputeDevice& device, std::span<const std::uint32_t> spirv,
                   std::vector<ComputeResource> resources);
    ComputeProgram(ComputeProgram&&) noexcept;
    ComputeProgram& operator=(ComputeProgram&&) noexcept;
    ~ComputeProgram();

    /// Runs `groups` work groups and waits. The seconds between two time stamps on the device,
    /// before and after; on one without time stamps, of the wall clock.
    double run(std::uint32_t groups);
    /// Replaces the first numbers of a storage buffer.
    void write(std::uint32_t binding, std::span<const float> numbers);
    /// The content of a storage buffer.
    std::vector<float> read(std::uint32_t binding) const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace hshfit::gpu::inline vulkan
