#include <hshfit/error.h>
#include <hshfit/gpu/vulkan/compute.h>
#include <hshfit/gpu/vulkan/cost.h>
#include <hshfit/gpu/vulkan/spirv.h>

namespace hshfit::gpu::inline vulkan {
namespace {

[[noreturn]] void refuse() {
    throw NumericError(
        "this program was built without Vulkan; shaders run where it is built with Vulkan's "
        "headers and glslang (libvulkan-dev, glslang-dev)");
}

}  // namespace

struct ComputeDevice::Parts {};
struct ComputeProgram::Parts {};

ComputeDevice::ComputeDevice(const DeviceChoice&) {
    refuse();
}
ComputeDevice::~ComputeDevice() = default;
const std::string& ComputeDevice::name() const {
    return name_;
}
std::vector<std::string> ComputeDevice::messages() const {
    return {};
}

ComputeProgram::ComputeProgram(const ComputeDevice&, std::span<const std::uint32_t>,
                               std::vector<ComputeResource>) {
    refuse();
}
ComputeProgram::ComputeProgram(ComputeProgram&&) noexcept = default;
ComputeProgram& ComputeProgram::operator=(ComputeProgram&&) noexcept = default;
ComputeProgram::~ComputeProgram() = default;
double ComputeProgram::run(std::uint32_t) {
    refuse();
}
void ComputeProgram::write(std::uint32_t, std::span<const float>) {
    refuse();
}
std::vector<float> ComputeProgram::read(std::uint32_t) const {
    refuse();
}

struct AmdCompiler::Parts {};

AmdCompiler::AmdCompiler() {
    refuse();
}
AmdCompiler::~AmdCompiler() = default;
ShaderCost AmdCompiler::costOf(std::span<const std::uint32_t>,
                               std::span<const ComputeResource>) const {
    refuse();
}

bool compilesGlsl() {
    return false;
}

std::vector<std::uint32_t> compileGlsl(const std::string&) {
    refuse();
}

}  // namespace hshfit::gpu::inline vulkan
