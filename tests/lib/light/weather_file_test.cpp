// EPW weather files: hours, places, missing values, and the lights that take them.
#include "temporary_file.h"
#include "temporary_folder.h"

#include <hshfit/error.h>
#include <hshfit/light/catalog.h>
#include <hshfit/light/internal/perez_sky.h>
#include <hshfit/light/internal/weather_file.h>
#include <hshfit/light/light_samples.h>
#include <hshfit/light/sky.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <string>

namespace hshfit {
namespace {

using test::expectInputError;

/// The irradiances that the files of this test state, functions of month, day and hour.
int directOf(int month, int day, int hour) {
    return hour < 6 || hour > 19 ? 0 : 100 + 10 * hour + month + day;
}
int diffuseOf(int month, int day, int hour) {
    return hour < 6 || hour > 19 ? 0 : 50 + 3 * hour + 2 * month + day;
}

std::string header(const std::string& place = "50.10,14.25,1.0,364.0") {
    return "LOCATION,Prague,-,CZE,IWEC Data,115180," + place +
           "\r\nDESIGN CONDITIONS,0\r\nTYPICAL/EXTREME PERIODS,0\r\nGROUND TEMPERATURES,0\r\n"
           "HOLIDAYS/DAYLIGHT SAVINGS,No,0,0,0\r\nCOMMENTS 1,made by a test, of course\r\n"
           "COMMENTS 2,\r\nDATA PERIODS,1,1,Data,Sunday, 1/ 1,12/31\r\n";
}

std::string line(int year, int month, int day, int hour, const std::string& direct,
                 const std::string& diffuse) {
    std::string text = fmt::format("{},{},{},{},0,?9?9?9?9E0,", year, month, day, hour);
    // Dry bulb, dew point, humidity, pressure, extraterrestrial horizontal and normal, infrared,
    // global horizontal; direct, diffuse; illuminances and the rest.
    text += "21.1,10.0,50,96000,900,1325,330,500," + direct + "," + diffuse;
    for (int field = 17; field <= 35; ++field) text += ",9";
    return text + "\r\n";
}

std::string line(int year, int month, int day, int hour) {
    return line(year, month, day, hour, std::to_string(directOf(month, day, hour)),
                std::to_string(diffuseOf(month, day, hour)));
}

/// Some days, each month of another year as in typical years.
std::string days() {
    std::string text;
    for (const auto& [month, day] : {std::pair(1, 15), std::pair(6, 20), std::pair(6, 21)})
        for (int hour = 1; hour <= 24; ++hour) text += line(1980 + month, month, day, hour);
    return text;
}

double irradiance(const std::string& spec, const Orientation& surface) {
    const LightSpecification parsed = parseLights(spec);
    const LightSamples samples = sampleLights(parsed.lights, Frame(surface), 3);
    double sum = 0;
    for (std::size_t k = 0; k < samples.count(); ++k) sum += samples.flux[1][k] * samples.z[k];
    return sum;
}

/// A surface across the direction.
Orientation across(const Direction& d) {
    return {polarAngle(d), std::atan2(d.y, d.x), 0};
}

std::string usageMessage(const std::string& spec) {
    try {
        parseLights(spec);
    } catch (const UsageError& error) {
        return error.what();
    }
    return "no usage error";
}

TEST(WeatherFile, AnHourGoesFromTheOneBeforeToItsOwn) {
    const std::string text = header() + days();
    for (int hour = 1; hour <= 24; ++hour) {
        for (const double minutes : {0.0, 29.5, 59.0}) {
            const Weather weather =
                weatherIn(text, "input", {2024, 6, 21, hour - 1 + minutes / 60});
            EXPECT_EQ(weather.direct, directOf(6, 21, hour)) << hour << " " << minutes;
            EXPECT_EQ(weather.diffuse, diffuseOf(6, 21, hour)) << hour << " " << minutes;
            EXPECT_EQ(weather.line, 8U + 48U + static_cast<std::size_t>(hour));
            EXPECT_EQ(weather.year, 1986);
        }
    }
    const Weather weather = weatherIn(text, "input", {2024, 1, 15, 12});
    EXPECT_DOUBLE_EQ(weather.place.latitude, radians(50.10));
    EXPECT_DOUBLE_EQ(weather.place.longitude, radians(14.25));
    EXPECT_EQ(weather.place.zone, 1);
    EXPECT_EQ(weather.place.altitude, 364);
    // Line feeds alone, and a byte-order mark.
    std::string other = "\xef\xbb\xbf" + text;
    std::erase(other, '\r');
    EXPECT_EQ(weatherIn(other, "input", {2024, 6, 20, 9.5}).direct, directOf(6, 20, 10));
}

TEST(WeatherFile, LightsHaveItsIrradianceAndTheSunOfItsPlace) {
    const test::TemporaryFile file(header() + days(), ".epw");
    for (const auto& [month, day, clock, hour] :
         {std::tuple(6, 21, "12:00", 13), std::tuple(6, 20, "07:45", 8),
          std::tuple(1, 15, "14:30:30", 15)}) {
        const std::string moment = fmt::format("date=2024-{:02}-{:02},time={}", month, day, clock);
        const std::string fromFile = fmt::format("file={},{}", file.path(), moment);
        const double direct = directOf(month, day, hour), diffuse = diffuseOf(month, day, hour);
        EXPECT_NEAR(irradiance("perez:" + fromFile, {}), diffuse, 2e-6 * diffuse) << moment;
        const auto sun = std::get<DiscLight>(parseLights("sun:" + fromFile).lights[0]);
        EXPECT_NEAR(irradiance("sun:" + fromFile, across(sun.towards)), direct, 2e-6 * direct);
        const auto placed = std::get<DiscLight>(
            parseLights("sun:latitude=50.1,longitude=14.25,zone=1," + moment).lights[0]);
        EXPECT_LT(std::hypot(sun.towards.x - placed.towards.x, sun.towards.y - placed.towards.y,
                             sun.towards.z - placed.towards.z),
                  1e-12);
        const auto sky = std::get<SkyLight>(parseLights("perez:" + fromFile).lights[0]);
        EXPECT_EQ(sky.sun.z, sun.towards.z);
        // The sum is the global irradiance of the hour.
        const double global = irradiance("perez:" + fromFile + "+sun:" + fromFile, {});
        EXPECT_NEAR(global, diffuse + direct * sun.towards.z, 1e-4 * global);
        // A stated irradiance of the sun replaces the file's.
        EXPECT_NEAR(irradiance("sun:" + fromFile + ",irradiance=7", across(sun.towards)), 7, 2e-5);
        EXPECT_NEAR(irradiance("perez:" + fromFile + ",scale=2,turn=30", {}), 2 * diffuse,
                    4e-6 * diffuse);
    }
}

/// 1367 W/m^2 at the mean distance: 3.4 % more in January than in July.
TEST(WeatherFile, TheSkyCountsWithTheDistanceOfTheSun) {
    const test::TemporaryFile file(header() + days(), ".epw");
    const std::string spec = "perez:file=" + file.path() + ",date=2024-01-15,time=12:30";
    const auto sky = std::get<SkyLight>(parseLights(spec).lights[0]);
    const double r = sunDistance({2024, 1, 15, 11.5});
    const SkyLight expected =
        perezSky(sky.sun, directOf(1, 15, 13), diffuseOf(1, 15, 13), 1367 / (r * r));
    EXPECT_DOUBLE_EQ(sky.shapes[0].c, expected.shapes[0].c);
    const auto stated = std::get<SkyLight>(parseLights(spec + ",extraterrestrial=1400").lights[0]);
    EXPECT_DOUBLE_EQ(
        stated.shapes[0].c,
        perezSky(sky.sun, directOf(1, 15, 13), diffuseOf(1, 15, 13), 1400).shapes[0].c);
}

/// Meeus, Astronomical Algorithms, example 25.a; perihelion and aphelion of 2024 as almanacs print
/// them (0.98331 on 3 January, 1.01673 on 5 July).
TEST(WeatherFile, DistancesOfTheSunAreThoseOfAlmanacs) {
    EXPECT_NEAR(sunDistance({1992, 10, 13, 0}), 0.99766, 1e-4);
    EXPECT_NEAR(sunDistance({2024, 1, 3, 1}), 0.98331, 1e-4);
    EXPECT_NEAR(sunDistance({2024, 7, 5, 5}), 1.01673, 1e-4);
}

TEST(WeatherFile, PathsAreSeenFromTheFolderOfTheScene) {
    const test::TemporaryFolder folder;
    std::ofstream(folder / "city.epw", std::ios::binary) << header() + days();
    const std::string spec = "perez:file=city.epw,date=2024-06-21,time=10:30";
    EXPECT_EQ(parseLights(spec, folder.path().string()).lights.size(), 1U);
    EXPECT_THROW(parseLights(spec), InputError);
}

TEST(WeatherFile, TheYearDecidesAmongSeveral) {
    const std::string text = header() + line(2001, 6, 21, 13, "1", "2") +
                             line(2002, 6, 21, 13, "3", "4") + line(2003, 6, 21, 13, "5", "6");
    EXPECT_EQ(weatherIn(text, "input", {2001, 6, 21, 12}).direct, 1);
    EXPECT_EQ(weatherIn(text, "input", {2002, 6, 21, 12}).direct, 3);
    EXPECT_EQ(weatherIn(text, "input", {2003, 6, 21, 12}).diffuse, 6);
    expectInputError(
        [&] {
            weatherIn(text, "input", {2024, 6, 21, 12});
        },
        {"input", "3 lines", "12:00 on 2024-06-21", "2001"});
}

TEST(WeatherFile, FaultsAreNamedWithTheirPlace) {
    const auto refused = [](const std::string& text, const std::vector<std::string>& parts) {
        expectInputError([&] { weatherIn(text, "city.epw", {2024, 6, 21, 12.5}); }, parts);
    };
    const auto with = [](const std::string& direct, const std::string& diffuse) {
        return header() + line(1986, 6, 21, 12) + line(1986, 6, 21, 13, direct, diffuse);
    };
    refused(with("9999", "100"), {"city.epw, line 10", "field 15", "direct normal", "missing"});
    refused(with("100", "9999"), {"city.epw, line 10", "field 16", "diffuse", "missing"});
    refused(with("99999", "100"), {"line 10", "missing"});
    refused(with("-1", "100"), {"line 10", "'-1'", "valid: 0"});
    refused(with("nan", "100"), {"line 10", "'nan'"});
    refused(with("1e300", "100"), {"line 10", "field 15"});
    refused(with("", "100"), {"line 10", "field 15", "missing"});
    refused(header() + "1986,6,21,13,60,?9,1,2\r\n", {"line 9", "field 15", "35 fields"});
    refused(header() + "1986,6,21,25,0\r\n", {"line 9", "field 4, the hour", "1 to 24"});
    refused(header() + "1986,x,21,2,0\r\n", {"line 9", "field 2, the month", "'x'"});
    refused(header(), {"city.epw", "no line for 12:30 on 2024-06-21"});
    refused(header() + line(1986, 6, 22, 13), {"no line for 12:30 on 2024-06-21"});
    refused("", {"city.epw", "no EPW weather file"});
    refused("<html>\n", {"city.epw", "no EPW weather file", "<html>", "LOCATION"});
    refused("LOCATION,a,b,c,d,e,91,14,1,300\n", {"line 1", "latitude", "-90 to 90"});
    refused(header("50,181,1,300"), {"line 1", "longitude"});
    refused(header("50,14,99,300"), {"line 1", "time zone"});
    refused("LOCATION,a,b,c,d,e,50\n", {"line 1", "longitude", "''"});
    refused("LOCATION,a,b,c,d,e,50,14,1,300\nDESIGN CONDITIONS,0\n", {"DATA PERIODS", "header"});
    std::string quarters = header() + line(1986, 6, 21, 13);
    quarters.replace(quarters.find("DATA PERIODS,1,1"), 16, "DATA PERIODS,1,4");
    refused(quarters, {"line 8", "4 records an hour", "valid: 1"});
}

TEST(WeatherFile, KeysThatContradictTheFileAreRefused) {
    const test::TemporaryFile file(header() + days(), ".epw");
    const std::string spec = "perez:file=" + file.path();
    const std::string noon = spec + ",date=2024-06-21,time=12:00";
    EXPECT_NE(usageMessage(spec).find("date is missing"), std::string::npos);
    EXPECT_NE(usageMessage(spec + ",date=2024-06-21").find("time is missing"), std::string::npos);
    for (const std::string key : {"elevation=3", "azimuth=3", "latitude=3", "longitude=3", "zone=3",
                                  "direct=3", "diffuse=3"})
        EXPECT_NE(usageMessage(noon + "," + key).find("beside a weather file"), std::string::npos)
            << key;
    EXPECT_NE(usageMessage(spec + ",date=2024-06-21,time=02:00").find("below the horizon"),
              std::string::npos);
    EXPECT_NE(usageMessage("sky:type=12,file=" + file.path()).find("valid: type"),
              std::string::npos);
    // Daylight by the clock, and none by the file.
    expectInputError([&] { parseLights(spec + ",date=2024-06-21,time=04:30"); },
                     {file.path(), "line 61", "diffuse horizontal radiation is 0"});
    expectInputError([&] { parseLights("sun:file=/no/such.epw,date=2024-06-21,time=12:00"); },
                     {"/no/such.epw"});
}

/// Every prefix of a file is read or refused.
TEST(WeatherFile, FilesThatBreakOffAreReadOrRefused) {
    const std::string text = header() + line(1986, 6, 21, 13);
    std::size_t read = 0;
    for (std::size_t size = 0; size < text.size(); ++size) {
        try {
            const Weather weather =
                weatherIn(std::string_view(text).substr(0, size), "cut", {2024, 6, 21, 12});
            EXPECT_GE(weather.diffuse, 0);
            ++read;
        } catch (const InputError& error) {
            EXPECT_EQ(std::string(error.what()).find("cut"), 0U);
        }
    }
    // The fields after the diffuse radiation may be cut off.
    EXPECT_GT(read, 19U);
    EXPECT_LT(read, 60U);
}

}  // namespace
}  // namespace hshfit
