#include <brdfs/catalog.h>

#include <brdfs/catalog/preset.h>
#include <brdfs/composed/sum.h>
#include <brdfs/fit/dispersion_json.h>
#include <brdfs/fit/gaussian_mixture_json.h>
#include <brdfs/measured/foreign.h>
#include <brdfs/measured/material_library.h>
#include <brdfs/measured/own_samples.h>
#include <brdfs/measured/scattered/xompt.h>
#include <brdfs/presets/preset_collection.h>
#include <hshfit/brdf/colour.h>
#include <hshfit/brdf/one_channel.h>
#include <hshfit/error.h>
#include <hshfit/files/extension.h>
#include <hshfit/files/json_format.h>

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace hshfit::brdfs {
namespace {

namespace fs = std::filesystem;

template <class Row>
std::vector<std::string_view> namesOf(std::span<const Row> table) {
    std::vector<std::string_view> names;
    for (const Row& row : table) names.push_back(row.name);
    return names;
}

/// The first `most` bytes of a file; all of them if it has fewer.
std::vector<unsigned char> readHead(const std::string& path, std::size_t most) {
    std::ifstream file(path, std::ios::binary);
    std::vector<unsigned char> head(most);
    if (file) file.read(reinterpret_cast<char*>(head.data()), static_cast<std::streamsize>(most));
    if (!file.is_open() || file.bad()) throw InputError(path + ": cannot be read");
    head.resize(static_cast<std::size_t>(file.gcount()));
    return head;
}

constexpr std::size_t headBytes = 4096;
static_assert(headBytes >= jsonStartBytes);

bool isJson(std::span<const unsigned char> head) {
    return beginsAsJson({reinterpret_cast<const char*>(head.data()), head.size()});
}

/// JSON of this program. The key "format" may come behind the head of a long file.
bool isPreset(std::span<const unsigned char> head) {
    const std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
    return beginsAsJson(text) &&
           (head.size() == headBytes || jsonFormat(text).starts_with("hshfit"));
}

/// The format by content; null for content that none knows.
const Format* recognisedFormat(std::span<const unsigned char> head, std::uint64_t size) {
    for (const Format& format : formats())
        if (format.recognises(head, size)) return &format;
    return nullptr;
}

/// Throws for content that looks like something else, naming it.
void refuseForeign(const std::string& path, std::span<const unsigned char> head, bool certain) {
    if (const auto foreign = foreignContent(head, certain))
        throw InputError(fmt::format("{}: of no known format: it looks like {}", path, *foreign));
}

/// Formats that are text or may be; the others are bytes.
constexpr std::string_view textFormats[] = {"bsdf-xml", "astm",  "zemax",   "fred",
                                            "cornell",  "xompt", "csv",     "nist",
                                            "scatmech", "bird",  "pab-opto"};
constexpr std::string_view eitherFormats[] = {"alta", "speos"};

/// The format by extension, for content that none recognises. Content that looks like something
/// else is named instead.
const Format& formatByExtension(const std::string& path, std::span<const unsigned char> head,
                                std::uint64_t size) {
    const std::string start = fmt::format("{}: of no known format", path);
    refuseForeign(path, head, false);
    const std::string extension = extensionOf(path);
    const bool plain = isPlainText(head);
    // A single word may be the beginning of either.
    const bool word =
        plain && std::ranges::none_of(head, [](unsigned char c) { return c == ' ' || c == '\n'; });
    const Format* misfit = nullptr;
    for (const Format& format : formats()) {
        // FRED's files end in .txt, as any text does.
        if (format.extension != extension || extension == ".txt") continue;
        const bool either =
            std::ranges::find(eitherFormats, format.name) != std::end(eitherFormats);
        const bool text = std::ranges::find(textFormats, format.name) != std::end(textFormats);
        if (either || word || plain == text) return format;
        misfit = &format;
    }
    if (misfit)
        throw InputError(fmt::format("{}: it holds {}, while '{}' ({}) is {}", start,
                                     plain ? "text" : "bytes that are no text", misfit->name,
                                     extension, plain ? "binary" : "text"));
    throw InputError(fmt::format("{} ({} bytes); known: {}, preset (.json)", start, size,
                                 joined(namesOf(formats()))));
}

std::unique_ptr<Brdf> openPresetFile(const std::string& path, std::uint64_t size,
                                     std::string_view material) {
    constexpr std::uint64_t most = 1 << 20;
    if (size > most)
        throw InputError(fmt::format("{}: {} bytes are too many for a preset", path, size));
    const std::vector<unsigned char> bytes = readHead(path, most);
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (isPresetCollection(text)) return openMaterial(text, path, material);
    if (material.empty() && isGaussianMixture(text)) return openGaussianMixture(text, path);
    if (constexpr std::string_view key = "nm="; material.starts_with(key))
        return openDispersed(text, path, material.substr(key.size()));
    if (!material.empty())
        throw UsageError(
            fmt::format("{}: a preset takes no options, '{}' was given", path, material));
    return openPreset(text, path);
}

std::unique_ptr<Brdf> openFile(const std::string& path, std::string_view options) {
    std::error_code error;
    if (fs::is_directory(path, error)) throw InputError(path + ": is a directory, not a BRDF file");
    if (!fs::is_regular_file(path, error)) throw InputError(path + ": is not a regular file");
    const std::uint64_t size = fs::file_size(path, error);
    if (error) throw InputError(fmt::format("{}: {}", path, error.message()));
    if (size == 0) throw InputError(path + ": is empty");
    const std::vector<unsigned char> bytes = readHead(path, headBytes);
    const std::string_view marked(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const std::size_t mark = marked.size() - withoutByteOrderMark(marked).size();
    const auto head = std::span(bytes).subspan(mark);
    refuseForeign(path, head, true);
    const Format* format = recognisedFormat(head, size);
    const std::string extension = extensionOf(path);
    if (!format && extension == xomptFormat().extension) format = &xomptFormat();
    if (!format && !isJson(head)) refuseForeign(path, head, false);
    if (!format && (extension == ".json" || isPreset(head)))
        return openPresetFile(path, size, options);
    if (!format) format = &formatByExtension(path, head, size);
    // The words after the path are the name of a material.
    if (format->name == materialLibraryFormat().name) return openLibraryMaterial(path, options);
    const std::string owner = fmt::format("{}: {}", path, format->name);
    return format->open(path, parseParameters(owner, format->parameters, options));
}

/// Whether a text is a path rather than a misspelt model: it has a folder or an extension.
bool looksLikePath(std::string_view text) {
    return text.find('/') != std::string_view::npos || fs::path(text).has_extension();
}

/// Whether a specification is an existing file, with or without options after its path.
bool isFile(std::string_view spec) {
    return !pathIn(spec).empty();
}

std::unique_ptr<Brdf> openTerm(std::string_view spec) {
    constexpr std::string_view presetPrefix = "preset:";
    if (spec.starts_with(presetPrefix)) return openNamedPreset(spec.substr(presetPrefix.size()));
    if (findModel(spec.substr(0, spec.find(':')))) return openModel(spec);
    if (const std::string_view path = pathIn(spec); !path.empty()) {
        const std::string_view options = spec.substr(path.size());
        return openFile(std::string(path), options.substr(options.empty() ? 0 : 1));
    }
    const std::string_view path = spec.substr(0, spec.rfind(':'));
    if (namesPreset(path))
        throw UsageError(fmt::format("{0}: no such file or model; did you mean preset:{0}?", path));
    if (looksLikePath(path)) throw InputError(fmt::format("{}: no such file", path));
    refuseModel(spec.substr(0, spec.find(':')));
}

/// One term with a factor: measured pairs stay measured pairs, so that fits and projections see
/// them alone.
std::unique_ptr<Brdf> scaledTerm(const WeightedSpec& term) {
    std::vector<Sum::Term> one;
    one.push_back({term.weight, openTerm(term.spec)});
    const auto* pairs = dynamic_cast<const HasMeasuredPairs*>(one.front().brdf.get());
    auto sum = std::make_unique<Sum>(std::move(one));
    if (pairs) return pairs->scaled(term.weight, sum->name());
    return sum;
}

std::unique_ptr<Brdf> openPrefixed(std::string_view spec, int depth) {
    if (spec.empty())
        throw UsageError(
            fmt::format("empty BRDF specification; give model[:key=value,...], a file "
                        "or preset:NAME; models: {}",
                        joined(namesOf(models()))));
    constexpr std::string_view rgbPrefix = "rgb:";
    const std::string_view grey = greyPrefix(spec);
    const bool rgb = spec.starts_with(rgbPrefix);
    // rgb and grey after each other make sense once, and every prefix is one more wrapper.
    constexpr int deepest = 4;
    if ((rgb || !grey.empty()) && depth == deepest)
        throw UsageError(
            fmt::format("'{}…': more than {} prefixes rgb: and grey: before a specification",
                        spec.substr(0, 40), deepest));
    if (rgb) return asRgb(openPrefixed(spec.substr(rgbPrefix.size()), depth + 1));
    if (!grey.empty())
        return asGrey(openPrefixed(spec.substr(grey.size()), depth + 1), greyWeights(grey));
    const std::vector<WeightedSpec> specs = splitSum(spec, isFile);
    if (specs.size() == 1 && specs.front().weight == 1) return openTerm(specs.front().spec);
    if (specs.size() == 1) return scaledTerm(specs.front());
    std::vector<Sum::Term> terms;
    for (const WeightedSpec& term : specs) terms.push_back({term.weight, openTerm(term.spec)});
    return std::make_unique<Sum>(std::move(terms));
}

}  // namespace

std::unique_ptr<Brdf> open(std::string_view spec) {
    return openPrefixed(spec, 0);
}

}  // namespace hshfit::brdfs
