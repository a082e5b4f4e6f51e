#include "command.h"
#include "documents.h"

#include <hshfit/error.h>
#include <hshfit/material_library/library_file.h>
#include <hshfit/pages/picture_error_json.h>
#include <hshfit/pictures/poor.h>

#include <jobs/library/library_export.h>
#include <jobs/library/material_library.h>
#include <jobs/library/material_samples.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace hshfit::cli {
namespace {

using Json = nlohmann::ordered_json;
namespace ml = material_library;

struct LibraryArguments {
    std::string action, output, instrument = "free";
    std::vector<std::string> inputs;
    std::string components = "auto";
    std::size_t count = 10;
    bool learnGiven = false, final = false;
    jobs::EncodeOptions encode;  ///< with the limits that are given
    jobs::LearnLibraryOptions learn;
    jobs::ReconstructOptions reconstruct;
    jobs::LibraryExportOptions exporting;

    std::size_t componentCount() const {
        if (components == "auto") return 0;
        std::size_t used = 0;
        int number = 0;
        try {
            number = std::stoi(components, &used);
        } catch (const std::exception&) {
            used = 0;
        }
        if (used != components.size() || number < 1 || number > 512)
            throw UsageError(fmt::format(
                "--components '{}': expected auto or a number from 1 to 512", components));
        return static_cast<std::size_t>(number);
    }
};

Json errorJson(const ml::FormError& error) {
    return {{"mean_log", error.meanLog},       {"log", error.logError},
            {"relative_l2", error.relativeL2}, {"maximum", error.maximum},
            {"largest", error.largest},        {"flip", error.flip}};
}

Json headOf(const LibraryArguments& arguments) {
    Json head = {{"format", "hshfit-library-answer"}, {"version", 1}, {"action", arguments.action}};
    if (!arguments.output.empty()) head["output"] = arguments.output;
    return head;
}

Json materialJson(const ml::Material& material) {
    return {{"name", material.name},
            {"source", material.source},
            {"kind", ml::nameOf(material.kind)},
            {"channels", material.channels},
            {"bytes", material.bytes},
            {"error", errorJson(material.error)},
            {"fallback", material.fallback.empty() ? Json(nullptr) : Json(material.fallback)}};
}

std::string materialText(const ml::Material& m) {
    std::string text =
        fmt::format("{:<32} {:<10} {:>6}  {:<9.3g} {:<9.3g} {:<9.3g} {:<9.3g} {:.3g}\n", m.name,
                    ml::nameOf(m.kind), m.bytes, m.error.meanLog, m.error.logError,
                    m.error.relativeL2, m.error.maximum, m.error.flip);
    if (!m.fallback.empty()) text += fmt::format("  a form of its own: it {}\n", m.fallback);
    return text;
}

constexpr const char* materialHead =
    "material                         kind        bytes  mean log  log       rel. L2   maximum   "
    "FLIP\n";

std::vector<std::string> fallbacksOf(const ml::Library& library) {
    std::vector<std::string> names;
    for (const ml::Material& m : library.materials)
        if (m.kind != ml::Kind::coded) names.push_back(m.name);
    return names;
}

/// Bytes of the numbers of the materials.
std::size_t bytesOf(const ml::Library& library) {
    std::size_t bytes = 0;
    for (const ml::Material& m : library.materials) bytes += m.bytes;
    return bytes;
}

void printLearned(const jobs::LearnedLibrary& learned, const LibraryArguments& arguments,
                  const Globals& globals) {
    const ml::Library& library = learned.library;
    const std::vector<std::string> fallbacks = fallbacksOf(library);
    Json trials = Json::array();
    for (const ml::ComponentsTrial& trial : learned.basis.trials)
        trials.push_back({{"components", trial.components}, {"error", trial.error}});
    if (globals.json) {
        Json document = headOf(arguments);
        document["materials"] = library.materials.size();
        document["components"] = library.basis.size();
        document["bytes"] = {{"basis", library.basis.bytes()},
                             {"materials", bytesOf(library)},
                             {"channel", library.basis.channelBytes()}};
        document["held_out"] = trials;
        document["unseen"] = {{"log", library.unseen}, {"flip", library.unseenFlip}};
        document["doubted"] = learned.basis.doubted;
        document["fallbacks"] = fallbacks;
        return printJson(document);
    }
    std::string text =
        fmt::format("{}: {} materials, {} components; basis {} bytes, a channel {} bytes\n",
                    arguments.output, library.materials.size(), library.basis.size(),
                    library.basis.bytes(), library.basis.channelBytes());
    for (const ml::ComponentsTrial& trial : learned.basis.trials)
        text += fmt::format(
            "  {:>3} components: root mean square of ln(f + 0.001) {:.4f} on "
            "materials that took no part\n",
            trial.components, trial.error);
    if (library.unseenFlip > 0)
        text += fmt::format("  mean FLIP {:.4f} on these with {} components\n", library.unseenFlip,
                            library.basis.size());
    if (!fallbacks.empty())
        text += fmt::format("  forms of their own: {}\n", fmt::join(fallbacks, ", "));
    if (learned.basis.doubted > 0)
        text += fmt::format("  {} unlike the others, counted for less\n", learned.basis.doubted);
    printText(text);
}

void runLearn(const LibraryArguments& arguments, const Globals& globals) {
    jobs::LearnLibraryOptions options = arguments.learn;
    options.learn.components = arguments.componentCount();
    const ml::Limits usual;
    options.limits = {arguments.encode.log.value_or(usual.log),
                      arguments.encode.maximum.value_or(usual.maximum),
                      arguments.encode.flip.value_or(usual.flip)};
    options.final = arguments.final;
    printLearned(
        jobs::learnLibrary(arguments.inputs, arguments.output, options, listenerFor(globals)),
        arguments, globals);
}

void runMerge(const LibraryArguments& arguments, const Globals& globals) {
    jobs::MergeLibraryOptions options{.final = arguments.final};
    if (arguments.learnGiven) {
        options.learn = arguments.learn.learn;
        options.learn->components = arguments.componentCount();
    }
    printLearned(jobs::mergeLibraries(arguments.inputs, arguments.output, options), arguments,
                 globals);
}

void runEncode(const LibraryArguments& arguments, const Globals& globals) {
    jobs::EncodeOptions options = arguments.encode;
    options.components = arguments.componentCount();
    const jobs::EncodedMaterial encoded = jobs::encodeMaterial(
        arguments.inputs[0], arguments.inputs[1], arguments.output, options, listenerFor(globals));
    const std::optional<std::string> poor = poorReason({}, encoded.picture);
    if (globals.json) {
        Json document = headOf(arguments);
        document.update(materialJson(encoded.material));
        document["picture"] = pictureErrorJson(encoded.picture);
        document["poor"] = poor ? Json(*poor) : Json(nullptr);
        return printJson(document);
    }
    std::string text = std::string(materialHead) + materialText(encoded.material) + "  " +
                       indented(textOf(encoded.picture));
    if (poor) text += fmt::format("  poor: {}\n", *poor);
    printText(text);
}

void runDecode(const LibraryArguments& arguments, const Globals& globals) {
    const ml::Material material = jobs::decodeMaterial(arguments.inputs[0], arguments.output);
    if (globals.json) {
        Json document = headOf(arguments);
        document.update(materialJson(material));
        return printJson(document);
    }
    printText(std::string(materialHead) + materialText(material));
}

void runMix(const LibraryArguments& arguments, const Globals& globals) {
    const std::vector<jobs::MixedMaterial> path =
        jobs::mixMaterials(arguments.inputs, arguments.output, arguments.count);
    Json rows = Json::array();
    std::string text;
    for (const jobs::MixedMaterial& one : path) {
        rows.push_back({{"name", one.name},
                        {"first", one.first},
                        {"second", one.second},
                        {"share", one.share}});
        text += one.name + "\n";
    }
    if (!globals.json) return printText(text);
    Json document = headOf(arguments);
    document["mixed"] = std::move(rows);
    printJson(document);
}

void runList(const LibraryArguments& arguments, const Globals& globals) {
    const ml::Library library = ml::readLibrary(arguments.inputs[0]);
    if (globals.json) {
        Json document = headOf(arguments), rows = Json::array();
        for (const ml::Material& material : library.materials)
            rows.push_back(materialJson(material));
        document["components"] = library.basis.size();
        document["widths"] = library.basis.widths;
        document["bytes"] = {{"basis", library.basis.bytes()}, {"materials", bytesOf(library)}};
        document["limit"] = {{"log", library.limits.log},
                             {"maximum", library.limits.maximum},
                             {"flip", library.limits.flip}};
        document["basis"] = library.basisFile.empty() ? Json(nullptr) : Json(library.basisFile);
        document["final"] = library.measured.empty();
        document["materials"] = std::move(rows);
        return printJson(document);
    }
    std::string text = materialHead;
    for (const ml::Material& material : library.materials) text += materialText(material);
    text +=
        fmt::format("{} materials, {} bytes; {} components, {} bytes\n", library.materials.size(),
                    bytesOf(library), library.basis.size(), library.basis.bytes());
    printText(text);
}

void runSearch(const LibraryArguments& arguments, const Globals& globals) {
    const std::vector<jobs::FoundMaterial> found = jobs::searchLibrary(
        arguments.inputs[0], arguments.inputs[1], arguments.count, listenerFor(globals));
    Json rows = Json::array();
    std::string text = "material                         FLIP    CIEDE2000  ln(f + 0.001)\n";
    for (const jobs::FoundMaterial& one : found) {
        rows.push_back({{"name", one.name},
                        {"distance", one.distance},
                        {"picture", pictureErrorJson(one.picture)}});
        text += fmt::format("{:<32} {:<7.4f} {:<10.3g} {:.3g}\n", one.name, one.picture.flip.mean,
                            one.picture.colour.mean, one.distance);
    }
    if (!globals.json) return printText(text);
    Json document = headOf(arguments);
    document["found"] = std::move(rows);
    printJson(document);
}

void runReconstruct(const LibraryArguments& arguments, const Globals& globals) {
    const jobs::ReconstructedMaterial done = jobs::reconstructMaterial(
        arguments.inputs[0], arguments.output, arguments.reconstruct, listenerFor(globals));
    const ml::Agreement& agreement = done.agreement;
    const double each = agreement.chiSquare / static_cast<double>(agreement.degreesOfFreedom);
    if (!agreement.known)
        note(globals, fmt::format("{}: the library does not know such a material: chi-square is "
                                  "{:.3g} for each sample, of its own materials {:.3g} at most of "
                                  "19 in 20",
                                  arguments.inputs[0], each, agreement.usual));
    if (globals.json) {
        Json document = headOf(arguments);
        document["name"] = done.name;
        document["samples"] = done.samples;
        document["chi_square"] = agreement.chiSquare;
        document["degrees_of_freedom"] = agreement.degreesOfFreedom;
        document["usual"] = agreement.usual;
        document["known"] = agreement.known;
        document["expected_error"] = done.expectedError;
        if (!arguments.reconstruct.bandsTo.empty()) document["bands"] = done.bands.size();
        return printJson(document);
    }
    printText(
        fmt::format("{}: {} samples; chi-square {:.4g} over {} values, {:.3g} each; "
                    "expected error of ln(f + 0.001) {:.3g}\n",
                    arguments.output, done.samples, agreement.chiSquare, agreement.degreesOfFreedom,
                    each, done.expectedError));
}

void runNext(const LibraryArguments& arguments, const Globals& globals) {
    const std::vector<ml::NextPair> pairs =
        jobs::nextPairs(arguments.inputs.empty() ? "" : arguments.inputs[0], arguments.output,
                        {.library = arguments.reconstruct.library,
                         .sigma = arguments.reconstruct.sigma,
                         .count = arguments.count,
                         .inPlane = arguments.instrument == "in-plane"});
    Json rows = Json::array();
    std::string text = " wi              wo              expected error\n";
    for (const ml::NextPair& next : pairs) {
        rows.push_back({{"incoming", directionJson(next.pair.wi)},
                        {"outgoing", directionJson(next.pair.wo)},
                        {"expected_error", next.expectedError}});
        text += fmt::format(" {:<15} {:<15} {:.4f}\n", directionText(next.pair.wi),
                            directionText(next.pair.wo), next.expectedError);
    }
    if (!globals.json) return printText(text);
    Json document = headOf(arguments);
    document["pairs"] = std::move(rows);
    printJson(document);
}

void runExport(const LibraryArguments& arguments, const Globals& globals) {
    jobs::LibraryExportOptions options = arguments.exporting;
    options.force = globals.force;
    const jobs::ExportedLibrary exported =
        jobs::exportLibrary(arguments.inputs[0], arguments.output, options);
    std::vector<std::string> files;
    for (const gpu::ExportedFile& file : exported.textures) files.push_back(file.path);
    files.insert(files.end(), exported.shaders.begin(), exported.shaders.end());
    if (globals.json) {
        Json document = headOf(arguments);
        document["materials"] = exported.materials;
        document["left_out"] = exported.leftOut;
        document["components"] = exported.components;
        document["bytes"] = exported.bytes;
        document["files"] = files;
        return printJson(document);
    }
    std::string text = fmt::format(
        "{}: {} materials over {} functions, {} bytes of texels each; {}\n", exported.name,
        exported.materials.size(), exported.components, exported.bytes, fmt::join(files, ", "));
    if (!exported.leftOut.empty())
        text += fmt::format("  left out, with forms of their own: {}\n",
                            fmt::join(exported.leftOut, ", "));
    printText(text);
}

/// One thing that the command does.
struct Action {
    const char* name;
    const char* inputs;  ///< as they are written
    std::size_t least, most;
    enum class Output { none, optional, required } output;
    const char* options;  ///< that it takes, with a space after each
    void (*run)(const LibraryArguments&, const Globals&);
};

constexpr std::size_t any = 1000000;

constexpr Action actions[] = {
    {"learn", "MATERIAL…", 1, any, Action::Output::required,
     "--components --bytes --held-out --limit --limit-maximum --limit-flip --add-to --final ",
     runLearn},
    {"merge", "LIBRARY…", 1, any, Action::Output::required,
     "--components --bytes --held-out --final ", runMerge},
    {"encode", "LIBRARY MATERIAL", 2, 2, Action::Output::required,
     "--components --limit --limit-maximum --limit-flip ", runEncode},
    {"decode", "LIBRARY:NAME", 1, 1, Action::Output::required, "", runDecode},
    {"export", "LIBRARY", 1, 1, Action::Output::required, "--target --prefix ", runExport},
    {"mix", "LIBRARY:NAME LIBRARY:NAME…", 2, any, Action::Output::required, "--count ", runMix},
    {"list", "LIBRARY", 1, 1, Action::Output::none, "", runList},
    {"search", "LIBRARY MATERIAL", 2, 2, Action::Output::none, "--count ", runSearch},
    {"reconstruct", "SAMPLES", 1, 1, Action::Output::required,
     "--library --sigma --bands --bands-to ", runReconstruct},
    {"next", "[SAMPLES]", 0, 1, Action::Output::optional, "--library --count --sigma --instrument ",
     runNext},
};

const Action& actionOf(const std::string& name) {
    return *std::ranges::find_if(actions,
                                 [&](const Action& action) { return name == action.name; });
}

/// Throws UsageError for what this action does not take.
void check(const CLI::App& command, const LibraryArguments& arguments, const Action& action) {
    const std::size_t count = arguments.inputs.size();
    if (count < action.least || count > action.most)
        throw UsageError(fmt::format("library {} takes {}; {} given", action.name, action.inputs,
                                     count == 1 ? "one is" : fmt::format("{} are", count)));
    using enum Action::Output;
    if (arguments.output.empty() && action.output == required)
        throw UsageError(fmt::format("library {} needs -o FILE", action.name));
    if (!arguments.output.empty() && action.output == none)
        throw UsageError(fmt::format("library {} writes no file; leave out -o", action.name));
    const auto takes = [](const Action& one, const std::string& option) {
        return std::string_view(one.options).find(option + " ") != std::string_view::npos;
    };
    const std::string_view own(action.options);
    for (const CLI::Option* option : command.get_options()) {
        const std::string name = option->get_name();
        const bool ofActions =
            std::ranges::any_of(actions, [&](const Action& one) { return takes(one, name); });
        if (option->count() == 0 || !ofActions || takes(action, name)) continue;
        throw UsageError(
            fmt::format("library {} takes no {}{}", action.name, name,
                        own.empty() ? std::string()
                                    : fmt::format("; it takes {}", own.substr(0, own.size() - 1))));
    }
    if (takes(action, "--library") && arguments.reconstruct.library.empty())
        throw UsageError(fmt::format("library {} needs --library LIBRARY", action.name));
    if (command.count("--add-to") > 0)
        for (const char* option : {"--components", "--bytes", "--held-out", "--limit",
                                   "--limit-maximum", "--limit-flip"})
            if (command.count(option) > 0)
                throw UsageError(
                    fmt::format("{} is that of the library that --add-to names", option));
}

std::vector<std::string> actionNames() {
    std::vector<std::string> names;
    for (const Action& action : actions) names.emplace_back(action.name);
    return names;
}

}  // namespace

void addLibrary(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<LibraryArguments>();
    command.add_option("ACTION", arguments->action, "What to do")
        ->required()
        ->check(CLI::IsMember(actionNames()));
    command.add_option(
        "INPUT", arguments->inputs,
        "learn: MATERIAL… (specifications, files, folders); merge: LIBRARY…; encode and search: "
        "LIBRARY MATERIAL; decode and mix: LIBRARY:NAME; list, export: LIBRARY; reconstruct: "
        "SAMPLES; "
        "next: [SAMPLES]");
    command.add_option("-o,--output", arguments->output,
                       "The library, the material, of next a CSV, of export a folder");
    command
        .add_option(
            "--components", arguments->components,
            "learn, merge: components of the basis, auto (by materials that take no part) or a "
            "number; encode: that are used")
        ->capture_default_str();
    command
        .add_option("--bytes", arguments->learn.learn.bytes,
                    "learn, merge: of a material in colours; a third of it for each channel")
        ->check(CLI::Range(6, 65536))
        ->capture_default_str();
    command
        .add_option(
            "--held-out", arguments->learn.learn.heldOut,
            "learn, merge: share of the materials that take no part in choosing the components")
        ->check(CLI::Range(0.01, 0.5))
        ->capture_default_str();
    command
        .add_option("--limit", arguments->encode.log,
                    "learn, encode: mean error of ln(f + 0.001) beyond which a material keeps a "
                    "form of its own")
        ->check(CLI::Range(0.0, ml::greatestLimit))
        ->default_str(fmt::format("{}", ml::Limits{}.log));
    command
        .add_option("--limit-maximum", arguments->encode.maximum,
                    "learn, encode: the same for the largest error of f cos, as a share of the "
                    "largest f cos")
        ->check(CLI::Range(0.0, ml::greatestLimit))
        ->default_str(fmt::format("{}", ml::Limits{}.maximum));
    command
        .add_option("--limit-flip", arguments->encode.flip,
                    "learn, encode: the same for the mean FLIP of spheres; from 1 on no picture is "
                    "drawn")
        ->check(CLI::Range(0.0, ml::greatestLimit))
        ->default_str(fmt::format("{}", ml::Limits{}.flip));
    command.add_option("--add-to", arguments->learn.addTo,
                       "learn: a library whose materials come first");
    command.add_flag("--final", arguments->final,
                     "learn, merge: without what adding and merging need");
    command.add_option("--library", arguments->reconstruct.library,
                       "reconstruct, next: the library that is the prior");
    command
        .add_option("--count", arguments->count,
                    "search, mix: materials; next: pairs of directions")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    command
        .add_option("--sigma", arguments->reconstruct.sigma,
                    "reconstruct, next: standard uncertainty of the samples, as in fit: 2%, 0.001, "
                    "2%+0.001; reconstruct also column or FILE.csv")
        ->capture_default_str();
    command
        .add_option("--instrument", arguments->instrument,
                    "next: free, or in-plane for a goniometer in the plane of incidence")
        ->check(CLI::IsMember({"free", "in-plane"}))
        ->capture_default_str();
    command
        .add_option(
            "--target", arguments->exporting.targets,
            "export: shaders (glsl, glsl-es, hlsl, slang, metal, wgsl) and containers of texels "
            "(bin, dds, exr, ktx2, …), with commas, or all")
        ->capture_default_str();
    command.add_option("--prefix", arguments->exporting.prefix, "export: of the names in shaders")
        ->capture_default_str();
    command.add_option("--bands", arguments->reconstruct.bands,
                       "reconstruct: error bands at pairs of directions: a CSV with wi_x ... wo_z, "
                       "or plane:30/60 for planes of incidence");
    command.add_option("--bands-to", arguments->reconstruct.bandsTo, "CSV file for the bands");
    command.callback([arguments, &globals, &command] {
        const Action& action = actionOf(arguments->action);
        check(command, *arguments, action);
        for (const char* option : {"--components", "--bytes", "--held-out"})
            arguments->learnGiven |= command.count(option) > 0;
        action.run(*arguments, globals);
    });
}

}  // namespace hshfit::cli
