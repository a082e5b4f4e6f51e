#include "pair_texels.h"

#include "texel_brdfs.h"

#include <hshfit/each_in_parallel.h>
#include <hshfit/error.h>
#include <hshfit/material_library/pair_fit.h>

#include <brdfs/catalog.h>

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace hshfit::jobs {

class PairTexels::Band final : public TexelBand {
public:
    Band(const PairTexels& source, std::size_t top) : source_(source), top_(top) {}
    void add(std::vector<float> row) { rows_.push_back(std::move(row)); }

    void texels(std::size_t row, std::size_t column, std::size_t count, float* out) const override {
        // A thread that waits for others must not begin another tile, whose memory is the thread's.
        tbb::this_task_arena::isolate([&] {
            eachInParallel(count, [&](std::size_t t) {
                texel(rows_[row - top_], column + t, out + t * source_.layout_.floats());
            });
        });
    }

private:
    void texel(const std::vector<float>& row, std::size_t column, float* out) const {
        const auto brdf = brdfs::openModel(specificationOf(source_.maps_, row, column));
        if (!brdf->laws().isotropic)
            throw InputError(fmt::format(
                "{}: is anisotropic, and libraries hold isotropic materials alone; the forms "
                "outgoing, low-rank and clusters take it",
                brdf->name()));
        const std::vector<double> values = evaluateOn(*brdf, material_library::fitPairs(), true);
        const std::size_t channels = brdf->channels().count(), pairs = values.size() / channels;
        for (std::size_t c = 0; c < source_.layout_.channels; ++c) {
            // A grey texel of a map in colours has its channel for all.
            const double* const from = values.data() + (channels == 1 ? 0 : c) * pairs;
            if (!std::all_of(from, from + pairs, [](double f) { return std::isfinite(f); }))
                throw NumericError(fmt::format("{}: f is not finite at a pair", brdf->name()));
            std::transform(from, from + pairs, out + c * pairs,
                           [](double f) { return static_cast<float>(std::max(f, 0.0)); });
        }
    }

    const PairTexels& source_;
    std::size_t top_;
    std::vector<std::vector<float>> rows_;
};

PairTexels::PairTexels(ParameterMaps& maps, std::size_t channels)
    : maps_(maps), layout_{.outgoing = OutgoingSet::parse("0,0"), .channels = channels} {
    layout_.slots.resize(material_library::fitPairs().size());
    std::iota(layout_.slots.begin(), layout_.slots.end(), 0);
}

std::unique_ptr<TexelBand> PairTexels::band(std::size_t top, std::size_t bottom) {
    auto band = std::make_unique<Band>(*this, top);
    for (std::size_t row = top; row < bottom; ++row) band->add(maps_.row(row));
    return band;
}

}  // namespace hshfit::jobs
