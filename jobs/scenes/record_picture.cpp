#include "record_picture.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace hshfit::jobs {

RgbPicture withRecords(const RgbPicture& picture, const RadianceCache& cache, const Camera& camera,
                       std::size_t fresh, double stops) {
    RgbPicture shown = picture;
    for (float& value : shown.values) value /= 2;
    const auto white = static_cast<float>(std::exp2(-stops));
    const std::array<float, 3> earlier{white, 0.35F * white, 0},
        now{0.1F * white, 0.6F * white, white};
    const int radius = std::max(0, picture.height / 400);
    for (const RecordPlace& place : recordPlaces(cache, camera)) {
        const std::array<float, 3>& colour = place.record < fresh ? earlier : now;
        for (int y = std::max(0, place.row - radius);
             y <= std::min(picture.height - 1, place.row + radius); ++y) {
            for (int x = std::max(0, place.column - radius);
                 x <= std::min(picture.width - 1, place.column + radius); ++x) {
                std::copy(colour.begin(), colour.end(),
                          shown.values.begin() + 3 * (static_cast<long>(y) * picture.width + x));
            }
        }
    }
    return shown;
}

}  // namespace hshfit::jobs
