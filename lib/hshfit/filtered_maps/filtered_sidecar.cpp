#include <hshfit/filtered_maps/filtered_sidecar.h>

#include <hshfit/error.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/files/json_format.h>
#include <hshfit/files/mapped_file.h>
#include <hshfit/material_maps/level_json.h>
#include <hshfit/material_maps/map_sidecar.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace hshfit::inline filtered_maps {
namespace {

constexpr std::size_t mostBytes = std::size_t{1} << 28;

nlohmann::ordered_json jsonOf(const StoredLobe& lobe) {
    return {{"widths", {lobe.widthX, lobe.widthY}},
            {"peaks", lobe.gaussians.peaks},
            {"variances", lobe.gaussians.variances}};
}

StoredLobe lobeOf(const JsonFields& json) {
    const std::vector<double> widths = json.numbers("widths", 2);
    StoredLobe lobe{widths[0], widths[1], {json.numbers("peaks"), json.numbers("variances")}};
    if (lobe.gaussians.peaks.size() != lobe.gaussians.variances.size())
        json.fail("has as many numbers as peaks", "variances");
    return lobe;
}

std::vector<LobeNodes> nodesOf(const JsonFields& root) {
    std::vector<LobeNodes> all;
    for (const JsonFields& json : root.objects("parameters")) {
        all.push_back({json.word("name"), json.numbers("nodes")});
        const std::vector<double>& values = all.back().values;
        if (values.empty() || !std::ranges::is_sorted(values, std::less_equal{}))
            json.fail("has to be rising numbers", "nodes");
    }
    if (all.size() > 2) root.fail("has more than two", "parameters");
    return all;
}

std::vector<std::vector<LobeWeight>> termsOf(const JsonFields& root, const MipLayout& layout,
                                             std::size_t channels) {
    std::vector<std::vector<LobeWeight>> terms;
    for (const JsonFields& json : root.objects("terms")) {
        const std::vector<double> weights = json.numbers("weights", channels);
        const std::vector<double> scales = json.numbers("scales", channels);
        terms.emplace_back();
        for (std::size_t c = 0; c < channels; ++c) {
            if (!(weights[c] >= 0 && weights[c] < std::max(layout.weights, 1)))
                json.fail(fmt::format("has a weight beyond {}", layout.weights), "weights");
            terms.back().push_back({static_cast<std::size_t>(weights[c]), scales[c]});
        }
    }
    return terms;
}

}  // namespace

double LobeNodes::placeOf(double value) const {
    const auto above = std::ranges::upper_bound(values, value);
    if (above == values.begin()) return 0;
    if (above == values.end()) return static_cast<double>(values.size() - 1);
    const auto low = static_cast<std::size_t>(above - values.begin()) - 1;
    return static_cast<double>(low) + (value - values[low]) / (values[low + 1] - values[low]);
}

double LobeNodes::valueAt(double place) const {
    const double at = std::clamp(place, 0.0, static_cast<double>(values.size() - 1));
    const auto low = std::min(static_cast<std::size_t>(at), values.size() - 1);
    if (low + 1 == values.size()) return values[low];
    return values[low] + (at - static_cast<double>(low)) * (values[low + 1] - values[low]);
}

std::string toText(const FilteredSidecar& s) {
    auto lobes = nlohmann::ordered_json::array(), nodes = lobes, terms = lobes;
    for (const StoredLobe& lobe : s.lobes) lobes.push_back(jsonOf(lobe));
    for (const LobeNodes& node : s.nodes)
        nodes.push_back({{"name", node.name}, {"nodes", node.values}});
    for (const auto& term : s.terms) {
        std::vector<std::size_t> weights;
        std::vector<double> scales;
        for (const LobeWeight& weight : term) {
            weights.push_back(weight.weight);
            scales.push_back(weight.scale);
        }
        terms.push_back({{"weights", weights}, {"scales", scales}});
    }
    nlohmann::ordered_json json = {{"format", filteredMapFormat},
                                   {"version", 1},
                                   {"form", s.form},
                                   {"order", s.layout.order},
                                   {"weights", s.layout.weights},
                                   {"albedos", s.layout.albedos},
                                   {"channels", s.channels.names()},
                                   {"model", s.model},
                                   {"parameters", nodes},
                                   {"terms", terms},
                                   {"texture",
                                    {{"file", s.texture},
                                     {"number", gpu::numberName(s.number)},
                                     {"layers", s.layers()},
                                     {"levels", levelsJson(s.levels)}}}};
    if (!s.harmonics.empty())
        json["harmonics"] = {{"file", s.harmonics}, {"layers", s.harmonicLayers()}};
    json["lobes"] = lobes;
    json["source"] = s.source;
    json["generator"] = s.generator;
    return jsonText(json) + "\n";
}

FilteredSidecar readFilteredSidecar(const std::string& file) {
    const MappedFile mapped(file);
    if (mapped.size() > mostBytes) throw InputError(fmt::format("{}: is too large", file));
    const std::string_view text(reinterpret_cast<const char*>(mapped.data()), mapped.size());
    const nlohmann::json json = parseJson(text, file, 8);
    const JsonFields root(json, "", file);
    const bool exported = root.word("format") == filteredMapExportFormat;
    if (!exported && root.word("format") != filteredMapFormat)
        root.fail("is not hshfit-filtered-map", "format");
    if (root.integer("version", 1, 1 << 20) != 1)
        root.fail("is newer than this program", "version");
    const auto folder = std::filesystem::path(file).parent_path();
    const JsonFields texture = root.object(exported ? "map" : "texture");
    FilteredSidecar s{.form = root.word("form"),
                      .layout = {.weights = root.integer("weights", 0, SurfaceTexel::most),
                                 .albedos = root.integer("albedos", 0, SurfaceTexel::most),
                                 .order = root.integer("order", 1, 301)},
                      .model = root.word("model"),
                      .nodes = nodesOf(root),
                      .number = gpu::numberIn(texture, "number"),
                      .texture = exported ? exportedTexture(root, "map", file)
                                          : (folder / texture.word("file")).string()};
    if (s.form != "ellipse" && s.form != "harmonics")
        root.fail("has to be ellipse or harmonics", "form");
    if (s.layout.order % 2 == 0) root.fail("has to be odd", "order");
    s.channels = root.words("channels").size() == 1 ? Channels::grey() : Channels::rgb();
    if (root.words("channels") != s.channels.names())
        root.fail("has to be grey, or R, G, B", "channels");
    if (s.layout.albedos > 1 && s.layout.albedos != static_cast<int>(s.channels.count()))
        root.fail("has to be one for all channels or one for each", "albedos");
    s.terms = termsOf(root, s.layout, s.channels.count());
    s.levels = readLevels(texture);
    if (static_cast<std::size_t>(texture.integer("layers", 1, 1 << 24)) != s.layers())
        texture.fail(fmt::format("has to be {}", s.layers()), "layers");
    if (s.form == "harmonics") {
        if (s.levels.size() < 2) texture.fail("has one level, which has no harmonics", "levels");
        const JsonFields harmonics = root.object("harmonics");
        s.harmonics = exported ? exportedTexture(root, "harmonics", file)
                               : (folder / harmonics.word("file")).string();
        if (static_cast<std::size_t>(harmonics.integer("layers", 1, 1 << 24)) != s.harmonicLayers())
            harmonics.fail(fmt::format("has to be {}", s.harmonicLayers()), "layers");
    }
    for (const JsonFields& lobe : root.objects("lobes")) s.lobes.push_back(lobeOf(lobe));
    std::size_t nodes = 1;
    for (const LobeNodes& parameter : s.nodes) nodes *= parameter.values.size();
    if (s.lobes.size() != nodes) root.fail(fmt::format("has to be {}", nodes), "lobes");
    s.source = root.word("source");
    s.generator = root.word("generator");
    return s;
}

}  // namespace hshfit::inline filtered_maps
