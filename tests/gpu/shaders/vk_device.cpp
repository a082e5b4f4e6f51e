#include "vk_device.h"

#include "runners.h"

#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string_view>

namespace hshfit::shaders {
namespace {

VkFormat formatOf(gpu::Number number) {
    switch (number) {
        case gpu::Number::float16:
            return VK_FORMAT_R16G16B16A16_SFLOAT;
        case gpu::Number::float32:
            return VK_FORMAT_R32G32B32A32_SFLOAT;
        case gpu::Number::unorm16:
            return VK_FORMAT_R16G16B16A16_UNORM;
        case gpu::Number::unorm8:
            break;
    }
    return VK_FORMAT_R8G8B8A8_UNORM;
}

VKAPI_ATTR VkBool32 VKAPI_CALL collect(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                       VkDebugUtilsMessageTypeFlagsEXT,
                                       const VkDebugUtilsMessengerCallbackDataEXT* data,
                                       void* messages) {
    static_cast<std::vector<std::string>*>(messages)->push_back(data->pMessage);
    return VK_FALSE;
}

bool layerPresent(const char* name) {
    std::uint32_t count = 0;
    vkEnumerateInstanceLayerProperties(&count, nullptr);
    std::vector<VkLayerProperties> layers(count);
    vkEnumerateInstanceLayerProperties(&count, layers.data());
    for (const auto& layer : layers)
        if (std::string_view(layer.layerName) == name) return true;
    return false;
}

}  // namespace

void check(VkResult result, const char* what) {
    if (result != VK_SUCCESS)
        throw std::runtime_error(std::string(what) + " returned " + std::to_string(result));
}

Device::Device(bool validate) {
    const char* layer = "VK_LAYER_KHRONOS_validation";
    const char* extension = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
    validated_ = validate && layerPresent(layer);
    VkApplicationInfo application{};
    application.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO;
    application.apiVersion = VK_API_VERSION_1_1;
    VkDebugUtilsMessengerCreateInfoEXT listen{};
    listen.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT;
    listen.messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                             VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
    listen.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
    listen.pfnUserCallback = collect;
    listen.pUserData = &messages_;
    VkInstanceCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
    info.pApplicationInfo = &application;
    if (validated_) {
        info.enabledLayerCount = info.enabledExtensionCount = 1;
        info.ppEnabledLayerNames = &layer;
        info.ppEnabledExtensionNames = &extension;
    }
    if (vkCreateInstance(&info, nullptr, &instance_) != VK_SUCCESS)
        throw Missing("no Vulkan driver (mesa-vulkan-drivers)");
    if (validated_) {
        const auto create = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(
            vkGetInstanceProcAddr(instance_, "vkCreateDebugUtilsMessengerEXT"));
        create(instance_, &listen, nullptr, &messenger_);
    }
    pickPhysical();
    const float priority = 1;
    VkDeviceQueueCreateInfo queue{};
    queue.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
    queue.queueFamilyIndex = family_;
    queue.queueCount = 1;
    queue.pQueuePriorities = &priority;
    VkDeviceCreateInfo create{};
    create.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
    create.queueCreateInfoCount = 1;
    create.pQueueCreateInfos = &queue;
    check(vkCreateDevice(physical_, &create, nullptr, &device), "vkCreateDevice");
    vkGetDeviceQueue(device, family_, 0, &queue_);
    VkCommandPoolCreateInfo pool{};
    pool.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
    pool.queueFamilyIndex = family_;
    check(vkCreateCommandPool(device, &pool, nullptr, &pool_), "vkCreateCommandPool");
}

Device::~Device() {
    vkDestroyCommandPool(device, pool_, nullptr);
    vkDestroyDevice(device, nullptr);
    if (validated_) {
        const auto destroy = reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(
            vkGetInstanceProcAddr(instance_, "vkDestroyDebugUtilsMessengerEXT"));
        destroy(instance_, messenger_, nullptr);
    }
    vkDestroyInstance(instance_, nullptr);
}

VkCommandBuffer Device::begin() {
    VkCommandBufferAllocateInfo allocate{};
    allocate.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
    allocate.commandPool = pool_;
    allocate.commandBufferCount = 1;
    VkCommandBuffer commands = nullptr;
    check(vkAllocateCommandBuffers(device, &allocate, &commands), "vkAllocateCommandBuffers");
    VkCommandBufferBeginInfo begin{};
    begin.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
    check(vkBeginCommandBuffer(commands, &begin), "vkBeginCommandBuffer");
    return commands;
}

void Device::finish(VkCommandBuffer commands) {
    check(vkEndCommandBuffer(commands), "vkEndCommandBuffer");
    VkSubmitInfo submission{};
    submission.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
    submission.commandBufferCount = 1;
    submission.pCommandBuffers = &commands;
    check(vkQueueSubmit(queue_, 1, &submission, nullptr), "vkQueueSubmit");
    check(vkQueueWaitIdle(queue_), "vkQueueWaitIdle");
    vkFreeCommandBuffers(device, pool_, 1, &commands);
}

VkDeviceMemory Device::allocate(const VkMemoryRequirements& needs,
                                VkMemoryPropertyFlags properties) const {
    VkPhysicalDeviceMemoryProperties memory;
    vkGetPhysicalDeviceMemoryProperties(physical_, &memory);
    for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i) {
        const bool fits = (needs.memoryTypeBits >> i & 1) != 0 &&
                          (memory.memoryTypes[i].propertyFlags & properties) == properties;
        if (!fits) continue;
        VkMemoryAllocateInfo info{};
        info.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
        info.allocationSize = needs.size;
        info.memoryTypeIndex = i;
        VkDeviceMemory result = nullptr;
        check(vkAllocateMemory(device, &info, nullptr, &result), "vkAllocateMemory");
        return result;
    }
    throw std::runtime_error("no Vulkan memory of the kind that is needed");
}

void Device::pickPhysical() {
    std::uint32_t count = 0;
    vkEnumeratePhysicalDevices(instance_, &count, nullptr);
    std::vector<VkPhysicalDevice> all(count);
    vkEnumeratePhysicalDevices(instance_, &count, all.data());
    const bool wantGpu = std::getenv("HSHFIT_TEST_GPU") != nullptr;
    for (VkPhysicalDevice candidate : all) {
        VkPhysicalDeviceProperties properties;
        vkGetPhysicalDeviceProperties(candidate, &properties);
        if ((properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU) == wantGpu) continue;
        std::uint32_t families = 0;
        vkGetPhysicalDeviceQueueFamilyProperties(candidate, &families, nullptr);
        std::vector<VkQueueFamilyProperties> list(families);
        vkGetPhysicalDeviceQueueFamilyProperties(candidate, &families, list.data());
        for (std::uint32_t i = 0; i < families; ++i) {
            if ((list[i].queueFlags & VK_QUEUE_COMPUTE_BIT) == 0) continue;
            physical_ = candidate;
            family_ = i;
            name_ = properties.deviceName;
            return;
        }
    }
    vkDestroyInstance(instance_, nullptr);
    throw Missing(wantGpu ? "no GPU with Vulkan" : "no lavapipe (mesa-vulkan-drivers)");
}

Buffer::Buffer(Device& owner, std::size_t bytes, VkBufferUsageFlags usage) : device(owner) {
    VkBufferCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
    info.size = bytes;
    info.usage = usage;
    check(vkCreateBuffer(device.device, &info, nullptr, &buffer), "vkCreateBuffer");
    VkMemoryRequirements needs;
    vkGetBufferMemoryRequirements(device.device, buffer, &needs);
    memory = device.allocate(
        needs, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
    check(vkBindBufferMemory(device.device, buffer, memory, 0), "vkBindBufferMemory");
    check(vkMapMemory(device.device, memory, 0, bytes, 0, &data), "vkMapMemory");
}

Buffer::~Buffer() {
    vkDestroyBuffer(device.device, buffer, nullptr);
    vkFreeMemory(device.device, memory, nullptr);
}

Image::Image(Device& owner, const gpu::Texels& texels) : device(owner) {
    const auto layers = static_cast<std::uint32_t>(texels.layers);
    const VkExtent3D extent{static_cast<std::uint32_t>(texels.width),
                            static_cast<std::uint32_t>(texels.height), 1};
    VkImageCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO;
    info.imageType = VK_IMAGE_TYPE_2D;
    info.format = formatOf(texels.number);
    info.extent = extent;
    info.mipLevels = 1;
    info.arrayLayers = layers;
    info.samples = VK_SAMPLE_COUNT_1_BIT;
    info.usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    check(vkCreateImage(device.device, &info, nullptr, &image), "vkCreateImage");
    VkMemoryRequirements needs;
    vkGetImageMemoryRequirements(device.device, image, &needs);
    memory = device.allocate(needs, 0);
    check(vkBindImageMemory(device.device, image, memory, 0), "vkBindImageMemory");
    upload(texels, extent, layers);
    VkImageViewCreateInfo look{};
    look.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO;
    look.image = image;
    look.viewType = VK_IMAGE_VIEW_TYPE_2D_ARRAY;
    look.format = info.format;
    look.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, layers};
    check(vkCreateImageView(device.device, &look, nullptr, &view), "vkCreateImageView");
}

Image::~Image() {
    vkDestroyImageView(device.device, view, nullptr);
    vkDestroyImage(device.device, image, nullptr);
    vkFreeMemory(device.device, memory, nullptr);
}

void Image::upload(const gpu::Texels& texels, const VkExtent3D& extent, std::uint32_t layers) {
    Buffer staging(device, texels.bytes.size(), VK_BUFFER_USAGE_TRANSFER_SRC_BIT);
    std::memcpy(staging.data, texels.bytes.data(), texels.bytes.size());
    VkImageMemoryBarrier barrier{};
    barrier.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER;
    barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    barrier.image = image;
    barrier.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, layers};
    device.submit([&](VkCommandBuffer commands) {
        barrier.newLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
        barrier.dstAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
        vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT,
                             VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0, nullptr, 0, nullptr, 1,
                             &barrier);
        VkBufferImageCopy region{};
        region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, layers};
        region.imageExtent = extent;
        vkCmdCopyBufferToImage(commands, staging.buffer, image,
                               VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
        barrier.oldLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
        barrier.newLayout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
        barrier.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
        barrier.dstAccessMask = VK_ACCESS_SHADER_READ_BIT;
        vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT,
                             VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, 0, 0, nullptr, 0, nullptr, 1,
                             &barrier);
    });
}

Pipeline::Pipeline(Device& owner, const std::vector<std::uint32_t>& spirv,
                   const std::vector<Resource>& resources)
    : device_(owner.device) {
    makeLayouts(resources);
    fillSet(resources);
    VkShaderModuleCreateInfo code{};
    code.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO;
    code.codeSize = spirv.size() * 4;
    code.pCode = spirv.data();
    check(vkCreateShaderModule(device_, &code, nullptr, &module_), "vkCreateShaderModule");
    VkComputePipelineCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO;
    info.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
    info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
    info.stage.module = module_;
    info.stage.pName = "main";
    info.layout = layout_;
    check(vkCreateComputePipelines(device_, nullptr, 1, &info, nullptr, &pipeline_),
          "vkCreateComputePipelines");
}

Pipeline::~Pipeline() {
    vkDestroyPipeline(device_, pipeline_, nullptr);
    vkDestroyShaderModule(device_, module_, nullptr);
    vkDestroyDescriptorPool(device_, pool_, nullptr);
    vkDestroyPipelineLayout(device_, layout_, nullptr);
    vkDestroyDescriptorSetLayout(device_, setLayout_, nullptr);
}

void Pipeline::dispatch(VkCommandBuffer commands, std::uint32_t groups) const {
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline_);
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, layout_, 0, 1, &set_, 0,
                            nullptr);
    vkCmdDispatch(commands, groups, 1, 1);
}

void Pipeline::makeLayouts(const std::vector<Resource>& resources) {
    std::vector<VkDescriptorSetLayoutBinding> bindings;
    std::vector<VkDescriptorPoolSize> sizes;
    for (const Resource& resource : resources) {
        bindings.push_back(
            {resource.binding, resource.type, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr});
        sizes.push_back({resource.type, 1});
    }
    VkDescriptorSetLayoutCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO;
    info.bindingCount = static_cast<std::uint32_t>(bindings.size());
    info.pBindings = bindings.data();
    check(vkCreateDescriptorSetLayout(device_, &info, nullptr, &setLayout_),
          "vkCreateDescriptorSetLayout");
    VkPipelineLayoutCreateInfo layout{};
    layout.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO;
    layout.setLayoutCount = 1;
    layout.pSetLayouts = &setLayout_;
    check(vkCreatePipelineLayout(device_, &layout, nullptr, &layout_), "vkCreatePipelineLayout");
    VkDescriptorPoolCreateInfo pool{};
    pool.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO;
    pool.maxSets = 1;
    pool.poolSizeCount = static_cast<std::uint32_t>(sizes.size());
    pool.pPoolSizes = sizes.data();
    check(vkCreateDescriptorPool(device_, &pool, nullptr, &pool_), "vkCreateDescriptorPool");
}

void Pipeline::fillSet(const std::vector<Resource>& resources) {
    VkDescriptorSetAllocateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO;
    info.descriptorPool = pool_;
    info.descriptorSetCount = 1;
    info.pSetLayouts = &setLayout_;
    check(vkAllocateDescriptorSets(device_, &info, &set_), "vkAllocateDescriptorSets");
    for (const Resource& resource : resources) {
        VkWriteDescriptorSet write{};
        write.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
        write.dstSet = set_;
        write.dstBinding = resource.binding;
        write.descriptorCount = 1;
        write.descriptorType = resource.type;
        write.pImageInfo = &resource.image;
        write.pBufferInfo = &resource.buffer;
        vkUpdateDescriptorSets(device_, 1, &write, 0, nullptr);
    }
}

}  // namespace hshfit::shaders
