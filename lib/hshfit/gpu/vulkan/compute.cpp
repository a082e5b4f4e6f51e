#include <hshfit/gpu/vulkan/compute.h>

#include <hshfit/error.h>
#include <hshfit/gpu/vulkan/internal/pipelines.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <optional>
#include <string_view>

namespace hshfit::gpu::inline vulkan {
namespace {

constexpr const char* validationLayer = "VK_LAYER_KHRONOS_validation";

vk::Format formatOf(Number number) {
    switch (number) {
        case Number::float16:
            return vk::Format::eR16G16B16A16Sfloat;
        case Number::float32:
            return vk::Format::eR32G32B32A32Sfloat;
        case Number::unorm16:
            return vk::Format::eR16G16B16A16Unorm;
        case Number::unorm8:
            break;
    }
    return vk::Format::eR8G8B8A8Unorm;
}

VKAPI_ATTR VkBool32 VKAPI_CALL collect(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                       VkDebugUtilsMessageTypeFlagsEXT,
                                       const VkDebugUtilsMessengerCallbackDataEXT* data,
                                       void* messages) {
    static_cast<std::vector<std::string>*>(messages)->push_back(data->pMessage);
    return VK_FALSE;
}

bool isSoftware(const vk::PhysicalDeviceProperties& properties) {
    return properties.deviceType == vk::PhysicalDeviceType::eCpu;
}

std::optional<std::uint32_t> computeFamily(const vk::raii::PhysicalDevice& device) {
    const auto families = device.getQueueFamilyProperties();
    for (std::uint32_t k = 0; k < families.size(); ++k)
        if (families[k].queueFlags & vk::QueueFlagBits::eCompute) return k;
    return {};
}

/// The first that fits, GPUs before renderers in software.
vk::raii::PhysicalDevice chosenDevice(const vk::raii::Instance& instance,
                                      const DeviceChoice& choice) {
    std::vector<std::string> names;
    vk::raii::PhysicalDevices all(instance);
    for (const bool software : {false, true}) {
        for (vk::raii::PhysicalDevice& device : all) {
            const auto properties = device.getProperties();
            if (isSoftware(properties) != software || !computeFamily(device)) continue;
            const std::string_view name = properties.deviceName.data();
            names.emplace_back(name);
            const bool kind = choice.kind == DeviceChoice::Kind::any ||
                              (choice.kind == DeviceChoice::Kind::software) == software;
            if (kind && name.find(choice.name) != std::string_view::npos) return std::move(device);
        }
    }
    throw NumericError(
        fmt::format("there is no Vulkan device of this kind and name; found: {}",
                    names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "))));
}

}  // namespace

struct ComputeDevice::Parts {
    vk::raii::Context context;
    std::vector<std::string> messages;
    vk::raii::Instance instance;
    std::optional<vk::raii::DebugUtilsMessengerEXT> messenger;
    vk::raii::PhysicalDevice physical;
    std::uint32_t family;
    double nanosecondsPerTick = 0;  ///< 0: no time stamps
    vk::raii::Device device;
    vk::raii::Queue queue;
    vk::raii::CommandPool pool;

    explicit Parts(const DeviceChoice& choice)
        : instance(makeInstance(choice.validate)),
          physical(chosenDevice(instance, choice)),
          family(*computeFamily(physical)),
          device(makeDevice()),
          queue(device, family, 0),
          pool(device, vk::CommandPoolCreateInfo({}, family)) {
        if (physical.getQueueFamilyProperties()[family].timestampValidBits > 0)
            nanosecondsPerTick = physical.getProperties().limits.timestampPeriod;
        if (!choice.validate || !hasValidation()) return;
        using Severity = vk::DebugUtilsMessageSeverityFlagBitsEXT;
        messenger.emplace(
            instance, vk::DebugUtilsMessengerCreateInfoEXT(
                          {}, Severity::eWarning | Severity::eError,
                          vk::DebugUtilsMessageTypeFlagBitsEXT::eValidation, collect, &messages));
    }

    bool hasValidation() const {
        const auto layers = context.enumerateInstanceLayerProperties();
        return std::ranges::any_of(layers, [](const vk::LayerProperties& layer) {
            return std::string_view(layer.layerName.data()) == validationLayer;
        });
    }
    vk::raii::Instance makeInstance(bool validate) const {
        const vk::ApplicationInfo application("hshfit", 1, nullptr, 0, VK_API_VERSION_1_1);
        const char* extension = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
        vk::InstanceCreateInfo info({}, &application);
        if (validate && hasValidation()) {
            info.setPEnabledLayerNames(validationLayer).setPEnabledExtensionNames(extension);
        }
        return {context, info};
    }
    vk::raii::Device makeDevice() const {
        const float priority = 1;
        const vk::DeviceQueueCreateInfo queues({}, family, 1, &priority);
        return {physical, vk::DeviceCreateInfo({}, queues)};
    }

    template <class Resource>
    vk::raii::DeviceMemory memoryFor(const Resource& resource,
                                     vk::MemoryPropertyFlags properties) const {
        const vk::MemoryRequirements needs = resource.getMemoryRequirements();
        const auto memory = physical.getMemoryProperties();
        for (std::uint32_t k = 0; k < memory.memoryTypeCount; ++k) {
            const bool fits = (needs.memoryTypeBits >> k & 1) != 0 &&
                              (memory.memoryTypes[k].propertyFlags & properties) == properties;
            if (fits) return {device, vk::MemoryAllocateInfo(needs.size, k)};
        }
        throw NumericError("the Vulkan device has no memory of the kind that is needed");
    }

    template <class Record>
    void submit(const Record& record) const {
        const vk::raii::CommandBuffers all(
            device, vk::CommandBufferAllocateInfo(*pool, vk::CommandBufferLevel::ePrimary, 1));
        const vk::raii::CommandBuffer& commands = all[0];
        commands.begin(vk::CommandBufferBeginInfo());
        record(commands);
        commands.end();
        queue.submit(vk::SubmitInfo({}, {}, *commands));
        queue.waitIdle();
    }
};

namespace {

/// A buffer that the host can map.
struct Buffer {
    vk::DeviceSize bytes;
    vk::raii::Buffer buffer;
    vk::raii::DeviceMemory memory;
    void* data;

    Buffer(const ComputeDevice::Parts& parts, std::size_t size, vk::BufferUsageFlags usage)
        : bytes(std::max<std::size_t>(size, 16)),
          buffer(parts.device, vk::BufferCreateInfo({}, bytes, usage)),
          memory(parts.memoryFor(buffer, vk::MemoryPropertyFlagBits::eHostVisible |
                                             vk::MemoryPropertyFlagBits::eHostCoherent)) {
        buffer.bindMemory(*memory, 0);
        data = memory.mapMemory(0, bytes);
        std::memset(data, 0, bytes);
    }
    void put(const void* from, std::size_t count) const { std::memcpy(data, from, count); }
};

vk::ImageViewType viewOf(ComputeResource::Shape shape) {
    switch (shape) {
        case ComputeResource::Shape::flat:
            return vk::ImageViewType::e2D;
        case ComputeResource::Shape::cube:
            return vk::ImageViewType::eCube;
        case ComputeResource::Shape::array:
            break;
    }
    return vk::ImageViewType::e2DArray;
}

/// A texture with its levels, uploaded, ready to be sampled.
struct Image {
    vk::raii::Image image;
    vk::raii::DeviceMemory memory;
    vk::raii::ImageView view;

    Image(const ComputeDevice::Parts& parts, const ComputeResource& resource)
        : image(parts.device, infoOf(resource)),
          memory(parts.memoryFor(image, {})),
          view(bound(parts, resource)) {
        upload(parts, resource);
    }

private:
    static std::uint32_t levelsOf(const ComputeResource& resource) {
        return 1 + static_cast<std::uint32_t>(resource.levels.size());
    }
    static vk::Extent3D extentOf(const Texels& texels) {
        return {static_cast<std::uint32_t>(texels.width), static_cast<std::uint32_t>(texels.height),
                1};
    }
    static vk::ImageSubresourceRange rangeOf(const ComputeResource& resource) {
        return {vk::ImageAspectFlagBits::eColor, 0, levelsOf(resource), 0,
                static_cast<std::uint32_t>(resource.texels.layers)};
    }
    static vk::ImageCreateInfo infoOf(const ComputeResource& resource) {
        const bool cube = resource.shape == ComputeResource::Shape::cube;
        return {cube ? vk::ImageCreateFlagBits::eCubeCompatible : vk::ImageCreateFlags{},
                vk::ImageType::e2D,
                formatOf(resource.texels.number),
                extentOf(resource.texels),
                levelsOf(resource),
                static_cast<std::uint32_t>(resource.texels.layers),
                vk::SampleCountFlagBits::e1,
                vk::ImageTiling::eOptimal,
                vk::ImageUsageFlagBits::eSampled | vk::ImageUsageFlagBits::eTransferDst};
    }
    vk::raii::ImageView bound(const ComputeDevice::Parts& parts,
                              const ComputeResource& resource) const {
        image.bindMemory(*memory, 0);
        return {parts.device,
                vk::ImageViewCreateInfo({}, *image, viewOf(resource.shape),
                                        formatOf(resource.texels.number), {}, rangeOf(resource))};
    }
    void upload(const ComputeDevice::Parts& parts, const ComputeResource& resource) const {
        std::vector<std::byte> bytes;
        std::vector<vk::BufferImageCopy> copies;
        const auto add = [&](const Texels& texels) {
            const vk::ImageSubresourceLayers layers(vk::ImageAspectFlagBits::eColor,
                                                    static_cast<std::uint32_t>(copies.size()), 0,
                                                    static_cast<std::uint32_t>(texels.layers));
            copies.emplace_back(bytes.size(), 0, 0, layers, vk::Offset3D{}, extentOf(texels));
            bytes.insert(bytes.end(), texels.bytes.begin(), texels.bytes.end());
        };
        add(resource.texels);
        for (const Texels& level : resource.levels) add(level);
        const Buffer staging(parts, bytes.size(), vk::BufferUsageFlagBits::eTransferSrc);
        staging.put(bytes.data(), bytes.size());
        using Stage = vk::PipelineStageFlagBits;
        using Access = vk::AccessFlagBits;
        using Layout = vk::ImageLayout;
        vk::ImageMemoryBarrier barrier({}, Access::eTransferWrite, Layout::eUndefined,
                                       Layout::eTransferDstOptimal, VK_QUEUE_FAMILY_IGNORED,
                                       VK_QUEUE_FAMILY_IGNORED, *image, rangeOf(resource));
        parts.submit([&](const vk::raii::CommandBuffer& commands) {
            commands.pipelineBarrier(Stage::eTopOfPipe, Stage::eTransfer, {}, {}, {}, barrier);
            commands.copyBufferToImage(*staging.buffer, *image, Layout::eTransferDstOptimal,
                                       copies);
            barrier.setOldLayout(Layout::eTransferDstOptimal)
                .setNewLayout(Layout::eShaderReadOnlyOptimal)
                .setSrcAccessMask(Access::eTransferWrite)
                .setDstAccessMask(Access::eShaderRead);
            commands.pipelineBarrier(Stage::eTransfer, Stage::eComputeShader, {}, {}, {}, barrier);
        });
    }
};

vk::SamplerCreateInfo linearSampler() {
    constexpr auto edge = vk::SamplerAddressMode::eClampToEdge;
    return {{},
            vk::Filter::eLinear,
            vk::Filter::eLinear,
            vk::SamplerMipmapMode::eLinear,
            edge,
            edge,
            edge,
            0,
            {},
            {},
            {},
            {},
            0,
            VK_LOD_CLAMP_NONE};
}

}  // namespace

struct ComputeProgram::Parts {
    const ComputeDevice::Parts& device;
    std::vector<ComputeResource> resources;
    vk::raii::Sampler sampler;
    std::vector<std::optional<Buffer>> buffers;
    std::vector<std::optional<Image>> images;
    vk::raii::DescriptorSetLayout setLayout;
    vk::raii::PipelineLayout layout;
    vk::raii::DescriptorPool pool;
    vk::raii::DescriptorSets sets;
    vk::raii::Pipeline pipeline;
    vk::raii::QueryPool stamps;

    Parts(const ComputeDevice::Parts& owner, std::span<const std::uint32_t> spirv,
          std::vector<ComputeResource> given)
        : device(owner),
          resources(std::move(given)),
          sampler(owner.device, linearSampler()),
          setLayout(setLayoutOf(owner.device, resources)),
          layout(owner.device, vk::PipelineLayoutCreateInfo({}, *setLayout)),
          pool(makePool()),
          sets(owner.device, vk::DescriptorSetAllocateInfo(*pool, *setLayout)),
          pipeline(pipelineOf(owner.device, layout, spirv)),
          stamps(owner.device, vk::QueryPoolCreateInfo({}, vk::QueryType::eTimestamp, 2)) {
        for (const ComputeResource& resource : resources) attach(resource);
    }

    vk::raii::DescriptorPool makePool() const {
        std::vector<vk::DescriptorPoolSize> sizes;
        for (const ComputeResource& resource : resources)
            sizes.emplace_back(typeOf(resource.kind), 1);
        return {device.device, vk::DescriptorPoolCreateInfo(
                                   vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet, 1, sizes)};
    }
    void attach(const ComputeResource& resource) {
        using Kind = ComputeResource::Kind;
        std::optional<Buffer>& buffer = buffers.emplace_back();
        std::optional<Image>& image = images.emplace_back();
        vk::DescriptorImageInfo pictured(*sampler, {}, vk::ImageLayout::eShaderReadOnlyOptimal);
        vk::DescriptorBufferInfo held({}, 0, VK_WHOLE_SIZE);
        if (resource.kind == Kind::sampledTexture || resource.kind == Kind::texture) {
            image.emplace(device, resource);
            pictured.imageView = *image->view;
        } else if (resource.kind != Kind::sampler) {
            const std::size_t count = std::max(resource.count, resource.numbers.size());
            buffer.emplace(device, 4 * count,
                           resource.kind == Kind::uniforms
                               ? vk::BufferUsageFlagBits::eUniformBuffer
                               : vk::BufferUsageFlagBits::eStorageBuffer);
            buffer->put(resource.numbers.data(), 4 * resource.numbers.size());
            held.buffer = *buffer->buffer;
        }
        device.device.updateDescriptorSets(
            vk::WriteDescriptorSet(*sets[0], resource.binding, 0, 1, typeOf(resource.kind),
                                   &pictured, &held),
            {});
    }

    const Buffer& bufferAt(std::uint32_t binding) const {
        for (std::size_t k = 0; k < resources.size(); ++k)
            if (resources[k].binding == binding && buffers[k]) return *buffers[k];
        throw UsageError(fmt::format("binding {} is no buffer", binding));
    }

    double run(std::uint32_t groups) const {
        const bool stamped = device.nanosecondsPerTick > 0;
        const auto start = std::chrono::steady_clock::now();
        device.submit([&](const vk::raii::CommandBuffer& commands) {
            commands.bindPipeline(vk::PipelineBindPoint::eCompute, *pipeline);
            commands.bindDescriptorSets(vk::PipelineBindPoint::eCompute, *layout, 0, *sets[0], {});
            if (stamped) {
                commands.resetQueryPool(*stamps, 0, 2);
                commands.writeTimestamp(vk::PipelineStageFlagBits::eBottomOfPipe, *stamps, 0);
            }
            commands.dispatch(groups, 1, 1);
            const vk::MemoryBarrier barrier(vk::AccessFlagBits::eShaderWrite,
                                            vk::AccessFlagBits::eHostRead);
            commands.pipelineBarrier(vk::PipelineStageFlagBits::eComputeShader,
                                     vk::PipelineStageFlagBits::eHost, {}, barrier, {}, {});
            if (stamped)
                commands.writeTimestamp(vk::PipelineStageFlagBits::eBottomOfPipe, *stamps, 1);
        });
        const std::chrono::duration<double> waited = std::chrono::steady_clock::now() - start;
        if (!stamped) return waited.count();
        const auto [result, ticks] = stamps.getResults<std::uint64_t>(
            0, 2, 16, 8, vk::QueryResultFlagBits::e64 | vk::QueryResultFlagBits::eWait);
        return 1e-9 * device.nanosecondsPerTick * static_cast<double>(ticks[1] - ticks[0]);
    }
};

ComputeDevice::ComputeDevice(const DeviceChoice& choice)
    : parts_(vulkanCall([&] { return std::make_unique<Parts>(choice); })) {
    const auto properties = parts_->physical.getProperties();
    name_ = properties.deviceName.data();
    software_ = isSoftware(properties);
}
ComputeDevice::~ComputeDevice() = default;
const std::string& ComputeDevice::name() const {
    return name_;
}
std::vector<std::string> ComputeDevice::messages() const {
    return parts_->messages;
}

ComputeProgram::ComputeProgram(const ComputeDevice& device, std::span<const std::uint32_t> spirv,
                               std::vector<ComputeResource> resources)
    : parts_(vulkanCall(
          [&] { return std::make_unique<Parts>(device.parts(), spirv, std::move(resources)); })) {}
ComputeProgram::ComputeProgram(ComputeProgram&&) noexcept = default;
ComputeProgram& ComputeProgram::operator=(ComputeProgram&&) noexcept = default;
ComputeProgram::~ComputeProgram() = default;

double ComputeProgram::run(std::uint32_t groups) {
    return vulkanCall([&] { return parts_->run(groups); });
}

void ComputeProgram::write(std::uint32_t binding, std::span<const float> numbers) {
    const Buffer& buffer = parts_->bufferAt(binding);
    if (numbers.size_bytes() > buffer.bytes)
        throw UsageError(fmt::format("binding {} has fewer numbers", binding));
    buffer.put(numbers.data(), numbers.size_bytes());
}

std::vector<float> ComputeProgram::read(std::uint32_t binding) const {
    const Buffer& buffer = parts_->bufferAt(binding);
    std::vector<float> numbers(buffer.bytes / 4);
    std::memcpy(numbers.data(), buffer.data, 4 * numbers.size());
    return numbers;
}

}  // namespace hshfit::gpu::inline vulkan
