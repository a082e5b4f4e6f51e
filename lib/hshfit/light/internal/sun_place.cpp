#include <hshfit/light/internal/sun_place.h>

#include <hshfit/error.h>
#include <hshfit/light/internal/solar_position.h>

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>

namespace hshfit::inline light {
namespace {

constexpr double notGiven = -1000;  // outside of every range: the help says the default

Parameter number(std::string_view name, std::string_view help, double fallback, double min,
                 double max) {
    return {.name = name, .help = help, .fallback = fallback, .min = min, .max = max};
}

Parameter words(std::string_view name, std::string_view help, std::string_view example) {
    return {.name = name, .help = help, .kind = Parameter::Kind::text, .choices = {example}};
}

/// The sun of a moment of Universal Time, above the horizon.
Direction riseOf(std::string_view owner, const Parameters& p, const Moment& moment, double latitude,
                 double longitude) {
    const SolarPosition sun = solarPosition(moment, latitude, longitude);
    if (sun.elevation < 0)
        throw UsageError(
            fmt::format("{}: the sun is {:.2f} degrees below the horizon at {} on {}; "
                        "valid: a time between sunrise and sunset",
                        owner, -degrees(sun.elevation), p.choice("time"), p.choice("date")));
    return directionOf(sun);
}

PlacedSun sunOfWeather(std::string_view owner, const Parameters& p) {
    for (const std::string_view name : {"date", "time"})
        if (!p.given(name))
            throw UsageError(
                fmt::format("{}: {} is missing; a weather file needs date and time", owner, name));
    for (const std::string_view name :
         {"elevation", "azimuth", "latitude", "longitude", "zone", "direct", "diffuse"})
        if (p.given(name))
            throw UsageError(
                fmt::format("{}: {} is given beside a weather file, which has it; "
                            "valid: one of the two",
                            owner, name));
    Moment moment = parseMoment(owner, p.choice("date"), p.choice("time"), 0);
    const Weather weather = readWeather(p.choice("file"), moment);
    moment.hour -= weather.place.zone;
    const std::string named = fmt::format("{}: {}", owner, p.choice("file"));
    return {riseOf(named, p, moment, weather.place.latitude, weather.place.longitude), weather,
            sunDistance(moment)};
}

}  // namespace

std::vector<Parameter> sunPlaceParameters(double lowest) {
    return {number("elevation", "of the sun, degrees from the horizon; or a place and time",
                   notGiven, lowest, 90),
            number("azimuth", "degrees from +x towards +y", 0, -360, 360),
            number("latitude", "degrees, positive in the north", notGiven, -90, 90),
            number("longitude", "degrees, positive in the east", notGiven, -180, 180),
            words("date", "of the place, 1950 to 2050", "2024-06-21"),
            words("time", "of the place", "12:00"),
            number("zone", "hours that the place's time is ahead of Universal Time", 0, -14, 14)};
}

Parameter weatherParameter(std::string_view help) {
    return words("file", help, "CITY.epw");
}

Direction fromElevation(const Parameters& p) {
    return directionFromAngles(radians(90 - p.number("elevation")), radians(p.number("azimuth")));
}

PlacedSun placedSun(std::string_view owner, const Parameters& p) {
    if (p.given("file")) return sunOfWeather(owner, p);
    constexpr std::string_view place[] = {"latitude", "longitude", "date", "time"};
    const auto stated = [&](std::string_view name) { return p.given(name); };
    if (!std::ranges::any_of(place, stated)) {
        if (!p.given("elevation"))
            throw UsageError(
                fmt::format("{}: elevation has to be given, or latitude, longitude, "
                            "date and time",
                            owner));
        if (p.given("zone"))
            throw UsageError(fmt::format("{}: zone is given without date and time", owner));
        return {fromElevation(p)};
    }
    for (const std::string_view name : place)
        if (!p.given(name))
            throw UsageError(
                fmt::format("{}: {} is missing; a place and time needs latitude, "
                            "longitude, date and time",
                            owner, name));
    for (const std::string_view name : {"elevation", "azimuth"})
        if (p.given(name))
            throw UsageError(fmt::format(
                "{}: {} is given beside a place and time; valid: one of the two", owner, name));
    const Moment moment = parseMoment(owner, p.choice("date"), p.choice("time"), p.number("zone"));
    return {
        riseOf(owner, p, moment, radians(p.number("latitude")), radians(p.number("longitude")))};
}

}  // namespace hshfit::inline light
