#pragma once

#include <hshfit/light/internal/solar_position.h>

#include <cstddef>
#include <string>
#include <string_view>

namespace hshfit::inline light {

/// The place of a weather station, as the LOCATION line of its file states it.
struct WeatherPlace {
    double latitude = 0, longitude = 0;  ///< radians, positive in the north and in the east
    double zone = 0;                     ///< hours that its standard time is ahead of Universal
    double altitude = 0;                 ///< metres above the sea
};

/// One hour of an EPW file: means of irradiance over it, W/m^2.
struct Weather {
    WeatherPlace place;
    double direct = 0;     ///< of a surface across the sun's beam
    double diffuse = 0;    ///< of a horizontal surface, by the sky without the sun's disc
    std::size_t line = 0;  ///< of the file, from 1
    int year = 0;          ///< as the line states it: typical years are made of several
};

/// Reads the hour of an EnergyPlus weather file (EnergyPlus "Auxiliary Programs", EPW data
/// dictionary) that holds a moment in the standard time of the place. Hour 1 of a day goes from
/// 0:00 to 1:00, so that 12:00 begins hour 13. Fields 15 and 16 of a line are the irradiances, in
/// Wh/m^2 during the hour. The line is the one of the moment's month, day and hour, whatever its
/// year; where there are several, the year has to agree too.
///
/// Throws InputError that starts with `name` for a text that is no EPW file, a place out of range,
/// several records an hour, a date without a line, and irradiances that are missing (9999),
/// negative or no numbers.
Weather weatherIn(std::string_view text, const std::string& name, const Moment& local);

/// The same for a file of at most 64 MiB.
Weather readWeather(const std::string& path, const Moment& local);

}  // namespace hshfit::inline light
