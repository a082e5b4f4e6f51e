#include <brdfs/catalog/preset.h>

#include <brdfs/catalog/tables.h>
#include <brdfs/composed/spectrum.h>
#include <brdfs/composed/sum.h>
#include <brdfs/presets/preset_collection.h>
#include <brdfs/presets/preset_json.h>
#include <brdfs/rows/spec.h>
#include <hshfit/brdf/transmission.h>
#include <hshfit/error.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

namespace hshfit::embedded {
extern const std::string_view preset_hsh_phong;
extern const std::string_view preset_hsh_ward;
}  // namespace hshfit::embedded

namespace hshfit::brdfs {
namespace {

/// An invalid parameter in a preset is wrong input, not wrong usage.
std::unique_ptr<Brdf> openSpec(const std::string& spec, const std::string& where) {
    try {
        return openModels(spec);
    } catch (const UsageError& error) {
        throw InputError(fmt::format("{}: {}", where, error.what()));
    }
}

std::vector<PresetContent::Line> spectrumField(const JsonFields& preset) {
    std::vector<PresetContent::Line> lines;
    for (const JsonFields& line : preset.objects("spectrum")) {
        const double wavelength = line.number("wavelength", 1, 1e6);
        if (!lines.empty() && !(wavelength > lines.back().wavelength))
            line.fail(fmt::format("is {}, after {}; expected ascending numbers of nm", wavelength,
                                  lines.back().wavelength),
                      "wavelength");
        lines.push_back({wavelength, line.word("spec")});
    }
    if (lines.empty()) preset.fail("is empty; expected one wavelength or more", "spectrum");
    return lines;
}

std::string quoted(const std::vector<std::string>& names) {
    return fmt::format("'{}'", fmt::join(names, "', '"));
}

std::unique_ptr<Brdf> openFrom(const PresetCollection& collection, const std::string& where,
                               std::string_view name) {
    if (const auto* material = findMaterial(collection, name))
        return openSpec(material->spec, fmt::format("{}/{}", where, name));
    std::vector<std::string> names;
    for (const auto& material : collection.materials) names.push_back(material.name);
    constexpr std::size_t fewNames = 12, nearest = 5;
    const std::vector<std::string> similar = nearestNames(name, names, nearest);
    const std::string what = name.empty() ? std::string("name one of its materials")
                                          : fmt::format("has no material '{}'", name);
    std::string hint = fmt::format("it has {}", names.size());
    if (!name.empty() && !similar.empty())
        hint = fmt::format("nearest: {}", quoted(similar));
    else if (!names.empty())
        hint += names.size() <= fewNames
                    ? fmt::format(": {}", quoted(names))
                    : fmt::format(": {}, …", quoted({names.begin(), names.begin() + fewNames}));
    throw UsageError(fmt::format("{}: {}; {}", where, what, hint));
}

}  // namespace

std::span<const Preset> presets() {
    static const std::array table{
        Preset{"hsh-phong", "Phong lobe of the HSH paper, exponent 22", embedded::preset_hsh_phong},
        Preset{"hsh-ward", "anisotropic Ward BRDF of the HSH paper", embedded::preset_hsh_ward},
    };
    return table;
}

PresetContent parsePreset(std::string_view text, const std::string& where) {
    const Json json = parsePresetJson(text, "hshfit-preset", where);
    const JsonFields preset(json, "", where);
    PresetContent content;
    if (preset.has("source")) content.source = preset.word("source");
    if (preset.has("spectrum")) {
        content.spectrum = spectrumField(preset);
        return content;
    }
    if (preset.has("spec")) {
        content.spec = preset.word("spec");
        return content;
    }
    const std::string model = modelField(preset);
    content.spec = presetSpec(model, preset.object("parameters").json(), where);
    return content;
}

std::unique_ptr<Brdf> openPreset(std::string_view text, const std::string& where) {
    const PresetContent content = parsePreset(text, where);
    if (content.spectrum.empty()) return openSpec(content.spec, where);
    std::vector<Spectrum::Line> lines;
    for (const auto& [wavelength, spec] : content.spectrum) {
        lines.push_back({wavelength, openSpec(spec, where)});
        if (transmits(*lines.back().brdf))
            throw InputError(fmt::format(
                "{}: '{}' at {} nm is a transmission; a spectrum of a preset takes reflections",
                where, spec, wavelength));
        if (lines.back().brdf->channels().kind != Channels::Kind::grey)
            throw InputError(
                fmt::format("{}: '{}' at {} nm has colours; expected a grey BRDF at "
                            "each wavelength",
                            where, spec, wavelength));
    }
    return std::make_unique<Spectrum>(std::move(lines), where);
}

std::unique_ptr<Brdf> openMaterial(std::string_view collection, const std::string& where,
                                   std::string_view material) {
    return openFrom(parsePresetCollection(collection, where), where, material);
}

std::unique_ptr<Brdf> openNamedPreset(std::string_view name) {
    const auto found = std::ranges::find(presets(), name, &Preset::name);
    if (found != presets().end()) return openPreset(found->text, fmt::format("preset:{}", name));
    const std::string_view collection = name.substr(0, name.find('/'));
    if (const auto index = findPresetCollection(collection)) {
        const std::string_view material =
            collection.size() < name.size() ? name.substr(collection.size() + 1) : "";
        return openFrom(presetCollection(*index), fmt::format("preset:{}", collection), material);
    }
    std::vector<std::string_view> known;
    for (const Preset& preset : presets()) known.push_back(preset.name);
    for (const CollectionEntry& entry : presetCollections()) known.push_back(entry.name);
    throw UsageError(fmt::format("unknown preset '{}'{}; known: {}", name,
                                 suggestion(collection, known), joined(known)));
}

bool namesPreset(std::string_view name) {
    return std::ranges::find(presets(), name, &Preset::name) != presets().end() ||
           findPresetCollection(name.substr(0, name.find('/')));
}

}  // namespace hshfit::brdfs
