#pragma once

#include <hshfit/gpu/forms/library_table.h>
#include <hshfit/material_library/library.h>
#include <hshfit/material_library/log_terms.h>
#include <hshfit/material_library/shared_functions.h>

#include <cmath>

namespace hshfit::shaders {

/// The sums of the shader of all materials of a library, with its functions as constants.
inline gpu::SharedSums constantSums(const material_library::Library& library) {
    namespace ml = material_library;
    gpu::SharedSums sums{.functions = ml::sharedFunctions(library.basis),
                         .offset = ml::logOffset,
                         .topFirst = std::log(ml::logOffset),
                         .topStep = 1 / ml::topsPerLog,
                         .parts = {},
                         .materials = {}};
    for (const auto& [function, scale] : ml::texelParts(library.basis))
        sums.parts.push_back({function, scale});
    for (const ml::Material& material : library.materials) {
        const std::vector<double> row = ml::texelsOf(library.basis, material);
        sums.materials.insert(sums.materials.end(), row.begin(), row.end());
    }
    return sums;
}

}  // namespace hshfit::shaders
