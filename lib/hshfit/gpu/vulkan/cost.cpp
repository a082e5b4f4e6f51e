#include <hshfit/gpu/vulkan/cost.h>

#include <hshfit/gpu/vulkan/internal/pipelines.h>

#include <cstdlib>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace hshfit::gpu::inline vulkan {
namespace {

constexpr const char* familyVariable = "RADV_FORCE_FAMILY";
constexpr const char* usualFamily = "navi21";

/// An environment variable with a value, unless it has one already, as long as this lives.
class UnlessSet {
public:
    UnlessSet(const char* name, const char* value) : name_(name), ours_(!std::getenv(name)) {
        if (ours_) setenv(name, value, 0);
    }
    UnlessSet(const UnlessSet&) = delete;
    UnlessSet& operator=(const UnlessSet&) = delete;
    ~UnlessSet() {
        if (ours_) unsetenv(name_);
    }

private:
    const char* name_;
    bool ours_;
};

constexpr vk::ApplicationInfo application{"hshfit", 1, nullptr, 0, VK_API_VERSION_1_1};

vk::raii::PhysicalDevice amdDevice(const vk::raii::Instance& instance) {
    using Driver = vk::PhysicalDeviceDriverProperties;
    vk::raii::PhysicalDevices all(instance);
    for (vk::raii::PhysicalDevice& device : all) {
        const auto properties = device.getProperties2<vk::PhysicalDeviceProperties2, Driver>();
        if (properties.get<Driver>().driverID == vk::DriverId::eMesaRadv) return std::move(device);
    }
    throw std::runtime_error("it is not among the drivers");
}

vk::raii::Device statingDevice(const vk::raii::PhysicalDevice& physical) {
    const float priority = 1;
    const vk::DeviceQueueCreateInfo queues({}, 0, 1, &priority);
    const char* extension = VK_KHR_PIPELINE_EXECUTABLE_PROPERTIES_EXTENSION_NAME;
    vk::PhysicalDevicePipelineExecutablePropertiesFeaturesKHR wanted(true);
    vk::DeviceCreateInfo info({}, queues, {}, extension);
    info.setPNext(&wanted);
    return {physical, info};
}

/// The member that holds a statistic of this name, as Mesa's compiler names them.
std::uint64_t* memberFor(ShaderCost& cost, std::string_view name) {
    constexpr std::pair<std::string_view, std::uint64_t ShaderCost::*> members[] = {
        {"Instructions", &ShaderCost::instructions},
        {"VGPRs", &ShaderCost::registers},
        {"Spilled VGPRs", &ShaderCost::spilled},
        {"Inverse Throughput", &ShaderCost::cycles}};
    for (const auto& [known, member] : members)
        if (known == name) return &(cost.*member);
    return nullptr;
}

}  // namespace

struct AmdCompiler::Parts {
    vk::raii::Context context;
    vk::raii::Instance instance{context, vk::InstanceCreateInfo({}, &application)};
    vk::raii::PhysicalDevice physical = amdDevice(instance);
    vk::raii::Device device = statingDevice(physical);
};

AmdCompiler::AmdCompiler() {
    const UnlessSet family(familyVariable, usualFamily);
    try {
        parts_ = std::make_unique<Parts>();
    } catch (const std::runtime_error& error) {
        throw NumericError(
            fmt::format("Mesa's Vulkan driver for AMD is not there ({}): install "
                        "mesa-vulkan-drivers",
                        error.what()));
    }
    // Without a card, Mesa puts what it compiles for in brackets.
    name_ = parts_->physical.getProperties().deviceName.data();
    const std::size_t open = name_.find("(RADV "), close = name_.rfind(')');
    if (open != name_.npos && close != name_.npos) name_ = name_.substr(open + 6, close - open - 6);
}
AmdCompiler::~AmdCompiler() = default;

ShaderCost AmdCompiler::costOf(std::span<const std::uint32_t> spirv,
                               std::span<const ComputeResource> resources) const {
    return vulkanCall([&] {
        const vk::raii::Device& device = parts_->device;
        const vk::raii::DescriptorSetLayout sets = setLayoutOf(device, resources);
        const vk::raii::PipelineLayout layout(device, vk::PipelineLayoutCreateInfo({}, *sets));
        const vk::raii::Pipeline pipeline =
            pipelineOf(device, layout, spirv, vk::PipelineCreateFlagBits::eCaptureStatisticsKHR);
        ShaderCost cost;
        for (const vk::PipelineExecutableStatisticKHR& one :
             device.getPipelineExecutableStatisticsKHR({*pipeline, 0})) {
            std::uint64_t* const member = memberFor(cost, one.name.data());
            if (member && one.format == vk::PipelineExecutableStatisticFormatKHR::eUint64)
                *member = one.value.u64;
        }
        return cost;
    });
}

}  // namespace hshfit::gpu::inline vulkan
