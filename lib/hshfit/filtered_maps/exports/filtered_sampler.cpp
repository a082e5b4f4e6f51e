#include <hshfit/filtered_maps/exports/filtered_sampler.h>

#include <hshfit/bases/sh.h>
#include <hshfit/filtered_maps/plain_texel.h>

#include <algorithm>
#include <utility>

namespace hshfit::inline filtered_maps::inline exports {

FilteredSampler::FilteredSampler(const FilteredMap& map, FilteredSurface surface,
                                 std::shared_ptr<const LobeTable> table, Wrap wrap)
    : map_(map), surface_(std::move(surface)), table_(std::move(table)), wrap_(wrap) {
    if (map_.harmonics() != nullptr) basis_ = bases::makeSh(map_.sidecar().layout.order, {});
}

/// Adds the value at a level of which corners are all at level 0 or all at others.
void FilteredSampler::add(double share, double level, const MapPlace& place, const Direction& wo,
                          const Direction& wi, std::span<double> out) const {
    const FilteredSidecar& s = map_.sidecar();
    std::vector<double> numbers;
    for (const MapCorner& corner : mapCorners(s.levels, {place.u, place.v, level}, wrap_)) {
        const std::vector<double> texel = map_.numbers(corner.level, corner.column, corner.row);
        numbers.resize(texel.size(), 0.0);
        for (std::size_t k = 0; k < texel.size(); ++k) numbers[k] += corner.share * texel[k];
    }
    const FilteredTexel texel(s.layout, numbers, *table_, basis_);
    std::vector<double> part(out.size());
    if (level == 0) {
        PlainTexel(surface_, s.layout, texel, numbers).reflect(wi, wo, part);
    } else {
        const MipForm form = map_.harmonics() ? MipForm::harmonics : MipForm::ellipse;
        texel.reflect({form}, surface_.rest, wi, wo, part, surface_.shape);
    }
    for (std::size_t c = 0; c < out.size(); ++c) out[c] += share * part[c];
}

std::vector<double> FilteredSampler::value(const MapPlace& place, const Direction& wo,
                                           const Direction& wi) const {
    std::vector<double> sum(map_.sidecar().channels.count(), 0.0);
    if (!(wi.z > 0) || !(wo.z > 0)) return sum;
    const double last = static_cast<double>(map_.sidecar().levels.size() - 1);
    const double level = std::clamp(place.level, 0.0, last), filtered = std::min(level, 1.0);
    if (filtered < 1) add(1 - filtered, 0, place, wo, wi, sum);
    if (filtered > 0) add(filtered, std::max(level, 1.0), place, wo, wi, sum);
    return sum;
}

std::vector<MapTest> FilteredSampler::tests() const {
    return mapTests(map_.sidecar().levels,
                    [&](const MapPlace& place, const Direction& wo, const Direction& wi) {
                        return value(place, wo, wi);
                    });
}

}  // namespace hshfit::inline filtered_maps::inline exports
