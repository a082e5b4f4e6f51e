#pragma once

#include <jobs/common/listener.h>
#include "facet_surface.h"

#include <hshfit/material_maps/processes.h>
#include <hshfit/normal_filtering/mip_filter.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace hshfit::jobs {

/// Receives the rows of all levels: each row in one process, the rows of the last levels in the
/// first process.
struct LevelSinks {
    std::function<void(std::size_t y, std::span<const SurfaceTexel> row)> base = {};
    std::function<void(const MipRow& row)> level = {};  ///< none: level 0 alone
    /// The numbers of a part that the first process needs; `put` receives them there.
    std::function<std::vector<double>(const MipPart& part)> taken = {};
    std::function<void(const MipPart& part, std::span<const double> numbers)> put = {};
};

/// Goes over a surface once, in parts that are dealt out to processes as they ask for them. Rows
/// have the same bits for any number of processes. Returns when all rows have been received.
class LevelPass {
public:
    LevelPass(FacetSurface& surface, const LevelSize& size, std::shared_ptr<const LobeTable> table,
              Processes& processes)
        : surface_(surface), size_(size), table_(std::move(table)), processes_(processes) {}

    void run(const MipLayout& layout, const LevelSinks& sinks, const ProgressCall& progress) const;

private:
    BandBytes partOf(const MipPart& part, const MipLayout& layout, const LevelSinks& sinks,
                     const std::function<void()>& rowDone) const;
    void finish(const MipParts& parts, const std::map<std::size_t, BandBytes>& results,
                const MipLayout& layout, const LevelSinks& sinks) const;

    FacetSurface& surface_;
    LevelSize size_;
    std::shared_ptr<const LobeTable> table_;
    Processes& processes_;
};

}  // namespace hshfit::jobs
