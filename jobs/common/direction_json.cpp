#include "direction_json.h"

#include <nlohmann/json.hpp>

namespace hshfit::jobs {

nlohmann::ordered_json directionJson(const Direction& d) {
    return {{"theta", degrees(polarAngle(d))}, {"phi", degrees(azimuth(d))}};
}

}  // namespace hshfit::jobs
