#include "runners.h"

namespace hshfit::shaders {

std::vector<float> runVulkan(const ShaderJob&, const std::vector<std::uint32_t>&, bool) {
    throw Missing("built without Vulkan (libvulkan-dev)");
}

}  // namespace hshfit::shaders
