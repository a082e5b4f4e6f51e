#include "runners.h"

namespace hshfit::shaders {

std::vector<float> runOpenGl(const ShaderJob&, const std::string&) {
    throw Missing("built without EGL (libegl-dev, libgl-dev, libopengl-dev)");
}

std::vector<float> runOpenGlEs(const ShaderJob&, const std::string&) {
    throw Missing("built without EGL (libegl-dev, libgl-dev, libopengl-dev)");
}

}  // namespace hshfit::shaders
