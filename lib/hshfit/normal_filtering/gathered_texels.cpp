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
        texels_[k].base.resize(g.samples.size());
        g.blocks.assign((f.y + f.height - 1) / blockRows - f.y / blockRows + 1, noTexel());
        gathering_.push_back(std::move(g));
    }
}

template <class Block, class Sampled>
void GatheredTexels::each(std::size_t k, const MipRows& rows, const Block& block,
                          const Sampled& sample) const {
    const Gathering& g = gathering_[k];
    const std::size_t first = std::max(rows.first, g.y), last = std::min(rows.last, g.y + g.height);
    if (first >= last) return;
    for (std::size_t b = first / blockRows; b <= (last - 1) / blockRows; ++b)
        block(b - g.firstBlock());
    auto at = std::ranges::lower_bound(g.samples, first, {}, &Sample::y);
    for (; at != g.samples.end() && at->y < last; ++at)
        sample(static_cast<std::size_t>(at - g.samples.begin()));
}

void GatheredTexels::add(std::size_t y, std::span<const SurfaceTexel> row) {
    assert(row.size() == width_);
    for (std::size_t k = 0; k < gathering_.size(); ++k) {
        Gathering& g = gathering_[k];
        const double share = 1 / static_cast<double>(g.width * g.height);
        each(
            k, {y, y + 1},
            [&](std::size_t block) {
                for (std::size_t x = g.x; x < g.x + g.width; ++x)
                    addToMean(row[x], share, g.blocks[block]);
            },
            [&](std::size_t sample) { texels_[k].base[sample] = row[g.samples[sample].x]; });
    }
}

std::size_t GatheredTexels::takenCount(const MipRows& rows) const {
    std::size_t count = 0;
    const auto one = [&](std::size_t) { ++count; };
    for (std::size_t k = 0; k < gathering_.size(); ++k) each(k, rows, one, one);
    return count;
}

std::vector<SurfaceTexel> GatheredTexels::taken(const MipRows& rows) const {
    std::vector<SurfaceTexel> all;
    for (std::size_t k = 0; k < gathering_.size(); ++k) {
        each(
            k, rows, [&](std::size_t block) { all.push_back(gathering_[k].blocks[block]); },
            [&](std::size_t sample) { all.push_back(texels_[k].base[sample]); });
    }
    return all;
}

void GatheredTexels::put(const MipRows& rows, std::span<const SurfaceTexel> taken) {
    auto from = taken.begin();
    for (std::size_t k = 0; k < gathering_.size(); ++k) {
        each(
            k, rows, [&](std::size_t block) { gathering_[k].blocks[block] = *from++; },
            [&](std::size_t sample) { texels_[k].base[sample] = *from++; });
    }
}

void GatheredTexels::finish() {
    for (std::size_t k = 0; k < gathering_.size(); ++k) {
        SurfaceTexel& mean = texels_[k].mean;
        mean = noTexel();
        for (const SurfaceTexel& block : gathering_[k].blocks) addSum(block, mean);
        if (!(dot(mean.normal, mean.normal) > 1e-12)) mean.normal = {0, 0, 1};
    }
}

}  // namespace hshfit::inline normal_filtering
