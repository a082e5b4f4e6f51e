#pragma once

#include "filtered.h"

#include <hshfit/filtered_maps/filtered_map.h>
#include <hshfit/normal_filtering/gathered_texels.h>

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace hshfit::jobs {

/// The worst of a form over all levels.
struct WorstOfForm {
    std::size_t level = 0;  ///< with the largest error
    double texel = 0;       ///< of the worst texel of any level, in its own norm, and its place
    std::size_t texelLevel = 0, column = 0, row = 0;
};

/// Measures texels of the levels of a filtered map against texels of level 0, which are gathered
/// while rows stream by.
class FilterChecks {
public:
    /// `texels` of each level from 1 on, with 1,024 samples each, and all texels of the largest
    /// level with at most 64 a side for the picture.
    FilterChecks(std::size_t width, std::size_t height, const std::vector<LevelSize>& sizes,
                 int texels);

    /// The next row of level 0.
    void add(std::span<const SurfaceTexel> row);
    /// A row of a level, of which the numbers of measured texels are kept.
    void addFiltered(const MipRow& row, const MipLayout& layout);

    /// Every form by the error of its worst level, after `addFiltered` of all; places[form].
    MipErrors worst(const FilteredSurface& surface, const MipLayout& layout, const LobeTable& table,
                    const std::vector<int>& orders, std::vector<WorstOfForm>& places,
                    const Listener& listener) const;
    /// Fills in the levels of the answer from the written map.
    void measure(const FilteredSurface& surface, const LobeTable& table, const FilteredMap& map,
                 std::vector<FilteredLevel>& levels, const Listener& listener);
    /// After `measure`: errors of all texels of a level as grey on a logarithmic scale of three
    /// decades, white at the largest: stored to the left, averaged parameters to the right. PNG.
    std::string picture(const FilteredSurface& surface, const LobeTable& table,
                        const FilteredMap& map) const;

private:
    struct Range {
        std::size_t first = 0, count = 0;
    };
    MipErrors measureLevel(const FilteredSurface& surface, const MipLayout& layout,
                           const LobeTable& table, const Range& range,
                           const MipErrorOptions& options) const;

    std::vector<LevelSize> sizes_;
    std::vector<Range> ranges_;  ///< of measured texels, by level
    std::size_t pictureLevel_ = 0;
    GatheredTexels measured_, pictured_;
    std::map<std::pair<int, std::size_t>, std::vector<std::size_t>> byRow_;
};

}  // namespace hshfit::jobs
