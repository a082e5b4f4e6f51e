#include <hshfit/normal_filtering/gathered_texels.h>

#include <hshfit/brdf/uniform.h>
#include <hshfit/normal_filtering/internal/mip_footprint.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace hshfit::inline normal_filtering {

GatheredTexels::GatheredTexels(std::size_t width, std::size_t height, std::vector<MipPlace> places,
                               int samples, std::uint64_t seed)
    : width_(width), places_(std::move(places)), texels_(places_.size()) {
    std::mt19937_64 random(seed);
    const auto side = static_cast<std::size_t>(std::sqrt(samples));
    for (std::size_t k = 0; k < places_.size(); ++k) {
        const auto& [level, index] = places_[k];
        const Footprint f =
            footprintOf(width, height, mipSize(width, level), mipSize(height, level), index);
        Gathering g{f.x, f.y, f.width, f.height};
        texels_[k].mean = noTexel();
        texels_[k].all = f.count() <= static_cast<std::size_t>(samples);
        if (texels_[k].all) {
            for (std::size_t i = 0; i < f.count(); ++i)
                g.samples.push_back({f.y + i / f.width, f.x + i % f.width});
        } else {
            for (std::size_t cell = 0; cell < side * side; ++cell) {
                const auto place = [&](std::size_t at, std::size_t from, std::size_t size) {
                    const double share =
                        (static_cast<double>(at) + uniform(random)) / static_cast<double>(side);
                    return from + static_cast<std::size_t>(share * static_cast<double>(size));
                };
                const std::size_t x = place(cell % side, f.x, f.width);
                g.samples.push_back({place(cell / side, f.y, f.height), x});
            }
            std::ranges::stable_sort(g.samples, {}, &Sample::y);
        }
        gathering_.push_back(std::move(g));
    }
}

void GatheredTexels::add(std::span<const SurfaceTexel> row) {
    assert(row.size() == width_);
    for (std::size_t k = 0; k < gathering_.size(); ++k) {
        Gathering& g = gathering_[k];
        if (row_ < g.y || row_ >= g.y + g.height) continue;
        MeasuredTexel& texel = texels_[k];
        const double share = 1 / static_cast<double>(g.width * g.height);
        for (std::size_t x = g.x; x < g.x + g.width; ++x) addToMean(row[x], share, texel.mean);
        for (; g.next < g.samples.size() && g.samples[g.next].y == row_; ++g.next)
            texel.base.push_back(row[g.samples[g.next].x]);
        if (row_ + 1 == g.y + g.height && !(dot(texel.mean.normal, texel.mean.normal) > 1e-12))
            texel.mean.normal = {0, 0, 1};
    }
    ++row_;
}

}  // namespace hshfit::inline normal_filtering
