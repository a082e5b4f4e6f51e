#include <hshfit/error.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/files/mapped_file.h>
#include <hshfit/light/catalog.h>
#include <hshfit/plan/scene.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

namespace hshfit::plan {
namespace {

using Json = nlohmann::json;
using Keys = std::vector<std::string_view>;

constexpr std::size_t mostBytes = std::size_t{1} << 24;
constexpr int deepest = 8;
constexpr double brightest = 1e9;

void onlyKeys(const JsonFields& fields, const Json& object, const Keys& valid) {
    for (const auto& [key, value] : object.items()) {
        if (std::find(valid.begin(), valid.end(), key) != valid.end()) continue;
        fields.fail(fmt::format("is not known; valid: {}", fmt::join(valid, ", ")),
                    key.substr(0, 40));
    }
}

/// A number within [low, high].
double numberIn(const JsonFields& fields, const char* key, double low, double high) {
    const double value = fields.number(key);
    if (!(value >= low && value <= high)) {
        fields.fail(fmt::format("is {:g}; it has to be from {:g} to {:g}", value, low, high), key);
    }
    return value;
}
double angle(const JsonFields& fields, const char* key, double low, double high) {
    return radians(numberIn(fields, key, low, high));
}
double angleOr0(const JsonFields& fields, const char* key, double low, double high) {
    return fields.has(key) ? angle(fields, key, low, high) : 0;
}

/// One number for grey, or three.
Rgb colour(const JsonFields& fields, const char* key) {
    Rgb rgb{};
    if (fields.at(key).is_number()) {
        rgb.fill(fields.number(key));
    } else {
        const std::vector<double> values = fields.numbers(key, 3);
        std::copy(values.begin(), values.end(), rgb.begin());
    }
    for (double value : rgb) {
        if (!(value >= 0 && value <= brightest)) {
            fields.fail(fmt::format("holds {:g}; it has to be from 0 to {:g}", value, brightest),
                        key);
        }
    }
    return rgb;
}

[[noreturn]] void failWord(const JsonFields& fields, const char* key, const Keys& valid) {
    fields.fail(
        fmt::format("is '{}'; valid: {}", fields.word(key).substr(0, 40), fmt::join(valid, ", ")),
        key);
}

Direction towards(const JsonFields& fields) {
    return directionFromAngles(angle(fields, "theta", 0, 180), angleOr0(fields, "phi", -360, 360));
}

DiscLight discLight(const JsonFields& fields, const Json& object) {
    onlyKeys(fields, object,
             {"kind", "theta", "phi", "angular_diameter", "irradiance", "radiance"});
    DiscLight light{.towards = towards(fields),
                    .radius = angle(fields, "angular_diameter", 0.01, 180) / 2};
    if (fields.has("irradiance") == fields.has("radiance")) {
        fields.fail("needs 'irradiance' (across the beam) or 'radiance', one of the two");
    }
    if (fields.has("radiance")) {
        light.radiance = colour(fields, "radiance");
        return light;
    }
    light.radiance = colour(fields, "irradiance");
    for (double& value : light.radiance) value /= pi * std::pow(std::sin(light.radius), 2);
    return light;
}

PanelLight panelLight(const JsonFields& fields, const Json& object) {
    onlyKeys(fields, object, {"kind", "theta", "phi", "width", "height", "turn", "radiance"});
    return {.towards = towards(fields),
            .width = angle(fields, "width", 0.01, 170),
            .height = angle(fields, "height", 0.01, 170),
            .turn = angleOr0(fields, "turn", -360, 360),
            .radiance = colour(fields, "radiance")};
}

SkyLight skyLight(const JsonFields& fields, const Json& object) {
    onlyKeys(fields, object, {"kind", "model", "radiance", "ground"});
    SkyLight light;
    const std::string model = fields.word("model");
    if (model == "overcast") {
        light.model = SkyLight::Model::overcast;
    } else if (model != "uniform") {
        failWord(fields, "model", {"uniform", "overcast"});
    }
    light.zenith = colour(fields, "radiance");
    if (fields.has("ground")) light.ground = colour(fields, "ground");
    return light;
}

PictureLight pictureLight(const JsonFields& fields, const Json& object, const std::string& scene) {
    onlyKeys(fields, object, {"kind", "file", "scale", "turn"});
    const std::filesystem::path file = fields.word("file");
    const std::filesystem::path place =
        file.is_absolute() ? file : std::filesystem::path(scene).parent_path() / file;
    PictureLight light = readPictureLight(
        place.string(), fields.has("scale") ? numberIn(fields, "scale", 0, brightest) : 1);
    light.turn = angleOr0(fields, "turn", -360, 360);
    return light;
}

/// A light or, by its specification, several.
std::vector<Light> lightsOf(const JsonFields& fields, const Json& object,
                            const std::string& scene) {
    if (fields.has("light")) {
        onlyKeys(fields, object, {"light"});
        const std::string folder = std::filesystem::path(scene).parent_path().string();
        try {
            return parseLights(fields.word("light"), folder).lights;
        } catch (const UsageError& error) {
            fields.fail(error.what(), "light");
        }
    }
    const std::string kind = fields.word("kind");
    if (kind == "disc") return {discLight(fields, object)};
    if (kind == "panel") return {panelLight(fields, object)};
    if (kind == "sky") return {skyLight(fields, object)};
    if (kind == "environment") return {pictureLight(fields, object, scene)};
    failWord(fields, "kind", {"disc", "panel", "sky", "environment"});
}

/// [from, to] in degrees.
std::pair<double, double> range(const JsonFields& fields, const char* key, double low, double high,
                                double widest) {
    const std::vector<double> ends = fields.numbers(key, 2);
    if (!(ends[0] >= low && ends[0] <= ends[1] && ends[1] <= high && ends[1] - ends[0] <= widest)) {
        fields.fail(fmt::format("is [{:g}, {:g}]; it has to be [from, to] in degrees, rising, "
                                "from {:g} to {:g} and at most {:g} wide",
                                ends[0], ends[1], low, high, widest),
                    key);
    }
    return {radians(ends[0]), radians(ends[1])};
}

ViewRange viewRange(const JsonFields& fields, const Json& object) {
    onlyKeys(fields, object, {"theta", "phi", "tangent"});
    ViewRange views;
    if (fields.has("theta")) {
        std::tie(views.thetaMin, views.thetaMax) = range(fields, "theta", 0, 89, 89);
    }
    if (fields.has("phi")) {
        std::tie(views.phiMin, views.phiMax) = range(fields, "phi", -360, 360, 360);
    }
    if (fields.has("tangent")) {
        const std::string tangent = fields.word("tangent");
        if (tangent != "any" && tangent != "fixed") failWord(fields, "tangent", {"fixed", "any"});
        views.anyTangent = tangent == "any";
    }
    return views;
}

Budget budget(const JsonFields& fields, const Json& object) {
    onlyKeys(fields, object, {"metric", "error"});
    Budget result{.error = numberIn(fields, "error", 1e-4, 1)};
    if (fields.has("metric")) {
        const std::string metric = fields.word("metric");
        if (metric == metricName(Budget::Metric::log)) {
            result.metric = Budget::Metric::log;
        } else if (metric != metricName(Budget::Metric::relativeL2)) {
            failWord(fields, "metric", {"relative_l2", "log"});
        }
    }
    return result;
}

Limits limits(const JsonFields& fields, const Json& object) {
    onlyKeys(fields, object, {"bytes", "nanoseconds"});
    Limits result;
    if (fields.has("bytes")) {
        result.bytes = static_cast<std::size_t>(fields.integer("bytes", 1, 1 << 30));
    }
    if (fields.has("nanoseconds")) result.nanoseconds = numberIn(fields, "nanoseconds", 1e-3, 1e9);
    return result;
}

/// Elements of an array with their JSON; at least one.
std::vector<std::pair<JsonFields, const Json*>> elements(const JsonFields& fields,
                                                         const char* key) {
    std::vector<std::pair<JsonFields, const Json*>> result;
    for (const JsonFields& each : fields.objects(key)) {
        result.emplace_back(each, &fields.at(key)[result.size()]);
    }
    if (result.empty()) fields.fail("has to hold at least one", key);
    return result;
}

Material material(const JsonFields& fields, const Json& object, const Budget& standard) {
    onlyKeys(fields, object, {"name", "brdf", "lobe", "orientations", "budget"});
    Material result{.name = fields.word("name"), .brdf = fields.word("brdf"), .budget = standard};
    const auto plain = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
               c == '-' || c == '_' || c == '.';
    };
    if (result.name.empty() || result.name.size() > 100 || result.name[0] == '.' ||
        !std::all_of(result.name.begin(), result.name.end(), plain) || result.name == "plan") {
        fields.fail("names a file: letters, digits, '-', '_' and '.', up to 100, not 'plan'",
                    "name");
    }
    if (fields.has("lobe")) result.lobe = fields.word("lobe");
    if (fields.has("budget")) result.budget = budget(fields.object("budget"), fields.at("budget"));
    if (!fields.has("orientations")) return result;
    result.orientations.clear();
    for (const auto& [each, json] : elements(fields, "orientations")) {
        onlyKeys(each, *json, {"theta", "phi", "turn"});
        result.orientations.push_back({angle(each, "theta", 0, 180),
                                       angleOr0(each, "phi", -360, 360),
                                       angleOr0(each, "turn", -360, 360)});
    }
    return result;
}

}  // namespace

Scene readScene(const std::string& path) {
    const MappedFile file(path);
    if (file.size() > mostBytes) {
        throw InputError(fmt::format("{}: {} bytes are too many for a scene", path, file.size()));
    }
    const Json json =
        parseJson({reinterpret_cast<const char*>(file.data()), file.size()}, path, deepest);
    const JsonFields root(json, "", path);
    onlyKeys(root, json,
             {"format", "version", "about", "materials", "lights", "views", "budget", "limits"});
    if (root.word("format") != "hshfit-scene") failWord(root, "format", {"hshfit-scene"});
    root.integer("version", 1, 1);
    if (root.has("about")) root.word("about");
    Scene scene{.file = path, .materials = {}, .lights = {}, .views = {}, .limits = {}};
    const Budget standard = budget(root.object("budget"), root.at("budget"));
    std::set<std::string> names;
    for (const auto& [each, object] : elements(root, "materials")) {
        scene.materials.push_back(material(each, *object, standard));
        if (!names.insert(scene.materials.back().name).second) {
            each.fail("is the name of two materials", "name");
        }
    }
    for (const auto& [each, object] : elements(root, "lights")) {
        for (Light& one : lightsOf(each, *object, path)) scene.lights.push_back(std::move(one));
    }
    if (root.has("views")) scene.views = viewRange(root.object("views"), root.at("views"));
    if (root.has("limits")) scene.limits = limits(root.object("limits"), root.at("limits"));
    file.checkIntact();
    return scene;
}

}  // namespace hshfit::plan
