#include <hshfit/gpu/forms/form_files.h>

#include <hshfit/coefficient_files/coefficient_formats.h>
#include <hshfit/error.h>
#include <hshfit/files/checksum.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/gpu/containers/sidecar.h>
#include <hshfit/gpu/forms/form_table.h>
#include <hshfit/representation/forms/represented_brdf.h>
#include <hshfit/representation/named_arrays.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace hshfit::gpu::inline forms {
namespace {

using Json = nlohmann::ordered_json;

/// As for coefficients per outgoing direction (containers/import_files.cpp).
constexpr double testTolerance = 1e-9;

/// The member "representation" of the coefficient file. In place of an array's bytes stands what
/// precedes its numbers: scales, offsets and mask.
Json representationJson(const Representation& form, const Json& file) {
    Json part = file.at("representation");
    const auto arrays = namedArrays(form);
    for (std::size_t a = 0; a < arrays.size(); ++a) {
        const StoredArray& array = *arrays[a].array;
        std::vector<std::byte> head = packed(array);
        head.resize(head.size() - keptCount(array) * numberBytes(array.precision));
        Json& row = part["arrays"][a];
        row.erase("base64");
        row["numbers"] = keptCount(array);
        row["scales"] = array.scales;
        row["offsets"] = array.offsets;
        row["head"] = base64(head);
    }
    return part;
}

/// For each number [array, value], null for nothing: the order of the texels for readers that have
/// no shader.
Json streamJson(const FormPayload& payload) {
    Json rows = Json::array();
    for (const StreamNumber& number : payload.stream) {
        if (number.array == StreamNumber::nothing)
            rows.push_back(nullptr);
        else
            rows.push_back({number.array, number.value});
    }
    return rows;
}

std::vector<double> valueAt(const Brdf& brdf, const TestTriple& triple) {
    std::vector<double> value(brdf.channels().count());
    brdf.eval(triple.wo, {&triple.wi.x, &triple.wi.y, &triple.wi.z, 1}, value.data());
    return value;
}

std::vector<TestTriple> testsOf(const Representation& form, const BrdfOpener& open) {
    const auto brdf = reconstruct(form, open);
    std::vector<TestTriple> tests = testPairs();
    for (TestTriple& test : tests) test.value = valueAt(*brdf, test);
    return tests;
}

constexpr const char* testValue = "f in 1/sr as the coefficient file gives it, in double precision";

std::string sidecarOf(const FormPayload& payload, std::span<const ExportedFile> files,
                      std::optional<Role> holds, std::span<const TestTriple> tests,
                      const ExportOptions& options) {
    const Json file = Json::parse(representationToJson(payload.form));
    Json document = {{"format", "hshfit-gpu"},
                     {"version", formSidecarVersion},
                     {"form", kindName(payload.form.kind())}};
    if (holds) document["holds"] = roleName(*holds);
    for (const auto& [key, value] : file.items()) {
        if (key != "format" && key != "version" && key != "representation") document[key] = value;
    }
    const bool rgb = payload.form.head.channels.kind == Channels::Kind::rgb;
    document["colorspace"] = rgb ? Json("lin_rec709") : Json(nullptr);
    document["cos_included"] = false;
    document["unit"] = "1/sr";
    document["frame"] = Json::parse(frameText());
    document["value"] = formulaOf(payload.form);
    document["representation"] = representationJson(payload.form, file);
    document["sampling"] = {{"filter", "none"}, {"mip", "none"}, {"lod", 0}, {"srgb", false}};
    document["stream"] = {{"index", "number n is lane n % 4 of texel n / 4, texels row by row"},
                          {"numbers", payload.stream.size()},
                          {"order", streamJson(payload)}};
    document["data"] = Json::parse(dataText(payload.texels, "stream"));
    document["basis_textures"] = nullptr;
    document["files"] = Json::parse(filesText(files));
    document["fit_error"] =
        options.fitError.empty() ? Json(nullptr) : Json::parse(options.fitError);
    if (!options.proposal.empty()) document["proposal"] = Json::parse(options.proposal);
    document["test_value"] = testValue;
    document["tests"] = Json::parse(testsText(tests));
    return readableSidecar(jsonText(document));
}

std::vector<std::pair<std::string, std::string>> factsOf(const FormPayload& payload) {
    const Representation& form = payload.form;
    std::string channels;
    for (const std::string& name : form.head.channels.names())
        channels += (channels.empty() ? "" : " ") + name;
    return {{"form", std::string(kindName(form.kind()))},
            {"numbers", std::to_string(form.numbers())},
            {"layout", "stream"},
            {"channels", channels},
            {"source", form.head.source}};
}

/// The coefficient file that a sidecar describes, with zeros for numbers.
Representation skeletonOf(const LoadedTexels& loaded) {
    nlohmann::json document = parseJson(loaded.text, loaded.sidecar, deepestJson);
    const JsonFields root(document, "", loaded.sidecar);
    const JsonFields part = root.object("representation");
    std::vector<std::string> packedArrays;
    // All arrays together are no longer than the texels: nothing more is allocated.
    int left = static_cast<int>(loaded.index.coefficients.count());
    for (const JsonFields& row : part.objects("arrays")) {
        const int numbers = row.integer("numbers", 0, left);
        left -= numbers;
        const Precision precision = [&] {
            try {
                return parsePrecision(row.word("precision"));
            } catch (const UsageError& error) {
                row.fail(error.what(), "precision");
            }
        }();
        const std::string text = row.word("head");
        const std::size_t padding = text.ends_with("==") ? 2 : text.ends_with("=") ? 1 : 0;
        const std::size_t length = std::max<std::size_t>(text.size() / 4 * 3, padding) - padding;
        std::vector<std::byte> bytes = fromBase64(text, length);
        if (bytes.size() != length) row.fail("has to be base64", "head");
        bytes.resize(length + static_cast<std::size_t>(numbers) * numberBytes(precision));
        packedArrays.push_back(base64(bytes));
    }
    std::size_t a = 0;
    for (auto& row : document["representation"]["arrays"]) {
        const std::string& text = packedArrays[a++];
        row["bytes"] = text.size() / 4 * 3 - (text.ends_with("==")  ? 2
                                              : text.ends_with("=") ? 1
                                                                    : 0);
        row["base64"] = text;
    }
    document["format"] = coefficientFormat;
    document["version"] = 1;
    return representationFromJson(jsonText(document), loaded.sidecar);
}

double largestDifference(const Representation& form, const BrdfOpener& open,
                         std::span<const TestTriple> tests) {
    const auto brdf = reconstruct(form, open);
    double difference = 0, largest = 0;
    for (const TestTriple& test : tests) {
        const std::vector<double> value = valueAt(*brdf, test);
        for (std::size_t c = 0; c < value.size(); ++c) {
            difference = std::max(difference, std::abs(value[c] - test.value[c]));
            largest = std::max(largest, std::abs(value[c]));
        }
    }
    return largest > 0 ? difference / largest : difference;
}

}  // namespace

std::vector<ExportedFile> writeForm(const FormPayload& payload,
                                    std::span<const Container* const> containers,
                                    const std::string& name, const ExportOptions& options,
                                    const BrdfOpener& open, FileSet& files) {
    const std::vector<TestTriple> tests = testsOf(payload.form, open);
    return writeTexels({.sets = {{Role::coefficients, &payload.texels}},
                        .facts = factsOf(payload),
                        .sidecar =
                            [&](std::span<const ExportedFile> written, std::optional<Role> holds) {
                                return sidecarOf(payload, written, holds, tests, options);
                            },
                        .tests = testText(payload.form.head, tests, testValue)},
                       containers, name, options.zstd, files);
}

namespace {

ImportedForm formOf(LoadedTexels loaded, const BrdfOpener& open) {
    if (loaded.index.form.empty())
        throw InputError(fmt::format("{}: has no form of its own", loaded.sidecar));
    Representation skeleton = skeletonOf(loaded);
    if (loaded.index.form != kindName(skeleton.kind())) {
        throw InputError(fmt::format("{}: 'form' and 'representation' disagree", loaded.sidecar));
    }
    const nlohmann::json document = parseJson(loaded.text, loaded.sidecar, deepestJson);
    const std::vector<TestTriple> tests =
        readSidecarTests(JsonFields(document, "", loaded.sidecar), skeleton.head.channels.count());
    ImportedForm result{
        unpackForm(std::move(skeleton), std::move(loaded.index.coefficients), loaded.file),
        loaded.container, loaded.file, loaded.sidecar, tests.size()};
    result.testDifference = largestDifference(result.payload.form, open, tests);
    if (!(result.testDifference <= testTolerance)) {
        throw InputError(
            fmt::format("{}: the tests differ from the coefficients by {:.2g} of the largest value",
                        result.sidecar, result.testDifference));
    }
    return result;
}

/// The texels of an export; nothing where the file is none or cannot be read.
std::optional<LoadedTexels> loadedIfForm(const std::string& path) {
    if (!looksLikePayload(path)) return std::nullopt;
    try {
        LoadedTexels loaded = loadTexels(path);
        if (!loaded.index.form.empty()) return loaded;
    } catch (const Error&) {
        return std::nullopt;
    }
    return std::nullopt;
}

}  // namespace

bool looksLikeForm(const std::string& path) {
    return loadedIfForm(path).has_value();
}

std::optional<ImportedForm> readIfForm(const std::string& path, const BrdfOpener& open) {
    std::optional<LoadedTexels> loaded = loadedIfForm(path);
    if (!loaded) return std::nullopt;
    return formOf(std::move(*loaded), open);
}

ImportedForm readForm(const std::string& path, const BrdfOpener& open) {
    return formOf(loadTexels(path), open);
}

}  // namespace hshfit::gpu::inline forms
