// Costs of compute shaders on an AMD GPU that is not there: Mesa's driver compiles for it.
//
//     amd_costs FILE.spv…
//
// For each file a line with instructions, vector registers, spilled vector registers and inverse
// throughput (cycles for a wave of 64 threads on the busiest unit), as the driver's compiler states
// them (VK_KHR_pipeline_executable_properties) for a Navi 21, or the family in RADV_FORCE_FAMILY.
// The first line has the device's name. Shaders may have sampled textures at bindings 0 and
// 1 and storage buffers at 3 and 4. Exit code 77 where Mesa has no such driver.

#include "spirv_words.h"

#include <fmt/format.h>
#include <vulkan/vulkan_raii.hpp>

#include <array>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace {

constexpr int missing = 77;
constexpr const char* driver = "/usr/share/vulkan/icd.d/radeon_icd.x86_64.json";
constexpr std::array columns{"Instructions", "VGPRs", "Spilled VGPRs", "Inverse Throughput"};

class Compiler {
public:
    Compiler()
        : instance_(context_, vk::InstanceCreateInfo({}, &application)),
          physical_(theDevice()),
          device_(makeDevice()) {
        using Type = vk::DescriptorType;
        constexpr auto stage = vk::ShaderStageFlagBits::eCompute;
        std::vector<vk::DescriptorSetLayoutBinding> bindings;
        for (const std::uint32_t texture : {0, 1})
            bindings.emplace_back(texture, Type::eCombinedImageSampler, 1, stage);
        for (const std::uint32_t buffer : {3, 4})
            bindings.emplace_back(buffer, Type::eStorageBuffer, 1, stage);
        set_.emplace(device_, vk::DescriptorSetLayoutCreateInfo({}, bindings));
        layout_.emplace(device_, vk::PipelineLayoutCreateInfo({}, **set_));
    }

    std::string device() const { return physical_.getProperties().deviceName.data(); }

    std::map<std::string, std::uint64_t> costs(const char* path) const {
        const std::vector<std::uint32_t> words = hshfit::shaders::wordsOf(path);
        const vk::raii::ShaderModule module(device_, vk::ShaderModuleCreateInfo({}, words));
        const vk::PipelineShaderStageCreateInfo stage({}, vk::ShaderStageFlagBits::eCompute,
                                                      *module, "main");
        const vk::raii::Pipeline pipeline(
            device_, nullptr,
            vk::ComputePipelineCreateInfo(vk::PipelineCreateFlagBits::eCaptureStatisticsKHR, stage,
                                          **layout_));
        std::map<std::string, std::uint64_t> found;
        for (const vk::PipelineExecutableStatisticKHR& one :
             device_.getPipelineExecutableStatisticsKHR({*pipeline, 0}))
            if (one.format == vk::PipelineExecutableStatisticFormatKHR::eUint64)
                found[one.name.data()] = one.value.u64;
        return found;
    }

private:
    static constexpr vk::ApplicationInfo application{"amd_costs", 1, nullptr, 0,
                                                     VK_API_VERSION_1_1};

    vk::raii::PhysicalDevice theDevice() const {
        vk::raii::PhysicalDevices all(instance_);
        if (all.empty()) throw std::runtime_error("Mesa's driver for AMD has no device");
        return std::move(all.front());
    }
    vk::raii::Device makeDevice() const {
        const float priority = 1;
        const vk::DeviceQueueCreateInfo queues({}, 0, 1, &priority);
        const char* extension = VK_KHR_PIPELINE_EXECUTABLE_PROPERTIES_EXTENSION_NAME;
        vk::PhysicalDevicePipelineExecutablePropertiesFeaturesKHR wanted(true);
        vk::DeviceCreateInfo info({}, queues, {}, extension);
        info.setPNext(&wanted);
        return {physical_, info};
    }

    vk::raii::Context context_;
    vk::raii::Instance instance_;
    vk::raii::PhysicalDevice physical_;
    vk::raii::Device device_;
    std::optional<vk::raii::DescriptorSetLayout> set_;
    std::optional<vk::raii::PipelineLayout> layout_;
};

}  // namespace

int main(int count, char** arguments) {
    if (!std::ifstream(driver)) {
        fmt::print(stderr, "amd_costs: {} is missing: install mesa-vulkan-drivers\n", driver);
        return missing;
    }
    setenv("VK_ICD_FILENAMES", driver, 1);
    setenv("RADV_FORCE_FAMILY", "navi21", 0);
    try {
        const Compiler compiler;
        fmt::print("{}\n", compiler.device());
        for (int k = 1; k < count; ++k) {
            const auto costs = compiler.costs(arguments[k]);
            for (const char* column : columns)
                fmt::print("{} ", costs.contains(column) ? costs.at(column) : 0);
            fmt::print("{}\n", arguments[k]);
        }
    } catch (const std::exception& error) {
        fmt::print(stderr, "amd_costs: {}\n", error.what());
        return 1;
    }
    return 0;
}
