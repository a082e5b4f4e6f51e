#pragma once

#include "shader_job.h"

#include <string>
#include <vector>

namespace hshfit::shaders {

/// A payload that exercises something that the others do not.
struct Variant {
    std::string name;
    gpu::Payload payload;
    int environmentOrder = 5;
    bool noise = false;  ///< neighbouring texels have nothing to do with each other
};

/// Every basis, map, packing, kind of number and kind of channels, at orders 3, 7 and 10.
std::vector<Variant> variants();

}  // namespace hshfit::shaders
