#include <hshfit/coefficient_files/light_file.h>

#include <hshfit/coefficient_files/coefficient_formats.h>
#include <hshfit/error.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/files/json_format.h>
#include <hshfit/version.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace hshfit::inline coefficient_files {
namespace {

using Json = nlohmann::json;
using Ordered = nlohmann::ordered_json;
using Domain = LightCoefficients::Domain;

constexpr const char* lightFormat = "hshfit-light";
constexpr int lightVersion = 1;

Ordered energyJson(const Energy& energy) {
    const bool exists = energy.finite && std::isfinite(energy.value);
    Ordered json = {{"value", exists ? Ordered(energy.value) : Ordered(nullptr)},
                    {"error", exists ? finiteOrNull(energy.error) : Ordered(nullptr)},
                    {"finite", exists}};
    if (!exists) json["reason"] = energy.reason;
    return json;
}

Ordered curvesJson(const std::vector<LightCurve>& curves) {
    Ordered list = Ordered::array();
    for (const LightCurve& curve : curves) {
        Ordered points = Ordered::array();
        for (const LightCurve::Point& point : curve.points) {
            points.push_back({{"order", point.order},
                              {"coefficients", point.coefficients},
                              {"slots", point.order * point.order},
                              {"accuracy", finiteOrNull(point.accuracy)}});
        }
        list.push_back({{"basis", curve.basis}, {"points", points}});
    }
    return list;
}

CoefficientMetadata headOf(const LightCoefficients& light) {
    Ordered normal = nullptr;
    if (light.domain == Domain::hemisphere) {
        normal = {{"theta", tidyDegrees(light.normalTheta)}, {"phi", tidyDegrees(light.normalPhi)}};
    }
    const std::string generator =
        light.generator.empty() ? std::string("hshfit ") + version : light.generator;
    const auto text = [](const Ordered& value) { return jsonText(value); };
    return {{"format", text(lightFormat)},
            {"version", text(lightVersion)},
            {"generator", text(generator)},
            {"source", text({{"light", light.source}})},
            {"basis", basisText({light.basis, light.order, light.condonShortley})},
            {"domain", text(light.domain == Domain::sphere ? "sphere" : "hemisphere")},
            {"normal", text(normal)},
            {"channels", text(light.channels.names())},
            {"energy", text(energyJson(light.energy))},
            {"error", text(finiteOrNull(light.error))},
            {"curves", text(curvesJson(light.curves))}};
}

void readDomain(const JsonFields& root, LightCoefficients& light) {
    const std::string domain = root.word("domain");
    if (domain == "hemisphere") {
        light.domain = Domain::hemisphere;
        const JsonFields normal = root.object("normal");
        light.normalTheta = radians(normal.number("theta", 0, 180));
        light.normalPhi = radians(normal.number("phi", -360, 360));
        return;
    }
    if (domain != "sphere") root.fail("has to be 'sphere' or 'hemisphere'", "domain");
    if (light.basis != "sh") {
        root.fail(fmt::format("is 'sphere', which needs the basis 'sh'; '{}' is one of the "
                              "hemisphere",
                              light.basis),
                  "domain");
    }
}

Channels readLightChannels(const JsonFields& root) {
    const Json& names = root.at("channels");
    for (const Channels& known : {Channels::rgb(), Channels::grey()})
        if (names == Json(known.names())) return known;
    root.fail("has to be [\"R\", \"G\", \"B\"] or [\"grey\"]", "channels");
}

Energy readLightEnergy(const JsonFields& fields) {
    Energy energy;
    energy.finite = fields.flag("finite");
    energy.value = fields.numberOrNull("value").value_or(nullNumber);
    energy.error = fields.numberOrNull("error").value_or(nullNumber);
    if (energy.finite != std::isfinite(energy.value)) {
        fields.fail("has to be a number if 'finite' is true, else null", "value");
    }
    if (energy.finite && energy.value < 0) fields.fail("has to be at least 0", "value");
    if (!energy.finite) energy.reason = fields.word("reason");
    return energy;
}

std::vector<LightCurve> readCurves(const JsonFields& root) {
    std::vector<LightCurve> curves;
    for (const JsonFields& fields : root.objects("curves")) {
        LightCurve curve{.basis = fields.word("basis"), .points = {}};
        for (const JsonFields& point : fields.objects("points")) {
            curve.points.push_back({point.integer("order", 1, 1 << 15),
                                    point.integer("coefficients", 1, 1 << 30),
                                    point.numberOrNull("accuracy").value_or(nullNumber)});
        }
        curves.push_back(std::move(curve));
    }
    return curves;
}

void requireFiniteValues(const LightCoefficients& light) {
    const auto bad = std::find_if_not(light.values.begin(), light.values.end(),
                                      [](double value) { return std::isfinite(value); });
    if (bad == light.values.end()) return;
    const auto at = static_cast<std::size_t>(bad - light.values.begin());
    throw NumericError(
        fmt::format("coefficient {} of channel {} of the light is not finite; nothing is written",
                    at % light.slots(), at / light.slots()));
}

}  // namespace

std::string lightToJson(const LightCoefficients& light) {
    assert(light.values.size() == light.channels.count() * light.slots());
    requireFiniteValues(light);
    std::string out = "{\n";
    for (const auto& [key, text] : headOf(light)) out += fmt::format("  \"{}\": {},\n", key, text);
    out += "  \"coefficients\": [";
    for (std::size_t channel = 0; channel < light.channels.count(); ++channel) {
        out += channel == 0 ? "\n    [" : ",\n    [";
        appendJsonNumbers({light.at(channel), light.slots()}, out);
        out += ']';
    }
    out += "\n  ]\n}\n";
    return out;
}

LightCoefficients lightFromJson(std::string_view text, const std::string& file) {
    const Json tree = parseJson(text, file, deepestJson);
    const JsonFields root(tree, "", file);
    requireFormat(root, lightFormat, lightVersion);
    LightCoefficients light;
    light.generator = root.word("generator");
    light.source = root.object("source").word("light");
    const BasisName basis = readBasisName(root.object("basis"));
    light.basis = basis.name;
    light.order = basis.order;
    light.condonShortley = basis.condonShortley;
    readDomain(root, light);
    light.channels = readLightChannels(root);
    light.energy = readLightEnergy(root.object("energy"));
    light.error = root.numberOrNull("error").value_or(nullNumber);
    light.curves = readCurves(root);
    for (const auto& row : root.table("coefficients", light.channels.count(), light.slots())) {
        light.values.insert(light.values.end(), row.begin(), row.end());
    }
    return light;
}

void writeLight(const LightCoefficients& light, const std::string& path) {
    AtomicFile file(path);
    writeLight(light, file);
    file.commit();
}

void writeLight(const LightCoefficients& light, AtomicFile& file) {
    file.write(lightToJson(light));
}

LightCoefficients readLight(const std::string& path) {
    const std::string bytes = readRegularFile(path, std::numeric_limits<std::size_t>::max());
    if (bytes.empty()) throw InputError(fmt::format("{}: is empty", path));
    return lightFromJson(bytes, path);
}

bool isLightFile(const std::string& path) {
    return jsonFormatOf(path) == lightFormat;
}

}  // namespace hshfit::inline coefficient_files
