#pragma once

#include <hshfit/gpu/texels.h>

#include <vulkan/vulkan.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

/// As much of Vulkan as it takes to run a compute shader.
namespace hshfit::shaders {

/// Throws std::runtime_error with the name of the call.
void check(VkResult result, const char* what);

/// An instance, a device with one compute queue, and the messages of the validation layer, if
/// installed and wanted. The device is the software one; with HSHFIT_TEST_GPU set, any other.
/// Throws Missing where there is none.
class Device {
public:
    explicit Device(bool validate = true);
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;
    ~Device();

    /// Records commands with `record`, runs them and waits.
    template <class Record>
    void submit(Record record) {
        const VkCommandBuffer commands = begin();
        record(commands);
        finish(commands);
    }

    VkDeviceMemory allocate(const VkMemoryRequirements& needs,
                            VkMemoryPropertyFlags properties) const;
    const std::vector<std::string>& messages() const { return messages_; }
    const std::string& name() const { return name_; }

    VkDevice device = nullptr;

private:
    void pickPhysical();
    VkCommandBuffer begin();
    void finish(VkCommandBuffer commands);

    VkInstance instance_ = nullptr;
    VkDebugUtilsMessengerEXT messenger_ = nullptr;
    VkPhysicalDevice physical_ = nullptr;
    std::uint32_t family_ = 0;
    VkQueue queue_ = nullptr;
    VkCommandPool pool_ = nullptr;
    bool validated_ = false;
    std::string name_;
    std::vector<std::string> messages_;
};

/// A buffer that the host can map.
struct Buffer {
    Buffer(Device& owner, std::size_t bytes, VkBufferUsageFlags usage);
    Buffer(const Buffer&) = delete;
    Buffer& operator=(const Buffer&) = delete;
    ~Buffer();

    Device& device;
    VkBuffer buffer = nullptr;
    VkDeviceMemory memory = nullptr;
    void* data = nullptr;
};

/// A texture array, uploaded, ready to be sampled.
struct Image {
    Image(Device& owner, const gpu::Texels& texels);
    Image(const Image&) = delete;
    Image& operator=(const Image&) = delete;
    ~Image();

    Device& device;
    VkImage image = nullptr;
    VkDeviceMemory memory = nullptr;
    VkImageView view = nullptr;

private:
    void upload(const gpu::Texels& texels, const VkExtent3D& extent, std::uint32_t layers);
};

/// A compute pipeline with its descriptors, which live as long as it does.
class Pipeline {
public:
    struct Resource {
        std::uint32_t binding;
        VkDescriptorType type;
        VkDescriptorImageInfo image;
        VkDescriptorBufferInfo buffer;
    };

    Pipeline(Device& owner, const std::vector<std::uint32_t>& spirv,
             const std::vector<Resource>& resources);
    Pipeline(const Pipeline&) = delete;
    Pipeline& operator=(const Pipeline&) = delete;
    ~Pipeline();

    void dispatch(VkCommandBuffer commands, std::uint32_t groups) const;

private:
    void makeLayouts(const std::vector<Resource>& resources);
    void fillSet(const std::vector<Resource>& resources);

    VkDevice device_;
    VkDescriptorSetLayout setLayout_ = nullptr;
    VkPipelineLayout layout_ = nullptr;
    VkDescriptorPool pool_ = nullptr;
    VkDescriptorSet set_ = nullptr;
    VkShaderModule module_ = nullptr;
    VkPipeline pipeline_ = nullptr;
};

}  // namespace hshfit::shaders
