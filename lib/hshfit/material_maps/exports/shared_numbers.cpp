#include <hshfit/material_maps/exports/shared_numbers.h>

#include <hshfit/error.h>

#include <fmt/format.h>

#include <vector>

namespace hshfit::inline material_maps::inline exports {

SharedNumbers sharedNumbers(const MapSidecar& map) {
    if (map.shapes.empty()) throw UsageError("a map of the form outgoing shares no numbers");
    const std::size_t rank = map.rank(), slots = map.layout.slots.size();
    const std::size_t outgoing = map.layout.outgoing.size(), weights = map.channels.count() * rank;
    const std::size_t materials = map.centres.size() / weights;
    SharedNumbers shared;
    shared.groupsOfShapes = (rank * slots + 3) / 4;
    shared.groupsOfMaterial = (weights + 3) / 4;
    shared.firstMaterial = outgoing * shared.groupsOfShapes;
    const std::size_t count = shared.firstMaterial + materials * shared.groupsOfMaterial;
    const std::size_t rows = (count + SharedNumbers::width - 1) / SharedNumbers::width;
    if (rows > SharedNumbers::mostRows) {
        throw UsageError(fmt::format(
            "{} materials of {} weights are more than a texture of {} x {} holds; a lower rank or "
            "fewer clusters fit",
            materials, weights, SharedNumbers::width, SharedNumbers::mostRows));
    }
    std::vector<double> values(rows * SharedNumbers::width * 4, 0.0);
    for (std::size_t r = 0; r < rank; ++r) {
        for (std::size_t o = 0; o < outgoing; ++o) {
            for (std::size_t s = 0; s < slots; ++s)
                values[o * shared.groupsOfShapes * 4 + r * slots + s] =
                    map.shapes[(r * outgoing + o) * slots + s];
        }
    }
    for (std::size_t k = 0; k < materials; ++k) {
        for (std::size_t w = 0; w < weights; ++w)
            values[(shared.firstMaterial + k * shared.groupsOfMaterial) * 4 + w] =
                static_cast<double>(map.centres[k * weights + w]);
    }
    shared.texels =
        gpu::encode(values, SharedNumbers::width, static_cast<int>(rows), 1, gpu::Number::float32);
    return shared;
}

}  // namespace hshfit::inline material_maps::inline exports
