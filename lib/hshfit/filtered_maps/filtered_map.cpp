#include <hshfit/filtered_maps/filtered_map.h>

namespace hshfit::inline filtered_maps {

FilteredMap::FilteredMap(FilteredSidecar sidecar, std::string file)
    : file_(std::move(file)),
      sidecar_(std::move(sidecar)),
      texture_(sidecar_.texture, sidecar_.levels, sidecar_.layers(), sidecar_.number, file_) {
    if (sidecar_.form != "harmonics") return;
    harmonics_ = std::make_unique<LevelTexture>(
        sidecar_.harmonics,
        std::vector<LevelSize>(sidecar_.levels.begin() + 1, sidecar_.levels.end()),
        sidecar_.harmonicLayers(), sidecar_.number, file_);
}

std::vector<double> FilteredMap::numbers(std::size_t level, std::size_t column,
                                         std::size_t row) const {
    std::vector<double> numbers = texture_.numbers(level, column, row);
    numbers.resize(sidecar_.layout.ellipseSize());
    momentsOf(numbers);
    if (level == 0 || !harmonics_) return numbers;
    const std::vector<double> rest = harmonics_->numbers(level - 1, column, row);
    numbers.insert(numbers.end(), rest.begin(), rest.end());
    numbers.resize(sidecar_.layout.size());
    return numbers;
}

void FilteredMap::checkIntact() const {
    texture_.checkIntact();
    if (harmonics_) harmonics_->checkIntact();
}

}  // namespace hshfit::inline filtered_maps
