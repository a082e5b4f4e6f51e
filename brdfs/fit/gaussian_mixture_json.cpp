#include <brdfs/fit/gaussian_mixture_json.h>

#include <brdfs/preset_json.h>
#include <hshfit/error.h>
#include <hshfit/version.h>

#include <fmt/format.h>

#include <algorithm>

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

/// Reads fields, each with its place for messages.
class Reader {
public:
    explicit Reader(std::string where) : where_(std::move(where)) {}

    double number(const Json& json, const char* name, double least, double most) const {
        const auto found = json.find(name);
        if (found != json.end() && found->is_number()) {
            const double value = found->get<double>();
            if (value >= least && value <= most) return value;
        }
        throw InputError(
            fmt::format("{}: '{}' has to be a number from {} to {}", where_, name, least, most));
    }

    std::vector<double> numbers(const Json& json, const char* name, std::size_t count) const {
        const auto found = json.find(name);
        std::vector<double> values;
        constexpr double most = 1e12;  // keeps sums of lobes finite
        if (found != json.end() && found->is_array() && found->size() == count)
            for (const Json& value : *found)
                if (value.is_number() && value.get<double>() >= 0 && value.get<double>() <= most)
                    values.push_back(value.get<double>());
        if (values.size() == count) return values;
        throw InputError(fmt::format("{}: '{}' has to be an array of {} numbers from 0 to {}",
                                     where_, name, count, most));
    }

    /// A non-empty array of objects.
    const Json& objects(const Json& json, const char* name, std::size_t most) const {
        const auto found = json.find(name);
        if (found == json.end() || !found->is_array() || found->empty() || found->size() > most ||
            !std::ranges::all_of(*found, [](const Json& entry) { return entry.is_object(); }))
            throw InputError(
                fmt::format("{}: '{}' has to be an array of 1 to {} objects", where_, name, most));
        return *found;
    }

    Channels channels(const Json& json) const {
        const Json value = json.value("channels", Json());
        if (value == "grey") return Channels::grey();
        if (value == "rgb") return Channels::rgb();
        constexpr std::size_t most = 10000;
        if (value.is_array() && !value.empty() && value.size() <= most) {
            const std::vector<double> wavelengths = numbers(json, "channels", value.size());
            if (std::ranges::adjacent_find(wavelengths, std::greater_equal()) == wavelengths.end())
                return Channels::spectral(wavelengths);
        }
        throw InputError(fmt::format(
            "{}: 'channels' has to be \"grey\", \"rgb\" or wavelengths that ascend", where_));
    }

    GaussianLobe lobe(const Json& json, GaussianKind kind, std::size_t channels) const {
        constexpr double least = 0, most = 1e12;
        GaussianLobe lobe{.tilt = radians(number(json, "tilt", -180, 180)),
                          .sharpness = number(json, "sharpness", least, most)};
        lobe.across = kind == GaussianKind::anisotropic ? number(json, "across", least, most)
                                                        : lobe.sharpness;
        lobe.amplitude = numbers(json, "amplitude", channels);
        return lobe;
    }

    GaussianElevation elevation(const Json& json, GaussianKind kind, std::size_t channels) const {
        GaussianElevation result{.theta = radians(number(json, "theta", 0, 90))};
        for (const Json& entry : objects(json, "lobes", 1000))
            result.lobes.push_back(lobe(entry, kind, channels));
        constexpr double most = 1e300;
        result.error = number(json, "error", 0, most);
        result.albedo = number(json, "albedo", 0, most);
        result.fittedAlbedo = number(json, "fitted_albedo", 0, most);
        result.converged = json.value("converged", Json()) == true;
        return result;
    }

    GaussianKind kind(const Json& json) const {
        for (const GaussianKind kind : {GaussianKind::spherical, GaussianKind::anisotropic})
            if (json.value("kind", Json()) == kindName(kind)) return kind;
        throw InputError(fmt::format("{}: 'kind' has to be \"sg\" or \"asg\"", where_));
    }

    /// Elevations ascend and have equally many lobes.
    void requireRegular(const std::vector<GaussianElevation>& elevations) const {
        for (std::size_t k = 1; k < elevations.size(); ++k) {
            if (!(elevations[k].theta > elevations[k - 1].theta))
                throw InputError(
                    fmt::format("{}: 'theta' of elevation {} does not ascend", where_, k + 1));
            if (elevations[k].lobes.size() != elevations[0].lobes.size())
                throw InputError(fmt::format("{}: elevation {} has {} lobes, the first has {}",
                                             where_, k + 1, elevations[k].lobes.size(),
                                             elevations[0].lobes.size()));
        }
    }

private:
    std::string where_;
};

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
    return document.dump(2) + "\n";
}

bool isGaussianMixture(std::string_view text) {
    const Json json = Json::parse(text, nullptr, false);
    return json.is_object() && json.value("format", Json()) == format;
}

std::unique_ptr<GaussianMixture> openGaussianMixture(std::string_view text,
                                                     const std::string& where) {
    const Json json = parsePresetJson(text, format, where);
    const Reader reader(where);
    GaussianMixture::Content content{.name = where,
                                     .source = stringField(json, "brdf", where),
                                     .kind = reader.kind(json),
                                     .channels = reader.channels(json)};
    for (const Json& entry : reader.objects(json, "elevations", 100000))
        content.elevations.push_back(
            reader.elevation(entry, content.kind, content.channels.count()));
    reader.requireRegular(content.elevations);
    return std::make_unique<GaussianMixture>(std::move(content));
}

}  // namespace hshfit::brdfs
