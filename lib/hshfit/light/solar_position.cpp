#include <hshfit/light/internal/solar_position.h>

#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <optional>

namespace hshfit::inline light {
namespace {

/// Days since the noon of 1 January 2000, Universal Time.
double daysSince2000(const Moment& moment) {
    using namespace std::chrono;
    const sys_days day = year(moment.year) / moment.month / moment.day;
    const sys_days start = year(2000) / 1 / 1;
    return static_cast<double>((day - start).count()) + (moment.hour - 12) / 24;
}

/// The mean anomaly, radians.
double anomalyAt(double days) {
    return radians(357.528 + 0.9856003 * days);
}

/// Degrees of refraction at a true elevation in degrees.
double refraction(double elevation) {
    if (elevation < -0.56) return 0.56;
    const double e = elevation;
    return 3.51561 * (0.1594 + 0.0196 * e + 0.00002 * e * e) / (1 + 0.505 * e + 0.0845 * e * e);
}

/// Whole numbers of fixed places, "dddd-dd-dd" for the form "4-2-2".
std::optional<int> digits(std::string_view text, std::size_t at, std::size_t count) {
    if (at + count > text.size()) return {};
    const std::string_view part = text.substr(at, count);
    if (!std::ranges::all_of(part, [](char c) { return c >= '0' && c <= '9'; })) return {};
    int value = 0;
    std::from_chars(part.data(), part.data() + part.size(), value);
    return value;
}

}  // namespace

SolarPosition solarPosition(const Moment& moment, double latitude, double longitude) {
    const double n = daysSince2000(moment);
    const double meanLongitude = 280.460 + 0.9856474 * n;
    const double anomaly = anomalyAt(n);
    const double ecliptic =
        radians(meanLongitude + 1.915 * std::sin(anomaly) + 0.020 * std::sin(2 * anomaly));
    const double obliquity = radians(23.439 - 0.0000004 * n);
    const double ascension =
        std::atan2(std::cos(obliquity) * std::sin(ecliptic), std::cos(ecliptic));
    const double declination = std::asin(std::sin(obliquity) * std::sin(ecliptic));
    const double greenwich = 6.697375 + 0.0657098242 * n + moment.hour;
    const double hourAngle = radians(15 * std::remainder(greenwich, 24.0)) + longitude - ascension;

    // The unit vector towards the sun: east, north, up.
    const double east = -std::cos(declination) * std::sin(hourAngle);
    const double north = std::sin(declination) * std::cos(latitude) -
                         std::cos(declination) * std::sin(latitude) * std::cos(hourAngle);
    const double up = std::sin(declination) * std::sin(latitude) +
                      std::cos(declination) * std::cos(latitude) * std::cos(hourAngle);
    const double elevation = degrees(std::atan2(up, std::hypot(east, north)));
    const double turn = std::atan2(east, north);
    return {radians(std::min(elevation + refraction(elevation), 90.0)),
            turn < 0 ? turn + 2 * pi : turn};
}

double sunDistance(const Moment& moment) {
    const double g = anomalyAt(daysSince2000(moment));
    return 1.00014 - 0.01671 * std::cos(g) - 0.00014 * std::cos(2 * g);
}

Direction directionOf(const SolarPosition& position) {
    return directionFromAngles(pi / 2 - position.elevation, pi / 2 - position.azimuth);
}

Moment parseMoment(std::string_view owner, std::string_view date, std::string_view time,
                   double zone) {
    const auto year = digits(date, 0, 4), month = digits(date, 5, 2), day = digits(date, 8, 2);
    const bool form = date.size() == 10 && date[4] == '-' && date[7] == '-';
    if (!form || !year || !month || !day || !(std::chrono::year(*year) / *month / *day).ok())
        throw UsageError(
            fmt::format("{}: date={} is no date; valid: a year, month and day such as "
                        "2024-06-21",
                        owner, date));
    if (*year < 1950 || *year > 2050)
        throw UsageError(fmt::format("{}: date={} is out of range; valid: 1950-01-01 to 2050-12-31",
                                     owner, date));
    const auto hour = digits(time, 0, 2), minute = digits(time, 3, 2);
    const auto second = time.size() > 5 ? digits(time, 6, 2) : 0;
    const bool clock = (time.size() == 5 || (time.size() == 8 && time[5] == ':')) && time[2] == ':';
    if (!clock || !hour || !minute || !second || *hour > 23 || *minute > 59 || *second > 59)
        throw UsageError(
            fmt::format("{}: time={} is no time of the day; valid: hours and minutes "
                        "such as 09:30, seconds if wanted",
                        owner, time));
    return {*year, *month, *day, *hour + *minute / 60.0 + *second / 3600.0 - zone};
}

}  // namespace hshfit::inline light
