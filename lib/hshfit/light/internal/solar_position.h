#pragma once

#include <hshfit/brdf/directions.h>

#include <string>
#include <string_view>

namespace hshfit::inline light {

/// A moment of the Gregorian calendar in Universal Time; `hour` may lie outside of the day.
struct Moment {
    int year = 2000, month = 1, day = 1;
    double hour = 12;
};

/// The apparent place of the sun's centre, radians. `azimuth` from north by east.
struct SolarPosition {
    double elevation = 0, azimuth = 0;
};

/// The algorithm of Michalsky 1988 (Solar Energy 40(3), "The Astronomical Almanac's algorithm for
/// approximate solar position (1950-2050)") with its refraction for an average atmosphere. Error
/// 0.01 degrees from 1950 to 2050. `latitude` positive in the north, `longitude` in the east,
/// radians.
SolarPosition solarPosition(const Moment& moment, double latitude, double longitude);

/// The distance of the Earth from the sun, astronomical units; error 1e-4 (The Astronomical
/// Almanac, low-precision formulas for the sun: R = 1.00014 - 0.01671 cos g - 0.00014 cos 2g).
double sunDistance(const Moment& moment);

/// The direction of the sun in a world with +x east, +y north and +z up.
Direction directionOf(const SolarPosition& position);

/// "2024-06-21" and "12:00" or "12:00:30", local time of a zone that is `zone` hours ahead of
/// Universal Time. Throws UsageError that starts with `owner` for another form, a date that the
/// calendar lacks, a year outside 1950 to 2050.
Moment parseMoment(std::string_view owner, std::string_view date, std::string_view time,
                   double zone);

}  // namespace hshfit::inline light
