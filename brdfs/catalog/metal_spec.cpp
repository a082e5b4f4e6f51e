#include <brdfs/catalog/metal_spec.h>

#include <brdfs/catalog/tables.h>
#include <brdfs/composed/spectrum.h>
#include <brdfs/presets/metals.h>
#include <brdfs/rows/spec.h>
#include <hshfit/brdf/colour.h>
#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace hshfit::brdfs {
namespace {

/// A specification taken apart.
struct MetalSpec {
    std::string model, metal, nanometres;
    std::string others;  ///< "key=value,…" without metal and nm
};

bool takesKey(const Model& model, std::string_view key) {
    return std::ranges::find(model.parameters, key, &Parameter::name) != model.parameters.end();
}

/// Throws for a model that has no n and k, and for what a metal stands in place of.
void checkModel(const MetalSpec& spec, std::string_view key) {
    const auto model = std::ranges::find(models(), std::string_view(spec.model), &Model::name);
    if (model == models().end()) return;  // opening it says so
    if (!takesKey(*model, "ior") || !takesKey(*model, "k")) {
        std::vector<std::string_view> known;
        for (const Model& own : models())
            if (takesKey(own, "ior") && takesKey(own, "k")) known.push_back(own.name);
        throw UsageError(fmt::format("{}: takes no ior and k, so no metal; models that do: {}",
                                     spec.model, joined(known)));
    }
    for (const std::string_view replaced : {"ior", "k", "F0"})
        if (key == replaced)
            throw UsageError(fmt::format("{}: metal={} is in place of {}; give one of them",
                                         spec.model, spec.metal, key));
}

MetalSpec partsOf(std::string_view text) {
    MetalSpec spec;
    const std::size_t colon = std::min(text.find(':'), text.size());
    spec.model = text.substr(0, colon);
    std::vector<std::string_view> keys;
    for (std::size_t first = colon + 1; first < text.size();) {
        const std::size_t last = std::min(text.find(',', first), text.size());
        const std::string_view part = text.substr(first, last - first);
        const std::string_view key = part.substr(0, part.find('='));
        const std::string_view value = part.substr(std::min(part.size(), key.size() + 1));
        std::string* const own = key == "metal" ? &spec.metal
                                 : key == "nm"  ? &spec.nanometres
                                                : nullptr;
        if (own && !own->empty())
            throw UsageError(fmt::format("{}: {} is given twice", spec.model, key));
        if (own) {
            *own = value;
        } else if (part != "fresnel=conductor") {
            if (!spec.others.empty()) spec.others += ',';
            spec.others += part;
        }
        if (!own) keys.push_back(key);
        first = last + 1;
    }
    if (spec.metal.empty()) return spec;
    checkModel(spec, "");
    spec.metal = findMetal(spec.metal).name;
    for (const std::string_view key : keys) checkModel(spec, key);
    return spec;
}

std::string specAt(const MetalSpec& spec, double nanometres) {
    const MetalRow index = indexAt(findMetal(spec.metal), nanometres);
    return fmt::format("{}:{}{}fresnel=conductor,ior={},k={}", spec.model, spec.others,
                       spec.others.empty() ? "" : ",", index.n, index.k);
}

double numberIn(std::string_view cell, std::string_view text, std::string_view what) {
    double value = 0;
    const auto read = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (cell.empty() || read.ec != std::errc() || read.ptr != cell.data() + cell.size() ||
        !(value > 0 && value < 1e6))
        throw UsageError(
            fmt::format("{}: '{}' is no wavelength in nm in '{}'; expected such as "
                        "450/550/650 or 400:700:10",
                        what, cell, text));
    return value;
}

std::vector<std::string_view> split(std::string_view text, char mark) {
    std::vector<std::string_view> parts;
    for (std::size_t first = 0; first <= text.size();) {
        const std::size_t last = std::min(text.find(mark, first), text.size());
        parts.push_back(text.substr(first, last - first));
        first = last + 1;
    }
    return parts;
}

}  // namespace

std::vector<double> wavelengthsIn(std::string_view text, std::string_view what) {
    constexpr std::size_t most = 1000;
    std::vector<double> wavelengths;
    if (const auto ends = split(text, ':'); ends.size() == 3) {
        const double first = numberIn(ends[0], text, what), last = numberIn(ends[1], text, what),
                     step = numberIn(ends[2], text, what);
        const double count = std::floor((last - first) / step + 1e-9);
        if (!(count >= 0 && count < static_cast<double>(most)))
            throw UsageError(
                fmt::format("{}: '{}' is no range of at most {} wavelengths, FIRST:LAST:STEP", what,
                            text, most));
        for (std::size_t i = 0; i <= static_cast<std::size_t>(count); ++i)
            wavelengths.push_back(first + step * static_cast<double>(i));
        return wavelengths;
    }
    for (const std::string_view cell : split(text, '/')) {
        wavelengths.push_back(numberIn(cell, text, what));
        if (wavelengths.size() > 1 && !(wavelengths.back() > wavelengths[wavelengths.size() - 2]))
            throw UsageError(fmt::format("{}: wavelengths ascend; '{}' do not", what, text));
    }
    if (wavelengths.size() > most)
        throw UsageError(
            fmt::format("{}: {} wavelengths; expected at most {}", what, wavelengths.size(), most));
    return wavelengths;
}

bool namesMetal(std::string_view values) {
    for (const std::string_view part : split(values, ','))
        if (part.starts_with("metal=")) return true;
    return false;
}

std::string atWavelength(std::string_view spec, double nanometres) {
    const std::size_t colon = spec.find(':');
    if (colon == std::string_view::npos || !namesMetal(spec.substr(colon + 1)))
        return std::string(spec);
    const MetalSpec parts = partsOf(spec);
    if (!parts.nanometres.empty())
        throw UsageError(fmt::format(
            "{}: nm is for opening a metal; here the data have the wavelengths", parts.model));
    return specAt(parts, nanometres);
}

std::unique_ptr<Brdf> openMetal(std::string_view text) {
    const MetalSpec spec = partsOf(text);
    const bool rgb = spec.nanometres.empty();
    const std::string range = rgb ? "380:780:5" : spec.nanometres;
    std::vector<Spectrum::Line> lines;
    for (const double nanometres : wavelengthsIn(range, fmt::format("{}: nm", spec.model))) {
        lines.push_back({nanometres, openModel(specAt(spec, nanometres))});
        if (lines.back().brdf->channels().kind != Channels::Kind::grey)
            throw UsageError(fmt::format(
                "{}: with a metal, colours are single values, because the metal has the colour",
                spec.model));
    }
    auto spectrum = std::make_unique<Spectrum>(
        std::move(lines), fmt::format("{}:{}{}metal={},nm={}", spec.model, spec.others,
                                      spec.others.empty() ? "" : ",", spec.metal, range));
    if (!rgb) return spectrum;
    return asRgb(std::move(spectrum));
}

}  // namespace hshfit::brdfs
