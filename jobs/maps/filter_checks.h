#pragma once

#include "filtered.h"

#include <hshfit/filtered_maps/filtered_map.h>
#include <hshfit/material_maps/processes.h>
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
/// while rows stream by. Processes gather parts of the map, and share the measurements.
class FilterChecks {
public:
    /// `texels` of each level from 1 on, with 1,024 samples each, and all texels of the largest
    /// level with at most 64 a side for the picture.
    FilterChecks(std::size_t width, std::size_t height, const std::vector<LevelSize>& sizes,
                 int texels, Processes& processes);

    /// A row of level 0; rising rows.
    void add(std::size_t y, std::span<const SurfaceTexel> row);
    /// A row of a level, of which the numbers of measured texels are kept.
    void addFiltered(const MipRow& row, const MipLayout& layout);
    /// All that this process has of a part, for another one, which puts it in its place.
    std::vector<double> taken(const MipPart& part) const;
    void put(const MipPart& part, std::span<const double> numbers);
    /// To be called when the first process has all: then each has.
    void finish();

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
    MipErrorShare shareOf(std::size_t texels) const;
    template <class Each>
    void eachNumbers(const MipPart& part, const Each& each) const;

    std::size_t width_, height_;
    Processes& processes_;
    std::vector<LevelSize> sizes_;
    std::vector<Range> ranges_;  ///< of measured texels, by level
    std::size_t pictureLevel_ = 0;
    GatheredTexels measured_, pictured_;
    std::map<std::pair<int, std::size_t>, std::vector<std::size_t>> byRow_;
};

}  // namespace hshfit::jobs
