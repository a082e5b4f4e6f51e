#include "command.h"
#include "command_rows.h"
#include "documents.h"
#include "job_options.h"

#include <hshfit/error.h>
#include <hshfit/files/extension.h>
#include <hshfit/material_library/library_file.h>
#include <hshfit/pages/picture_error_json.h>
#include <hshfit/pictures/poor.h>

#include <jobs/library/library_options.h>
#include <jobs/library/material_json.h>

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
    std::string action, output;
    std::vector<std::string> inputs;
    bool learnGiven = false;  ///< of merge: an option that learning takes
    jobs::LibraryOptions options;
};

Json headOf(const LibraryArguments& arguments) {
    Json head = {{"format", "hshfit-library-answer"}, {"version", 1}, {"action", arguments.action}};
    if (!arguments.output.empty()) head["output"] = arguments.output;
    return head;
}

std::string materialText(const ml::Material& m) {
    std::string text = fmt::format("{:<32} {:<10} {:>6}  {:<9.3g} {:<9.3g} {:<9.3g} {:<9.3g} {}\n",
                                   m.name, ml::nameOf(m.kind), m.bytes, m.error.meanLog,
                                   m.error.logError, m.error.relativeL2, m.error.maximum,
                                   m.error.flip > 0 ? fmt::format("{:.3g}", m.error.flip) : "-");
    if (!m.fallback.empty()) text += fmt::format("  a form of its own: it {}\n", m.fallback);
    return text;
}

constexpr const char* materialHead =
    "material                         kind        bytes  mean log  log       rel. L2   maximum   "
    "FLIP\n";

/// Bytes of the numbers of the materials.
std::size_t bytesOf(const ml::Library& library) {
    std::size_t bytes = 0;
    for (const ml::Material& m : library.materials) bytes += m.bytes;
    return bytes;
}

void printLearned(const jobs::LearnedLibrary& learned, const LibraryArguments& arguments,
                  const Globals& globals) {
    const ml::Library& library = learned.library;
    const std::vector<std::string>& fallbacks = learned.fallbacks;
    Json trials = Json::array();
    for (const ml::ComponentsTrial& trial : learned.basis.trials)
        trials.push_back({{"components", trial.components}, {"error", trial.error}});
    if (globals.json) {
        Json document = headOf(arguments);
        document["materials"] = learned.materials;
        document["components"] = library.basis.size();
        document["bytes"] = {{"basis", library.basis.bytes()},
                             {"materials", learned.bytes},
                             {"channel", library.basis.channelBytes()}};
        document["held_out"] = trials;
        document["unseen"] = {{"log", library.unseen}, {"flip", library.unseenFlip}};
        document["doubted"] = learned.basis.doubted;
        document["fallbacks"] = fallbacks;
        if (!learned.leftOut.empty()) document["left_out"] = learned.leftOut;
        return printJson(document);
    }
    std::string text =
        fmt::format("{}: {} materials, {} components; basis {} bytes, a channel {} bytes\n",
                    arguments.output, learned.materials, library.basis.size(),
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
    if (!learned.leftOut.empty())
        text += fmt::format("  left out, since the time was over: {}\n",
                            fmt::join(learned.leftOut, ", "));
    if (learned.basis.doubted > 0)
        text += fmt::format("  {} unlike the others, counted for less\n", learned.basis.doubted);
    printText(text);
}

void runLearn(const LibraryArguments& arguments, const Globals& globals) {
    jobs::LearnLibraryOptions options = arguments.options.learn;
    options.learn.components = arguments.options.componentCount();
    const jobs::EncodeOptions& given = arguments.options.encode;
    options.limits = {given.log.value_or(options.limits.log),
                      given.maximum.value_or(options.limits.maximum),
                      given.flip.value_or(options.limits.flip)};
    printLearned(
        jobs::learnLibrary(arguments.inputs, arguments.output, options, listenerFor(globals)),
        arguments, globals);
}

void runMerge(const LibraryArguments& arguments, const Globals& globals) {
    const jobs::LearnLibraryOptions& given = arguments.options.learn;
    jobs::MergeLibraryOptions options{.final = given.final};
    if (arguments.learnGiven) {
        options.learn = given.learn;
        options.learn->components = arguments.options.componentCount();
    }
    printLearned(jobs::mergeLibraries(arguments.inputs, arguments.output, options), arguments,
                 globals);
}

void runEncode(const LibraryArguments& arguments, const Globals& globals) {
    jobs::EncodeOptions options = arguments.options.encode;
    options.components = arguments.options.componentCount();
    const jobs::EncodedMaterial encoded = jobs::encodeMaterial(
        arguments.inputs[0], arguments.inputs[1], arguments.output, options, listenerFor(globals));
    const std::optional<std::string> poor = poorReason({}, encoded.picture);
    if (globals.json) {
        Json document = headOf(arguments);
        document.update(jobs::materialJson(encoded.material));
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
        document.update(jobs::materialJson(material));
        return printJson(document);
    }
    printText(std::string(materialHead) + materialText(material));
}

void runMix(const LibraryArguments& arguments, const Globals& globals) {
    const std::vector<jobs::MixedMaterial> path =
        jobs::mixMaterials(arguments.inputs, arguments.output, arguments.options.count);
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
            rows.push_back(jobs::materialJson(material));
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
        arguments.inputs[0], arguments.inputs[1], arguments.options.count, listenerFor(globals));
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
        arguments.inputs[0], arguments.output, arguments.options.reconstruct, listenerFor(globals));
    const ml::Agreement& agreement = done.agreement;
    const double each = agreement.chiSquare / static_cast<double>(agreement.degreesOfFreedom);
    if (!agreement.known)
        note(globals, fmt::format("{}: the library does not know such a material: chi-square is "
                                  "{:.3g} for each sample, of its own materials {:.3g} at most of "
                                  "39 in 40",
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
        if (!arguments.options.reconstruct.bandsTo.empty()) document["bands"] = done.bands.size();
        return printJson(document);
    }
    printText(
        fmt::format("{}: {} samples; chi-square {:.4g} over {} values, {:.3g} each; "
                    "expected error of ln(f + 0.001) {:.3g}\n",
                    arguments.output, done.samples, agreement.chiSquare, agreement.degreesOfFreedom,
                    each, done.expectedError));
}

void runNext(const LibraryArguments& arguments, const Globals& globals) {
    const jobs::LibraryOptions& given = arguments.options;
    jobs::NextPairsOptions options = given.next;
    options.library = given.reconstruct.library;
    options.sigma = given.reconstruct.sigma;
    options.count = given.count;
    const std::vector<ml::NextPair> pairs = jobs::nextPairs(
        arguments.inputs.empty() ? "" : arguments.inputs[0], arguments.output, options);
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
    jobs::LibraryExportOptions options = arguments.options.exporting;
    options.force = globals.force;
    const jobs::ExportedLibrary exported =
        jobs::exportLibrary(arguments.inputs[0], arguments.output, options, listenerFor(globals));
    std::vector<std::string> files;
    for (const gpu::ExportedFile& file : exported.textures) files.push_back(file.path);
    files.insert(files.end(), exported.texts.begin(), exported.texts.end());
    if (globals.json) {
        Json document = headOf(arguments);
        document["materials"] = exported.materials;
        document["left_out"] = exported.leftOut;
        document["components"] = exported.components;
        document["bytes"] = exported.bytes;
        document["table"] = exported.table ? jobs::tableJson(*exported.table) : Json(nullptr);
        document["sampling"] =
            exported.sampling ? jobs::samplingJson(*exported.sampling) : Json(nullptr);
        document["files"] = files;
        return printJson(document);
    }
    std::string text = fmt::format(
        "{}: {} materials over {} functions, {} bytes of texels each; {}\n", exported.name,
        exported.materials.size(), exported.components, exported.bytes, fmt::join(files, ", "));
    if (exported.table) {
        const jobs::ExportedTable& table = *exported.table;
        text += fmt::format(
            "  table of {} x {} x {} nodes, {} bytes: ln(f + 0.001) is off by {:.3g} at most, "
            "{:.3g} in the mean; FLIP {:.3g}, of {} {:.3g}\n",
            table.size.half, table.size.plane, table.size.horizon, table.bytes, table.error.largest,
            table.error.mean, table.flip, table.material, table.largestFlip);
    }
    if (exported.sampling) {
        text += fmt::format(
            "  proposals of {} elevations; variance of f cos / pdf over its mean squared, the "
            "median of materials:\n",
            exported.sampling->rows);
        for (const jobs::ExportedSampling::Row& row : exported.sampling->efficiency)
            text += fmt::format("  {:>3} degrees {:.2g}, of the cosine {:.2g}\n", row.theta,
                                row.variance, row.cosine);
    }
    if (!exported.leftOut.empty())
        text += fmt::format("  left out, with forms of their own: {}\n",
                            fmt::join(exported.leftOut, ", "));
    printText(text);
}

void runMap(const LibraryArguments& arguments, const Globals& globals) {
    const jobs::LibraryMap map = jobs::mapLibrary(arguments.inputs[0], arguments.output,
                                                  arguments.options.map, listenerFor(globals));
    if (globals.json) {
        Json document = headOf(arguments);
        document.update(jobs::libraryMapJson(map));
        return printJson(document);
    }
    std::string text =
        fmt::format("{}: {} materials; the map keeps {:.0f} % of their squared distances\n",
                    arguments.output, map.materials.size(), 100 * map.kept);
    text += fmt::format("  {} near duplicates, FLIP of at most {:g}{}\n", map.duplicates.size(),
                        map.near, map.duplicates.empty() ? "" : ":");
    for (const jobs::NearDuplicates& pair : map.duplicates)
        text += fmt::format("  {} and {}: FLIP {:.3f}, ln(f + 0.001) {:.3g}\n",
                            map.materials[pair.first].material.name,
                            map.materials[pair.second].material.name, pair.flip, pair.distance);
    printText(text);
}

/// One thing that the command does.
struct Action {
    std::string_view name;
    const char* inputs;  ///< as they are written
    std::size_t least, most;
    enum class Output { none, optional, required } output;
    unsigned kind;  ///< OptionRow::inputs
    void (*run)(const LibraryArguments&, const Globals&);
};

constexpr std::size_t any = 1000000;
namespace of = jobs::libraries;

constexpr Action actions[] = {
    {"learn", "MATERIAL…", 1, any, Action::Output::required, of::learn, runLearn},
    {"merge", "LIBRARY…", 1, any, Action::Output::required, of::merge, runMerge},
    {"encode", "LIBRARY MATERIAL", 2, 2, Action::Output::required, of::encode, runEncode},
    {"decode", "LIBRARY:NAME", 1, 1, Action::Output::required, 0, runDecode},
    {"export", "LIBRARY", 1, 1, Action::Output::required, of::exported, runExport},
    {"mix", "LIBRARY:NAME LIBRARY:NAME…", 2, any, Action::Output::required, of::mix, runMix},
    {"map", "LIBRARY", 1, 1, Action::Output::required, of::map, runMap},
    {"list", "LIBRARY", 1, 1, Action::Output::none, 0, runList},
    {"search", "LIBRARY MATERIAL", 2, 2, Action::Output::none, of::search, runSearch},
    {"reconstruct", "SAMPLES", 1, 1, Action::Output::required, of::reconstruct, runReconstruct},
    {"next", "[SAMPLES]", 0, 1, Action::Output::optional, of::next, runNext},
};

/// Throws UsageError for an option that is given, but not for this kind of action.
void requireOptions(const CLI::App& command, std::string_view action, unsigned kind) {
    const auto rows = jobs::libraryOptions().rows;
    const auto given = misplacedOption(command, rows, kind);
    if (!given) return;
    std::string own;
    for (const jobs::OptionRow& row : rows)
        if (row.inputs & kind) own += fmt::format(" --{}", row.name);
    throw UsageError(fmt::format("library {} takes no {}{}", action, given->name,
                                 own.empty() ? own : "; it takes" + own));
}

/// Throws UsageError where a library would get the extension of another format.
void requireLibraryName(const std::string& output, const Action& action) {
    constexpr std::string_view others[] = {".json", ".exr", ".csv", ".html", ".png"};
    const bool writesLibrary = action.output == Action::Output::required &&
                               action.run != runExport && action.run != runMap;
    const std::string extension = extensionOf(output);
    if (!writesLibrary || std::ranges::find(others, extension) == std::end(others)) return;
    throw UsageError(
        fmt::format("'{}': library {} writes a file of its own form; name it '{}.library'", output,
                    action.name, output.substr(0, output.size() - extension.size())));
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
    requireLibraryName(arguments.output, action);
    requireOptions(command, action.name, action.kind);
    if (command.count("--add-to") > 0)
        requireOptions(command, "learn with --add-to (its library states the others)", of::add);
    if ((action.kind & (of::reconstruct | of::next)) != 0 &&
        arguments.options.reconstruct.library.empty())
        throw UsageError(fmt::format("library {} needs --library LIBRARY", action.name));
}

std::vector<Word> actionWords() {
    std::vector<Word> words;
    for (const Action& action : actions) words.push_back({std::string(action.name)});
    return words;
}

constexpr ArgumentRow libraryArguments[] = {
    required("ACTION", at<&LibraryArguments::action>, "What to do",
             {.words = actionWords, .complete = true}),
    optional(
        "INPUT", at<&LibraryArguments::inputs>,
        "learn: MATERIAL… (specifications, files, folders); merge: LIBRARY…; encode and search: "
        "LIBRARY MATERIAL; decode and mix: LIBRARY:NAME; list, map, export: LIBRARY; "
        "reconstruct: SAMPLES; next: [SAMPLES]",
        brdfRead),
    optionalOutput(at<&LibraryArguments::output>,
                   "The library, the material, of map a page, of next a CSV, of export a folder",
                   {.files = Files::written, .dash = ".library"}),
};

}  // namespace

CommandRows libraryRows() {
    return {libraryArguments, {jobs::libraryOptions().rows}};
}

void addLibrary(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<LibraryArguments>();
    addArguments(command, libraryArguments, *arguments);
    addOptions(command, jobs::libraryOptions(), arguments->options);
    command.callback([arguments, &globals, &command] {
        const Action& action = *std::ranges::find(actions, arguments->action, &Action::name);
        check(command, *arguments, action);
        for (const char* option : {"--components", "--bytes", "--held-out"})
            arguments->learnGiven |= command.count(option) > 0;
        action.run(*arguments, globals);
    });
}

}  // namespace hshfit::cli
