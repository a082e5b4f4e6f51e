// Files of light: what is written is read back, broken files end in InputError with one line that
// names file and field, and the schema in docs/ holds.

#include <hshfit/coefficient_files/light_file.h>
#include <hshfit/error.h>

#include "lib/coefficient_files/coefficient_samples.h"
#include "places.h"

#include <cstdlib>
#include <functional>
#include <limits>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <nlohmann/json.hpp>

using namespace hshfit;
using samples::Folder;
using Json = nlohmann::json;

namespace {

LightCoefficients sample(LightCoefficients::Domain domain, const Channels& channels, int order) {
    LightCoefficients light;
    light.basis = domain == LightCoefficients::Domain::sphere ? "sh" : "hsh";
    light.order = order;
    light.domain = domain;
    light.channels = channels;
    if (domain == LightCoefficients::Domain::hemisphere) {
        light.normalTheta = radians(52);
        light.normalPhi = radians(-33.3);
        light.condonShortley = true;
    }
    light.values = samples::randomValues(channels.count() * light.slots(), 5);
    light.energy = {4.0 / 3, 1e-9 / 3, true, ""};
    light.error = 1e-12 / 7;
    light.curves = {{"sh", {{1, 1, 0.25}, {2, 4, 2.0 / 3}}}};
    light.source = "picture.exr + sun:elevation=30 \"quoted\"";
    light.generator = "hshfit test";
    return light;
}

/// The message with which the text is refused, after the name of its file; empty if it reads.
std::string refusal(const std::string& text) {
    try {
        lightFromJson(text, "name");
    } catch (const InputError& error) {
        const std::string message = error.what();
        EXPECT_TRUE(message.starts_with("name")) << message;
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
        EXPECT_LT(message.size(), 400u);
        return message.substr(4);
    }
    return {};
}

Json written() {
    return Json::parse(
        lightToJson(sample(LightCoefficients::Domain::hemisphere, Channels::rgb(), 2)));
}

TEST(LightFile, ReadingGivesTheSameNumbers) {
    const Folder folder;
    using Domain = LightCoefficients::Domain;
    for (const Domain domain : {Domain::sphere, Domain::hemisphere}) {
        for (const Channels& channels : {Channels::rgb(), Channels::grey()}) {
            const LightCoefficients light = sample(domain, channels, 4);
            const std::string path = folder / "light.json";
            writeLight(light, path);
            EXPECT_TRUE(isLightFile(path));
            const LightCoefficients again = readLight(path);
            EXPECT_EQ(again.values, light.values);
            EXPECT_EQ(again.basis, light.basis);
            EXPECT_EQ(again.order, light.order);
            EXPECT_EQ(again.condonShortley, light.condonShortley);
            EXPECT_EQ(again.domain, light.domain);
            EXPECT_NEAR(again.normalTheta, light.normalTheta, 1e-12);
            EXPECT_NEAR(again.normalPhi, light.normalPhi, 1e-12);
            EXPECT_EQ(again.channels.names(), channels.names());
            EXPECT_EQ(again.energy.value, light.energy.value);
            EXPECT_EQ(again.energy.error, light.energy.error);
            EXPECT_EQ(again.error, light.error);
            ASSERT_EQ(again.curves.size(), 1u);
            EXPECT_EQ(again.curves[0].points[1].accuracy, 2.0 / 3);
            EXPECT_EQ(again.source, light.source);
            EXPECT_EQ(again.generator, light.generator);
        }
    }
}

TEST(LightFile, EnergyThatDoesNotExistIsNull) {
    LightCoefficients light = sample(LightCoefficients::Domain::sphere, Channels::rgb(), 2);
    const double none = std::numeric_limits<double>::quiet_NaN();
    light.energy = {none, none, false, "a point has none"};
    light.curves[0].points[0].accuracy = none;
    const Json json = Json::parse(lightToJson(light));
    EXPECT_TRUE(json["energy"]["value"].is_null());
    EXPECT_TRUE(json["curves"][0]["points"][0]["accuracy"].is_null());
    EXPECT_EQ(lightFromJson(json.dump(), "name").energy.reason, "a point has none");
    light.values[3] = none;
    EXPECT_THROW(lightToJson(light), NumericError);
}

TEST(LightFile, EveryTruncationIsRefused) {
    const std::string whole = written().dump();
    ASSERT_EQ(refusal(whole), "");
    for (std::size_t size = 0; size < whole.size(); ++size)
        ASSERT_FALSE(refusal(whole.substr(0, size)).empty()) << size;
}

TEST(LightFile, RefusalsNameTheFieldAndTheRule) {
    struct Case {
        const char* message;
        std::function<void(Json&)> change;
    };
    const Case cases[] = {
        {"'format' is 'hshfit-report'", [](Json& j) { j["format"] = "hshfit-report"; }},
        {"newer hshfit", [](Json& j) { j["version"] = 2; }},
        {"'basis.name' is 'nope'", [](Json& j) { j["basis"]["name"] = "nope"; }},
        {"'basis.order'", [](Json& j) { j["basis"]["order"] = 1 << 20; }},
        {"'basis.index'", [](Json& j) { j["basis"]["index"] = "m"; }},
        {"needs the basis 'sh'", [](Json& j) { j["domain"] = "sphere"; }},
        {"'domain' has to be", [](Json& j) { j["domain"] = "disc"; }},
        {"'normal' has to be an object", [](Json& j) { j["normal"] = nullptr; }},
        {"'normal.theta' is 181", [](Json& j) { j["normal"]["theta"] = 181; }},
        {"'channels' has to be",
         [](Json& j) {
             j["channels"] = {"B", "G", "R"};
         }},
        {"'channels' has to be", [](Json& j) { j["channels"] = Json::object(); }},
        {"'energy.value'", [](Json& j) { j["energy"]["value"] = nullptr; }},
        {"'energy.value' has to be at least 0", [](Json& j) { j["energy"]["value"] = -1; }},
        {"'energy.reason' is missing",
         [](Json& j) {
             j["energy"] = {{"value", nullptr}, {"error", nullptr}, {"finite", false}};
         }},
        {"'error' has to be a number or null", [](Json& j) { j["error"] = "small"; }},
        {"'curves[0].points[0].order'", [](Json& j) { j["curves"][0]["points"][0]["order"] = 0; }},
        {"'coefficients' is missing", [](Json& j) { j.erase("coefficients"); }},
        {"3 arrays of 4 numbers", [](Json& j) { j["coefficients"].erase(0); }},
        {"3 arrays of 4 numbers", [](Json& j) { j["coefficients"][1].push_back(1); }},
        {"'coefficients' has to be", [](Json& j) { j["coefficients"][2][0] = "1"; }},
        {"'coefficients' has to be", [](Json& j) { j["coefficients"][2][0] = nullptr; }},
        {"'source.light' is missing", [](Json& j) { j["source"] = Json::object(); }},
    };
    for (const Case& each : cases) {
        Json json = written();
        each.change(json);
        const std::string message = refusal(json.dump());
        EXPECT_NE(message.find(each.message), std::string::npos)
            << "'" << message << "'\nexpected: " << each.message;
    }
    EXPECT_NE(refusal("{\"format\":\"hshfit-light\",\"format\":\"\"}").find("twice"),
              std::string::npos);
    EXPECT_FALSE(refusal(std::string(5000, '[')).empty());
    EXPECT_FALSE(refusal("").empty());
}

TEST(LightFile, FilesThatAreNoneAreRefused) {
    const Folder folder;
    EXPECT_THROW(readLight(folder / "none.json"), InputError);
    EXPECT_THROW(readLight(folder.path().string()), InputError);
    EXPECT_FALSE(isLightFile(folder / "none.json"));
    EXPECT_FALSE(isLightFile(folder.path().string()));
    samples::put(folder / "empty.json", "");
    EXPECT_THROW(readLight(folder / "empty.json"), InputError);
    samples::put(folder / "other.json", "{\"format\":\"hshfit-coefficients\"}");
    EXPECT_FALSE(isLightFile(folder / "other.json"));
}

TEST(LightFile, KeepsTheSchema) {
    const Folder folder;
    using Domain = LightCoefficients::Domain;
    LightCoefficients point = sample(Domain::sphere, Channels::grey(), 2);
    point.energy = {0, 0, false, "a point has none"};
    writeLight(point, folder / "point.json");
    writeLight(sample(Domain::sphere, Channels::rgb(), 3), folder / "sphere.json");
    writeLight(sample(Domain::hemisphere, Channels::rgb(), 3), folder / "hemisphere.json");
    const std::string source = test::sourceFolder();
    const int status =
        std::system(("/usr/bin/python3 '" + source + "/tests/validate_schema.py' '" + source +
                     "/docs/schemas/light_file.schema.json' " + folder.path().string() + "/*.json")
                        .c_str());
    const int code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    if (code == 77 || code == 127) GTEST_SKIP() << "no /usr/bin/python3 with jsonschema";
    EXPECT_EQ(code, 0);
}

}  // namespace
