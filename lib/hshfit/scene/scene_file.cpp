#include <hshfit/error.h>
#include <hshfit/files/mapped_file.h>
#include <hshfit/scene/internal/scene_fields.h>
#include <hshfit/scene/scene.h>

#include <fmt/format.h>

#include <algorithm>

namespace hshfit::scene {
namespace {

constexpr std::size_t mostBytes = std::size_t{1} << 24;
constexpr int deepest = 8;

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

ViewRange viewRange(const JsonFields& fields) {
    onlyKeys(fields, {"theta", "phi", "tangent"});
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

Budget budget(const JsonFields& fields) {
    onlyKeys(fields, {"metric", "error", "flip"});
    Budget result{.error = numberIn(fields, "error", 1e-4, 1)};
    if (fields.has("metric")) {
        const std::string metric = fields.word("metric");
        if (metric == metricName(Budget::Metric::log)) {
            result.metric = Budget::Metric::log;
        } else if (metric != metricName(Budget::Metric::relativeL2)) {
            failWord(fields, "metric", {"relative_l2", "log"});
        }
    }
    if (fields.has("flip")) result.flip = numberIn(fields, "flip", 1e-4, 1);
    return result;
}

Limits limits(const JsonFields& fields) {
    onlyKeys(fields, {"bytes", "nanoseconds"});
    Limits result;
    if (fields.has("bytes")) {
        result.bytes = static_cast<std::size_t>(fields.integer("bytes", 1, 1 << 30));
    }
    if (fields.has("nanoseconds")) result.nanoseconds = numberIn(fields, "nanoseconds", 1e-3, 1e9);
    return result;
}

Material material(const JsonFields& fields, const Budget& standard) {
    onlyKeys(fields, {"name", "brdf", "lobe", "orientations", "budget"});
    Material result{.name = nameOf(fields), .brdf = fields.word("brdf"), .budget = standard};
    if (result.name == "plan") fields.fail("is the name of the answer's files", "name");
    if (fields.has("lobe")) result.lobe = fields.word("lobe");
    if (fields.has("budget")) result.budget = budget(fields.object("budget"));
    if (!fields.has("orientations")) return result;
    result.orientations.clear();
    result.orientationsStated = true;
    for (const JsonFields& each : elements(fields, "orientations")) {
        onlyKeys(each, {"theta", "phi", "turn"});
        result.orientations.push_back({angle(each, "theta", 0, 180),
                                       angleOr0(each, "phi", -360, 360),
                                       angleOr0(each, "turn", -360, 360)});
    }
    return result;
}

template <class Named>
void refuseTwice(const JsonFields& fields, const std::vector<Named>& all, const char* what) {
    for (std::size_t k = 0; k + 1 < all.size(); ++k) {
        if (all[k].name == all.back().name && !all[k].name.empty())
            fields.fail(fmt::format("is the name of two {}", what), "name");
    }
}

void readParts(const JsonFields& root, Purpose purpose, Scene& scene) {
    const bool plan = purpose == Purpose::plan;
    const Budget standard = plan || root.has("budget") ? budget(root.object("budget")) : Budget{};
    for (const JsonFields& each : elements(root, "materials")) {
        scene.materials.push_back(material(each, standard));
        refuseTwice(each, scene.materials, "materials");
    }
    if (plan || root.has("lights")) {
        for (const JsonFields& each : elements(root, "lights"))
            for (Light& one : lightsOf(each, scene.file)) scene.lights.push_back(std::move(one));
    }
    if (!plan || root.has("objects")) {
        for (const JsonFields& each : elements(root, "objects")) {
            scene.objects.push_back(objectOf(each, scene.materials, scene.file));
            refuseTwice(each, scene.objects, "objects");
        }
    }
    if (!plan || root.has("cameras")) {
        for (const JsonFields& each : elements(root, "cameras")) {
            scene.cameras.push_back(cameraOf(each));
            refuseTwice(each, scene.cameras, "cameras");
        }
    }
    scene.viewsStated = root.has("views");
    if (scene.viewsStated) scene.views = viewRange(root.object("views"));
    if (root.has("limits")) scene.limits = limits(root.object("limits"));
}

}  // namespace

Scene readScene(const std::string& path, Purpose purpose) {
    const MappedFile file(path);
    if (file.size() > mostBytes) {
        throw InputError(fmt::format("{}: {} bytes are too many for a scene", path, file.size()));
    }
    const nlohmann::json json =
        parseJson({reinterpret_cast<const char*>(file.data()), file.size()}, path, deepest);
    const JsonFields root(json, "", path);
    // Checked before the keys, since another kind of file has other keys.
    if (root.has("format") && root.word("format") != "hshfit-scene")
        failWord(root, "format", {"hshfit-scene"});
    onlyKeys(root, {"format", "version", "about", "materials", "lights", "objects", "cameras",
                    "views", "budget", "limits"});
    root.word("format");
    root.integer("version", 1, 1);
    if (root.has("about")) root.word("about");
    Scene scene{.file = path};
    readParts(root, purpose, scene);
    const bool emits = std::ranges::any_of(
        scene.objects, [](const Object& object) { return object.emission != Rgb{}; });
    if (purpose == Purpose::transport && scene.lights.empty() && !emits)
        root.fail("is dark: give 'lights', or an object an 'emission'");
    file.checkIntact();
    return scene;
}

}  // namespace hshfit::scene
