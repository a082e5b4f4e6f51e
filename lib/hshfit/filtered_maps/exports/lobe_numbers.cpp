#include <hshfit/filtered_maps/exports/internal/lobe_numbers.h>

#include <hshfit/material_maps/exports/shared_numbers.h>

#include <algorithm>
#include <cassert>
#include <vector>

namespace hshfit::inline filtered_maps::inline exports {

LobeNumbers lobeNumbers(const FilteredSidecar& map) {
    const auto nodesOf = [&](std::size_t k) {
        return k < map.nodes.size() ? map.nodes[k].values.size() : std::size_t{1};
    };
    LobeNumbers made{nodesOf(0), nodesOf(1)};
    assert(map.lobes.size() == made.nodes());
    for (const StoredLobe& lobe : map.lobes)
        made.gaussians = std::max(made.gaussians, lobe.gaussians.peaks.size());
    constexpr std::size_t width = SharedNumbers::width;
    const std::size_t count = made.nodes() * (1 + made.gaussians);
    const std::size_t rows = (count + width - 1) / width;
    std::vector<double> values(rows * width * 4, 0.0);
    for (std::size_t node = 0; node < made.nodes(); ++node) {
        const StoredLobe& lobe = map.lobes[node];
        double* head = &values[node * 4];
        head[0] = lobe.widthX;
        head[1] = lobe.widthY;
        if (!map.nodes.empty()) head[2] = map.nodes[0].values[node / made.columns];
        if (map.nodes.size() > 1) head[3] = map.nodes[1].values[node % made.columns];
        double* gaussians = &values[(made.nodes() + node * made.gaussians) * 4];
        for (std::size_t j = 0; j < made.gaussians; ++j) {
            const bool there = j < lobe.gaussians.peaks.size();
            gaussians[4 * j] = there ? lobe.gaussians.peaks[j] : 0;
            gaussians[4 * j + 1] = there ? lobe.gaussians.variances[j] : 1;
        }
    }
    made.texels = gpu::encode(values, static_cast<int>(width), static_cast<int>(rows), 1,
                              gpu::Number::float32);
    return made;
}

}  // namespace hshfit::inline filtered_maps::inline exports
