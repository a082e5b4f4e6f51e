#include "level_pass.h"

#include <hshfit/normal_filtering/gathered_texels.h>

#include <map>
#include <optional>

namespace hshfit::jobs {
namespace {

constexpr std::size_t partsOfProcess = 8;  // 32 were no faster (docs/explanation/svbrdf_scale.md)
/// Numbers of the level from which the first process goes on alone: 64 MiB of doubles.
constexpr std::size_t heldNumbers = std::size_t{1} << 23;

}  // namespace

void LevelPass::run(const MipLayout& layout, const LevelSinks& sinks,
                    const ProgressCall& progress) const {
    const std::size_t count = processes_.count();
    const MipParts parts = count == 1
                               ? MipParts(size_.width, size_.height)
                               : MipParts(size_.width, size_.height, partsOfProcess * count,
                                          layout.size(), heldNumbers, GatheredTexels::blockRows);
    const auto dealer = processes_.deal(parts.count());
    std::map<std::size_t, BandBytes> results;
    std::size_t done = 0;
    const auto rowDone = [&] {
        if (progress) progress(++done, size_.height);
    };
    while (const std::optional<std::size_t> k = dealer->next())
        results[*k] = partOf(parts.part(*k), layout, sinks, rowDone);
    dealer->collect(results);
    if (processes_.isFirst() && count > 1) finish(parts, results, layout, sinks);
    processes_.meet();
}

/// The numbers that the first process needs of a part: rows of its last level, then those taken.
BandBytes LevelPass::partOf(const MipPart& part, const MipLayout& layout, const LevelSinks& sinks,
                            const std::function<void()>& rowDone) const {
    std::vector<double> numbers;
    std::optional<MipFilter> filter;
    if (sinks.level) {
        filter.emplace(size_.width, part, table_, layout, [&](const MipRow& row) {
            sinks.level(row);
            if (row.level == part.level)
                numbers.insert(numbers.end(), row.texels.begin(), row.texels.end());
        });
    }
    const MipRows rows = filter ? part.needed(0) : part.own(0);
    for (std::size_t y = rows.first; y < rows.last; ++y) {
        const std::vector<SurfaceTexel> row = surface_.row(y);
        if (y < part.own(0).last) {
            sinks.base(y, row);
            rowDone();
        }
        if (filter) filter->add(row);
    }
    if (processes_.count() == 1) return {};
    if (sinks.taken) {
        const std::vector<double> taken = sinks.taken(part);
        numbers.insert(numbers.end(), taken.begin(), taken.end());
    }
    return bandBytes(numbers);
}

/// The levels that no part completes.
void LevelPass::finish(const MipParts& parts, const std::map<std::size_t, BandBytes>& results,
                       const MipLayout& layout, const LevelSinks& sinks) const {
    std::optional<MipFilter> above;
    if (sinks.level) above.emplace(size_.width, size_.height, table_, layout, sinks.level);
    const std::size_t length = mipSize(size_.width, parts.level()) * layout.size();
    for (const auto& [k, bytes] : results) {
        const std::vector<double> numbers = bandValues<double>(bytes);
        const MipPart part = parts.part(k);
        auto from = numbers.begin();
        for (std::size_t y = part.top.first; above && y < part.top.last; ++y) {
            const auto next = from + static_cast<std::ptrdiff_t>(length);
            above->addRow(part.level, {from, next});
            from = next;
        }
        if (sinks.put) sinks.put(part, {from, numbers.end()});
    }
}

}  // namespace hshfit::jobs
