#include <hshfit/gpu/vulkan/compiler.h>

#include <hshfit/error.h>
#include <hshfit/gpu/vulkan/internal/vulkan_calls.h>

#include <fmt/format.h>

#include <cstdlib>
#include <optional>
#include <string_view>
#include <vector>

namespace hshfit::gpu::inline vulkan {
namespace {

constexpr const char* familyVariable = "RADV_FORCE_FAMILY";

/// The variable at a value, and as it was before at the end.
class ForcedFamily {
public:
    explicit ForcedFamily(const std::string& family) {
        if (const char* before = std::getenv(familyVariable)) before_ = before;
        setenv(familyVariable, family.c_str(), 1);
    }
    ForcedFamily(const ForcedFamily&) = delete;
    ForcedFamily& operator=(const ForcedFamily&) = delete;
    ~ForcedFamily() {
        if (before_)
            setenv(familyVariable, before_->c_str(), 1);
        else
            unsetenv(familyVariable);
    }

private:
    std::optional<std::string> before_;
};

/// The device that the driver makes of a family without hardware.
vk::raii::PhysicalDevice nullDevice(const vk::raii::Instance& instance, const std::string& family) {
    const ForcedFamily forced(family);
    vk::raii::PhysicalDevices all(instance);
    for (vk::raii::PhysicalDevice& device : all) {
        const std::string_view name = device.getProperties().deviceName.data();
        if (name.starts_with("Null hardware")) return std::move(device);
    }
    throw NumericError(fmt::format(
        "Mesa's driver for AMD GPUs, which compiles without a card, is missing or does not know "
        "the family {} (Debian: mesa-vulkan-drivers)",
        family));
}

std::uint64_t numberOf(const vk::PipelineExecutableStatisticKHR& statistic) {
    switch (statistic.format) {
        case vk::PipelineExecutableStatisticFormatKHR::eInt64:
            return static_cast<std::uint64_t>(statistic.value.i64);
        case vk::PipelineExecutableStatisticFormatKHR::eFloat64:
            return static_cast<std::uint64_t>(statistic.value.f64);
        default:
            return statistic.value.u64;
    }
}

}  // namespace

struct ShaderCompiler::Parts {
    vk::raii::Context context;
    vk::raii::Instance instance;
    vk::raii::PhysicalDevice physical;
    vk::raii::Device device;

    explicit Parts(const std::string& family)
        : instance(makeInstance(context)),
          physical(nullDevice(instance, family)),
          device(makeDevice()) {}

    vk::raii::Device makeDevice() const {
        const float priority = 1;
        const char* extension = VK_KHR_PIPELINE_EXECUTABLE_PROPERTIES_EXTENSION_NAME;
        const vk::PhysicalDevicePipelineExecutablePropertiesFeaturesKHR states(true);
        const vk::DeviceQueueCreateInfo queues({}, 0, 1, &priority);
        vk::DeviceCreateInfo info({}, queues, {}, extension);
        info.setPNext(&states);
        return {physical, info};
    }
};

ShaderCompiler::ShaderCompiler(const std::string& family)
    : parts_(vulkanCall([&] { return std::make_unique<Parts>(family); })),
      name_(parts_->physical.getProperties().deviceName.data()) {}
ShaderCompiler::~ShaderCompiler() = default;

ShaderCost ShaderCompiler::costOf(std::span<const std::uint32_t> spirv,
                                  std::span<const ComputeResource> resources) const {
    return vulkanCall([&] {
        const vk::raii::Device& device = parts_->device;
        const vk::raii::DescriptorSetLayout set = setLayoutOf(device, resources);
        const vk::raii::PipelineLayout layout(device, vk::PipelineLayoutCreateInfo({}, *set));
        const vk::raii::Pipeline pipeline = computePipeline(
            device, layout, spirv, vk::PipelineCreateFlagBits::eCaptureStatisticsKHR);
        struct Row {
            std::string_view name;
            std::uint64_t ShaderCost::*into;
            bool found = false;
        };
        Row rows[] = {{"Instructions", &ShaderCost::instructions},
                      {"VGPRs", &ShaderCost::vectorRegisters},
                      {"SGPRs", &ShaderCost::scalarRegisters},
                      {"Spilled VGPRs", &ShaderCost::spilled},
                      {"Spilled SGPRs", &ShaderCost::spilled},
                      {"Inverse Throughput", &ShaderCost::inverseThroughput},
                      {"Latency", &ShaderCost::latency},
                      {"Code size", &ShaderCost::codeBytes}};
        ShaderCost cost;
        for (const auto& statistic : device.getPipelineExecutableStatisticsKHR(
                 vk::PipelineExecutableInfoKHR(*pipeline, 0))) {
            for (Row& row : rows) {
                if (row.name != statistic.name.data()) continue;
                cost.*row.into += numberOf(statistic);
                row.found = true;
            }
        }
        for (const Row& row : rows)
            if (!row.found)
                throw NumericError(
                    fmt::format("the driver {} does not state \"{}\"", name_, row.name));
        return cost;
    });
}

}  // namespace hshfit::gpu::inline vulkan
