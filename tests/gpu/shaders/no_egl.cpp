#include "bound_shader.h"

namespace hshfit::shaders {

struct GlContext::Parts {
    std::string renderer;
};

GlContext::GlContext(Api, gpu::DeviceChoice::Kind) {
    throw Missing("built without EGL (libegl-dev, libgl-dev, libopengl-dev)");
}
GlContext::~GlContext() = default;
const std::string& GlContext::renderer() const {
    return parts_->renderer;
}
bool GlContext::software() const {
    return true;
}
std::vector<float> GlContext::run(const BoundShader&) const {
    return {};
}

}  // namespace hshfit::shaders
