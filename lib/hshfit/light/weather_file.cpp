#include <hshfit/light/internal/weather_file.h>

#include <hshfit/error.h>
#include <hshfit/files/mapped_file.h>
#include <hshfit/files/printable.h>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <optional>
#include <vector>

namespace hshfit::inline light {
namespace {

constexpr std::size_t mostBytes = std::size_t{1} << 26;
constexpr std::size_t headerLines = 8, headerMost = 64;
constexpr double missing = 9999;  // values from here on are missing, by the data dictionary

/// Fields of a line of the data, from 0.
enum Field { yearField, monthField, dayField, hourField, direct = 14, diffuse = 15 };

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && std::isspace(static_cast<unsigned char>(text.front())))
        text.remove_prefix(1);
    while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back())))
        text.remove_suffix(1);
    return text;
}

bool sameWords(std::string_view a, std::string_view b) {
    return std::ranges::equal(a, b, [](char x, char y) {
        return std::toupper(static_cast<unsigned char>(x)) ==
               std::toupper(static_cast<unsigned char>(y));
    });
}

/// The lines of a text, and the fields of the present one.
class Lines {
public:
    Lines(std::string_view text, const std::string& name) : rest_(text), name_(name) {
        if (rest_.starts_with("\xef\xbb\xbf")) rest_.remove_prefix(3);
    }

    /// Goes on to the next line that is not empty.
    bool next() {
        while (!rest_.empty()) {
            const std::size_t end = std::min(rest_.find_first_of("\r\n"), rest_.size());
            line_ = trimmed(rest_.substr(0, end));
            const bool both = rest_.substr(end).starts_with("\r\n");
            rest_.remove_prefix(std::min(end + (both ? 2 : 1), rest_.size()));
            ++number_;
            if (line_.empty()) continue;
            split();
            return true;
        }
        return false;
    }

    std::size_t number() const { return number_; }
    std::string_view text() const { return line_; }
    std::string_view field(std::size_t k) const {
        return k < fields_.size() ? fields_[k] : std::string_view();
    }

    double value(std::size_t k, std::string_view what, double least, double most) const {
        const std::string_view text = field(k);
        double value = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        const bool whole = error == std::errc() && end == text.data() + text.size();
        if (!whole || !(value >= least && value <= most))
            fail(fmt::format("field {}, the {}, is '{}'; valid: {} to {}", k + 1, what,
                             printable(shortened(text, 40)), least, most));
        return value;
    }

    int whole(std::size_t k, std::string_view what, int least, int most) const {
        const double number = value(k, what, least, most);
        if (number != std::floor(number))
            fail(fmt::format("field {}, the {}, is no whole number", k + 1, what));
        return static_cast<int>(number);
    }

    [[noreturn]] void fail(const std::string& what) const {
        throw InputError(fmt::format("{}, line {}: {}", name_, number_, what));
    }

private:
    void split() {
        fields_.clear();
        std::string_view rest = line_;
        constexpr std::size_t needed = 16;  // long lines have more fields than are read
        while (fields_.size() < needed) {
            const std::size_t comma = std::min(rest.find(','), rest.size());
            fields_.push_back(trimmed(rest.substr(0, comma)));
            if (comma == rest.size()) break;
            rest.remove_prefix(comma + 1);
        }
    }

    std::string_view rest_, line_;
    const std::string& name_;
    std::size_t number_ = 0;
    std::vector<std::string_view> fields_;
};

WeatherPlace placeOf(Lines& lines, const std::string& name) {
    if (!lines.next() || !sameWords(lines.field(0), "LOCATION"))
        throw InputError(
            fmt::format("{}: is no EPW weather file: it begins with '{}' instead of "
                        "'LOCATION,city,state,country,source,station,latitude,longitude,zone,"
                        "elevation'",
                        name, printable(shortened(lines.text(), 40))));
    return {.latitude = radians(lines.value(6, "latitude in degrees", -90, 90)),
            .longitude = radians(lines.value(7, "longitude in degrees", -180, 180)),
            .zone = lines.value(8, "time zone in hours", -12, 14),
            .altitude = lines.value(9, "elevation in metres", -1000, 9999.9)};
}

/// Goes to the last line of the header.
void passHeader(Lines& lines, const std::string& name) {
    for (std::size_t k = 1; k < headerMost && lines.next(); ++k) {
        if (!sameWords(lines.field(0), "DATA PERIODS")) continue;
        const int count = lines.whole(2, "number of records an hour", 1, 60);
        if (count > 1) lines.fail(fmt::format("has {} records an hour; valid: 1", count));
        return;
    }
    throw InputError(
        fmt::format("{}: has no line DATA PERIODS, which ends the {} lines of an EPW header", name,
                    headerLines));
}

double irradianceOf(const Lines& lines, std::size_t field, std::string_view what) {
    const std::string_view text = lines.field(field);
    if (text.empty())
        lines.fail(
            fmt::format("field {}, the {}, is missing; a line has 35 fields", field + 1, what));
    const double value = lines.value(field, what, 0, 1e6);
    if (value >= missing)
        lines.fail(
            fmt::format("field {}, the {}, is missing ({}); another hour has to be taken, "
                        "or direct= and diffuse= be given",
                        field + 1, what, text));
    return value;
}

/// Whether the present line is for the moment's month, day and hour.
bool holds(const Lines& lines, const Moment& local) {
    return lines.whole(monthField, "month", 1, 12) == local.month &&
           lines.whole(dayField, "day", 1, 31) == local.day &&
           lines.whole(hourField, "hour", 1, 24) == static_cast<int>(std::floor(local.hour)) + 1;
}

}  // namespace

Weather weatherIn(std::string_view text, const std::string& name, const Moment& local) {
    Lines lines(text, name);
    const WeatherPlace place = placeOf(lines, name);
    passHeader(lines, name);
    std::optional<Weather> found;
    std::size_t count = 0;
    while (lines.next()) {
        if (!holds(lines, local)) continue;
        ++count;
        const int year = lines.whole(yearField, "year", 0, 9999);
        if (found && (found->year == local.year || year != local.year)) continue;
        found = Weather{
            .place = place,
            .direct = irradianceOf(lines, direct, "direct normal radiation in Wh/m^2"),
            .diffuse = irradianceOf(lines, diffuse, "diffuse horizontal radiation in Wh/m^2"),
            .line = lines.number(),
            .year = year};
    }
    const int minutes = static_cast<int>(std::lround(local.hour * 60));
    const std::string moment = fmt::format("{:02}:{:02} on {:04}-{:02}-{:02}", minutes / 60,
                                           minutes % 60, local.year, local.month, local.day);
    if (!found)
        throw InputError(
            fmt::format("{}: has no line for {}; valid: a time of its period", name, moment));
    if (count > 1 && found->year != local.year)
        throw InputError(
            fmt::format("{}: has {} lines for the month, day and hour of {}, none of "
                        "that year; the first is of {}",
                        name, count, moment, found->year));
    return *found;
}

Weather readWeather(const std::string& path, const Moment& local) {
    const MappedFile file(path);
    if (file.size() > mostBytes)
        throw InputError(fmt::format("{}: has {} bytes; an EPW weather file has at most {}", path,
                                     file.size(), mostBytes));
    const std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
    const Weather weather = weatherIn(text, path, local);
    file.checkIntact();
    return weather;
}

}  // namespace hshfit::inline light
