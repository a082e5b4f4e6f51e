#include <hshfit/files/json_fields.h>
#include <hshfit/gpu/containers/sidecar.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/coefficient_files/coefficient_formats.h>
#include <hshfit/files/checksum.h>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace hshfit::gpu::inline containers {
namespace {

using Json = nlohmann::ordered_json;

std::string compact(const Json& value) {
    return jsonText(value);
}

Json basisJson(const Payload& payload) {
    const bases::Entry& entry = bases::find(payload.head.basis);
    const auto basis =
        entry.make(payload.head.order, {.condonShortley = payload.head.condonShortley});
    std::vector<int> skipped;
    for (int l = 0; l < payload.head.order; ++l) {
        for (int m = -l; m <= l; ++m) {
            if (!basis->has(l, m)) skipped.push_back(slotOf(l, m));
        }
    }
    return {{"name", payload.head.basis},
            {"order", payload.head.order},
            {"condon_shortley", payload.head.condonShortley},
            {"index", "l*(l+1)+m"},
            {"definition", entry.help},
            {"paper", entry.source},
            {"form", "B_lm = T_l^|m|(theta) az_m(phi)"},
            {"azimuth",
             "1/sqrt(2 pi), cos(m phi)/sqrt(pi), sin(|m| phi)/sqrt(pi) for m = 0, > 0, "
             "< 0; times (-1)^m with condon_shortley"},
            {"domain", "0 <= theta <= 90 degrees"},
            {"inner_product", basis->inner() == Basis::Inner::projectedSolidAngle
                                  ? "cos(theta) d omega over the hemisphere"
                                  : "d omega over the hemisphere"},
            {"orthonormal", entry.orthonormal},
            {"skipped_slots", skipped}};
}

/// The map from a direction to texture coordinates, as in payload.h.
Json parabolicJson(int width, int height, const char* fill) {
    const auto scale = [](int n) { return (n - 2) / (2.0 * n); };
    return {{"type", "parabolic"},
            {"formula", "p = (x, y)/(1 + z); uv = uv_bias + uv_scale * p"},
            {"size", {width, height}},
            {"uv_scale", {scale(width), scale(height)}},
            {"uv_bias", {0.5, 0.5}},
            {"inset_texels", 1},
            {"fill", fill},
            {"row0", "v = 0, lowest y"}};
}

Json mapJson(const Payload& payload) {
    const OutgoingSet& set = payload.head.outgoing;
    switch (set.map) {
        case OutgoingSet::Map::parabolic: {
            Json map = parabolicJson(
                set.width, set.height,
                "radial clamp: texels beyond 89 degrees hold 89 degrees of their azimuth");
            map["markers"] = nullptr;
            if (payload.marked()) {
                const int x = set.width - 1, y = set.height - 1;
                map["markers"] = {{"layer", 0},
                                  {"lane", 0},
                                  {"texels", {{0, 0, 1}, {x, 0, 2}, {0, y, 3}, {x, y, 4}}}};
            }
            return map;
        }
        case OutgoingSet::Map::elevations:
            return {{"type", "elevations"},
                    {"formula", "r = sqrt(x^2 + y^2)/(1 + z); uv = uv_bias + uv_scale * (r, 0)"},
                    {"size", {set.width, 1}},
                    {"uv_scale", {(set.width - 0.5) / set.width, 0}},
                    {"uv_bias", {0.5 / set.width, 0.5}},
                    {"reduced_phi", "turn wo and wi about z until wo has azimuth 0"}};
        case OutgoingSet::Map::direction:
            break;
    }
    return {{"type", "direction"},
            {"formula", "uv = uv_bias"},
            {"size", {1, 1}},
            {"uv_scale", {0, 0}},
            {"uv_bias", {0.5, 0.5}}};
}

Json scalesJson(const Texels& texels) {
    if (texels.scales.empty()) return nullptr;
    Json rows = Json::array();
    for (const LaneScale& lane : texels.scales) rows.push_back({lane.scale, lane.offset});
    return rows;
}

/// Smallest and largest value, marked corners left out.
std::pair<double, double> rangeOf(const Texels& texels, bool marked) {
    std::vector<double> values = decode(texels);
    const auto width = static_cast<std::size_t>(texels.width);
    const auto height = static_cast<std::size_t>(texels.height);
    if (marked) {
        for (const std::size_t texel :
             {std::size_t{0}, width - 1, (height - 1) * width, height * width - 1}) {
            values[texel * 4] = values[(width + 1) * 4];  // replaces a marker by any stored value
        }
    }
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    return {*low, *high};
}

Json storedJson(const Payload& payload) {
    Json rows = Json::array();
    for (const StoredChannel& channel : payload.stored) {
        rows.push_back({{"name", channel.name},
                        {"slots", channel.slots},
                        {"first_layer", channel.firstLayer}});
    }
    return rows;
}

/// Keys that describe the numbers, copied verbatim from the coefficient file.
void addCoefficientKeys(const Payload& payload, Json& document) {
    for (const auto& [key, text] : metadataOf(payload.head)) {
        if (key == "format" || key == "version" || key == "tolerance") continue;
        if (key == "least_squares") continue;
        document[key] = key == "basis" ? basisJson(payload) : Json::parse(text);
    }
}

/// Prints one key per line, and one element per line for arrays of arrays or objects.
std::string readable(const Json& document) {
    std::string text = "{";
    for (const auto& [key, value] : document.items()) {
        text += fmt::format("{}\n  {}: ", text.size() > 1 ? "," : "", compact(key));
        if (!value.is_array() || value.empty() || !value[0].is_structured()) {
            text += compact(value);
            continue;
        }
        for (std::size_t i = 0; i < value.size(); ++i) {
            text += fmt::format("{}\n    {}", i == 0 ? "[" : ",", compact(value[i]));
        }
        text += "\n  ]";
    }
    return text + "\n}\n";
}

Json texelsJson(const Texels& texels, const char* layout, bool marked) {
    const auto [low, high] = rangeOf(texels, marked);
    return {{"layout", layout},
            {"index", "((layer*height + y)*width + x)*4 + lane"},
            {"width", texels.width},
            {"height", texels.height},
            {"layers", texels.layers},
            {"type", numberName(texels.number)},
            {"endian", "little"},
            {"bytes", texels.bytes.size()},
            {"sha256", sha256(texels.bytes)},
            {"range", {low, high}},
            {"scale", scalesJson(texels)}};
}

Json filesJson(std::span<const ExportedFile> files) {
    Json rows = Json::array();
    for (const ExportedFile& file : files) {
        rows.push_back({{"role", roleName(file.role)},
                        {"container", file.container},
                        {"path", file.path},
                        {"bytes", file.bytes},
                        {"sha256", file.sha256}});
    }
    return rows;
}

Json frameJson() {
    return {{"handedness", "right"}, {"normal", "+z"},
            {"tangent", "+x"},       {"bitangent", "+y"},
            {"phi", "atan2(y, x)"},  {"directions", "both point away from the surface"}};
}

Json testsJson(std::span<const TestTriple> tests) {
    Json rows = Json::array();
    for (const TestTriple& test : tests) {
        rows.push_back({{"wo", {test.wo.x, test.wo.y, test.wo.z}},
                        {"wi", {test.wi.x, test.wi.y, test.wi.z}},
                        {"value", test.value}});
    }
    return rows;
}

}  // namespace

std::string readableSidecar(const std::string& document) {
    return readable(Json::parse(document));
}
std::string dataText(const Texels& texels, const char* layout) {
    return jsonText(texelsJson(texels, layout, false));
}
std::string filesText(std::span<const ExportedFile> files) {
    return jsonText(filesJson(files));
}
std::string frameText() {
    return jsonText(frameJson());
}
std::string testsText(std::span<const TestTriple> tests) {
    return jsonText(testsJson(tests));
}

std::string sidecarText(const Payload& payload, std::span<const ExportedFile> files,
                        std::optional<Role> holds, std::span<const TestTriple> tests,
                        const ExportOptions& options) {
    Json document = {{"format", "hshfit-gpu"}, {"version", payloadSidecarVersion}};
    if (holds) document["holds"] = roleName(*holds);
    addCoefficientKeys(payload, document);
    const bool rgb = payload.head.channels.kind == Channels::Kind::rgb;
    document["colorspace"] = rgb ? Json("lin_rec709") : Json(nullptr);
    document["cos_included"] = payload.head.quantity == Quantity::brdfCosine;
    document["unit"] = "1/sr";
    document["lobe"] = "wo looks up the coefficients, wi goes into the basis";
    document["frame"] = frameJson();
    document["sum"] = "q_i = sum_c to_channels[i][c] sum_j C_cj(wo) B_slots[j](wi)";
    document["slots"] = payload.slots;
    document["stored"] = storedJson(payload);
    document["to_channels"] = payload.toChannels;
    document["map"] = mapJson(payload);
    document["sampling"] = {{"filter", "linear"}, {"mip", "none"},   {"lod", 0},
                            {"wrap", "clamp"},    {"anisotropy", 1}, {"srgb", false}};
    document["clamp_negative"] = "once, after the sum and to_channels; never the texels";
    document["data"] =
        texelsJson(payload.coefficients, packingName(payload.packing).c_str(), payload.marked());
    document["basis_textures"] = nullptr;
    if (payload.basisTexels) {
        const Texels& texels = *payload.basisTexels;
        document["basis_textures"] = {
            {"map", parabolicJson(texels.width, texels.height,
                                  "radial clamp: texels outside of the disc hold the horizon "
                                  "of their azimuth")},
            {"data", texelsJson(texels, "coef4-planar", false)}};
    }
    document["files"] = filesJson(files);
    document["fit_error"] =
        options.fitError.empty() ? Json(nullptr) : Json::parse(options.fitError);
    if (!options.proposal.empty()) document["proposal"] = Json::parse(options.proposal);
    document["test_value"] = "the sum before it is clamped, in double precision, analytic basis";
    document["tests"] = testsJson(tests);
    return readable(document);
}

std::string testText(const CoefficientHead& head, std::span<const TestTriple> tests,
                     const std::string& value) {
    return readable({{"format", "hshfit-gpu-test"},
                     {"version", 1},
                     {"source", {{"brdf", head.source}}},
                     {"quantity", quantityName(head.quantity)},
                     {"channels", head.channels.names()},
                     {"value", value},
                     {"tests", testsJson(tests)}});
}

std::string testText(const Payload& payload, std::span<const TestTriple> tests) {
    return testText(payload.head, tests,
                    "the sum before it is clamped, in double precision, analytic basis");
}

std::vector<std::pair<std::string, std::string>> payloadFacts(const Payload& payload) {
    return {{"basis", payload.head.basis},
            {"order", std::to_string(payload.head.order)},
            {"coefficients", std::to_string(payload.slots.size())},
            {"layout", packingName(payload.packing)},
            {"layers", std::to_string(payload.coefficients.layers)},
            {"map", mapJson(payload)["type"].get<std::string>()},
            {"outgoing", payload.head.outgoing.spec()},
            {"quantity", quantityName(payload.head.quantity)},
            {"channels", fmt::format("{}", fmt::join(payload.head.channels.names(), " "))},
            {"source", payload.head.source}};
}

}  // namespace hshfit::gpu::inline containers
