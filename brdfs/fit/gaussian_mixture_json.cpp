#include <brdfs/fit/gaussian_mixture_json.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/files/json_format.h>

#include <brdfs/presets/preset_json.h>
#include <hshfit/version.h>

#include <fmt/format.h>

#include <algorithm>
#include <functional>

namespace hshfit::brdfs {
namespace {

constexpr const char* format = "hshfit-gaussians";

std::string_view kindName(GaussianKind kind) {
    return kind == GaussianKind::spherical ? "sg" : "asg";
}

nlohmann::ordered_json channelsJson(const Channels& channels) {
    if (channels.kind == Channels::Kind::spectral) return channels.wavelengths;
    return channels.kind == Channels::Kind::rgb ? "rgb" : "grey";
}

nlohmann::ordered_json lobeJson(GaussianKind kind, const GaussianLobe& lobe) {
    nlohmann::ordered_json json = {{"tilt", degrees(lobe.tilt)}, {"sharpness", lobe.sharpness}};
    if (kind == GaussianKind::anisotropic) json["across"] = lobe.across;
    json["amplitude"] = lobe.amplitude;
    return json;
}

constexpr double mostNumber = 1e12;  // keeps sums of lobes finite

/// `count` numbers from 0.
std::vector<double> magnitudes(const JsonFields& fields, const char* key, std::size_t count) {
    std::vector<double> values = fields.numbers(key, count);
    for (const double value : values)
        if (!(value >= 0 && value <= mostNumber))
            fields.fail(fmt::format("holds {:g}; it has to be from 0 to {:g}", value, mostNumber),
                        key);
    return values;
}

std::vector<JsonFields> someObjects(const JsonFields& fields, const char* key, std::size_t most) {
    std::vector<JsonFields> objects = fields.objects(key);
    if (objects.empty() || objects.size() > most)
        fields.fail(fmt::format("has to be an array of 1 to {} objects", most), key);
    return objects;
}

Channels readChannels(const JsonFields& fields) {
    const Json& value = fields.at("channels");
    if (value == "grey") return Channels::grey();
    if (value == "rgb") return Channels::rgb();
    constexpr std::size_t most = 10000;
    if (value.is_array() && !value.empty() && value.size() <= most) {
        const std::vector<double> wavelengths = magnitudes(fields, "channels", value.size());
        if (std::ranges::adjacent_find(wavelengths, std::greater_equal()) == wavelengths.end())
            return Channels::spectral(wavelengths);
    }
    fields.fail("has to be 'grey', 'rgb' or wavelengths that ascend", "channels");
}

GaussianLobe readLobe(const JsonFields& fields, GaussianKind kind, std::size_t channels) {
    GaussianLobe lobe{.tilt = radians(fields.number("tilt", -180, 180)),
                      .sharpness = fields.number("sharpness", 0, mostNumber)};
    lobe.across =
        kind == GaussianKind::anisotropic ? fields.number("across", 0, mostNumber) : lobe.sharpness;
    lobe.amplitude = magnitudes(fields, "amplitude", channels);
    return lobe;
}

GaussianElevation readElevation(const JsonFields& fields, GaussianKind kind, std::size_t channels) {
    GaussianElevation result{.theta = radians(fields.number("theta", 0, 90))};
    for (const JsonFields& lobe : someObjects(fields, "lobes", 1000))
        result.lobes.push_back(readLobe(lobe, kind, channels));
    constexpr double most = 1e300;
    result.error = fields.number("error", 0, most);
    result.albedo = fields.number("albedo", 0, most);
    result.fittedAlbedo = fields.number("fitted_albedo", 0, most);
    result.converged = fields.has("converged") && fields.at("converged") == true;
    return result;
}

GaussianKind readKind(const JsonFields& fields) {
    const std::string name = fields.word("kind");
    for (const GaussianKind kind : {GaussianKind::spherical, GaussianKind::anisotropic})
        if (name == kindName(kind)) return kind;
    fields.fail("has to be 'sg' or 'asg'", "kind");
}

/// Elevations ascend and have equally many lobes.
void requireRegular(const JsonFields& root, const std::vector<GaussianElevation>& elevations) {
    for (std::size_t k = 1; k < elevations.size(); ++k) {
        if (!(elevations[k].theta > elevations[k - 1].theta))
            root.fail("does not ascend", fmt::format("elevations[{}].theta", k));
        if (elevations[k].lobes.size() != elevations[0].lobes.size())
            root.fail(fmt::format("has {} lobes, the first has {}", elevations[k].lobes.size(),
                                  elevations[0].lobes.size()),
                      fmt::format("elevations[{}]", k));
    }
}

}  // namespace

std::string gaussianMixtureJson(const GaussianMixture& mixture) {
    const GaussianMixture::Content& content = mixture.content();
    nlohmann::ordered_json document = {{"format", format},
                                       {"version", 1},
                                       {"generator", std::string("hshfit ") + version},
                                       {"brdf", content.source},
                                       {"kind", kindName(content.kind)},
                                       {"channels", channelsJson(content.channels)},
                                       {"elevations", nlohmann::ordered_json::array()}};
    for (const GaussianElevation& elevation : content.elevations) {
        nlohmann::ordered_json lobes = nlohmann::ordered_json::array();
        for (const GaussianLobe& lobe : elevation.lobes)
            lobes.push_back(lobeJson(content.kind, lobe));
        document["elevations"].push_back({{"theta", degrees(elevation.theta)},
                                          {"lobes", std::move(lobes)},
                                          {"error", elevation.error},
                                          {"albedo", elevation.albedo},
                                          {"fitted_albedo", elevation.fittedAlbedo},
                                          {"converged", elevation.converged}});
    }
    return jsonText(document, 2) + "\n";
}

bool isGaussianMixture(std::string_view text) {
    return jsonFormat(text) == format;
}

std::unique_ptr<GaussianMixture> openGaussianMixture(std::string_view text,
                                                     const std::string& where) {
    const Json json = parsePresetJson(text, format, where);
    const JsonFields root(json, "", where);
    GaussianMixture::Content content{.name = where,
                                     .source = root.word("brdf"),
                                     .kind = readKind(root),
                                     .channels = readChannels(root)};
    for (const JsonFields& elevation : someObjects(root, "elevations", 100000))
        content.elevations.push_back(
            readElevation(elevation, content.kind, content.channels.count()));
    requireRegular(root, content.elevations);
    return std::make_unique<GaussianMixture>(std::move(content));
}

}  // namespace hshfit::brdfs
