#pragma once

#include "shader_job.h"

#include <string>
#include <vector>

namespace hshfit::shaders {

/// A payload with a feature that the others lack.
struct Variant {
    std::string name;
    gpu::Payload payload;
    int environmentOrder = 5;
    bool noise = false;  ///< neighbouring texels have independent values
};

/// Every basis, map, packing, kind of number and kind of channels, at orders 3, 7 and 10.
std::vector<Variant> variants();

}  // namespace hshfit::shaders
