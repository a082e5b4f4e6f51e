#pragma once

#include <hshfit/brdf/directions.h>
#include <hshfit/light/internal/weather_file.h>
#include <hshfit/specification/parameters.h>

#include <optional>
#include <string_view>
#include <vector>

namespace hshfit::inline light {

/// The sun of a light, and the weather of its hour where a file has it.
struct PlacedSun {
    Direction towards;
    std::optional<Weather> weather = {};
    double distance = 1;  ///< of the Earth from the sun, astronomical units; 1 without weather
};

/// Keys that state where the sun is: its direction, at the elevation `lowest` or higher, or a place
/// and a time. `weatherParameter` is the key of a weather file, which can stand for the place.
std::vector<Parameter> sunPlaceParameters(double lowest);
Parameter weatherParameter(std::string_view help);

/// The direction of elevation and azimuth.
Direction fromElevation(const Parameters& parameters);

/// The sun by elevation and azimuth, by place and time, or by a weather file and time. Throws
/// UsageError that starts with `owner` where keys are missing or contradict each other, and for a
/// sun below the horizon by place or file; InputError as readWeather does.
PlacedSun placedSun(std::string_view owner, const Parameters& parameters);

}  // namespace hshfit::inline light
