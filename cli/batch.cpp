#include "batch_program.h"
#include "batch_progress.h"
#include "command.h"
#include "command_rows.h"
#include "job_options.h"

#include <hshfit/error.h>

#include <jobs/batches/batch_options.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <array>
#include <filesystem>

namespace hshfit::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t shownFailures = 20, shownMistakes = 50;

struct BatchArguments {
    std::string manifest, folder;
    jobs::BatchRequest options;
};

/// Makes the folder of the manifest the current one, to which paths in the manifest are relative.
/// Paths of the command line become absolute before.
void enterFolderOf(BatchArguments& arguments) {
    for (std::string* path :
         {&arguments.folder, &arguments.options.run.costs, &arguments.options.progress})
        if (!path->empty()) *path = fs::absolute(*path).lexically_normal().string();
    const fs::path manifest(arguments.manifest);
    if (manifest.string().starts_with("/dev/") || !manifest.has_parent_path()) return;
    std::error_code error;
    fs::current_path(manifest.parent_path(), error);
    if (error) throw InputError(fmt::format("{}: {}", arguments.manifest, error.message()));
    arguments.manifest = manifest.filename().string();
}

/// Exit code 3 with every mistake; false if there is none.
bool refuse(const jobs::Manifest& manifest, const std::string& path, Globals& globals) {
    const std::size_t count = manifest.mistakes.size();
    if (count == 0) return false;
    printList(fmt::format("{}: {} mistake{}; nothing was run", path, count, count == 1 ? "" : "s"),
              manifest.mistakes, shownMistakes);
    globals.exitCode = static_cast<int>(ExitCode::input);
    return true;
}

Json head(const BatchArguments& arguments, std::size_t items) {
    return {{"format", "hshfit-batch"},
            {"version", 1},
            {"manifest", arguments.manifest},
            {"shard",
             {{"index", arguments.options.run.shard.index},
              {"count", arguments.options.run.shard.count}}},
            {"items", items}};
}

Json failureJson(const jobs::ItemRecord& record) {
    return {{"name", record.name}, {"exit_code", record.exitCode}, {"message", record.message}};
}

void reportFailed(const std::vector<jobs::ItemRecord>& failures, std::size_t items,
                  Globals& globals) {
    if (failures.empty()) return;
    std::vector<std::string> lines;
    bool numeric = true;
    for (const jobs::ItemRecord& record : failures) {
        lines.push_back(record.name + ": " + record.message);
        numeric = numeric && record.exitCode == static_cast<int>(ExitCode::numeric);
    }
    printList(fmt::format("{} of {} items failed:", failures.size(), items), lines, shownFailures);
    globals.exitCode = static_cast<int>(numeric ? ExitCode::numeric : ExitCode::input);
}

void check(const BatchArguments& arguments, Globals& globals) {
    const jobs::BatchProgram program = batchProgram();
    const jobs::Manifest manifest = jobs::readManifest(arguments.manifest, program);
    if (refuse(manifest, arguments.manifest, globals)) return;
    const auto items = jobs::itemsOfShard(manifest, program, arguments.options.run);
    Json document = head(arguments, items.size());
    std::string text = fmt::format("{}: {} items, no mistake\n", arguments.manifest, items.size());
    if (arguments.options.list) {
        document["names"] = Json::array();
        for (const std::size_t i : items) {
            document["names"].push_back(manifest.items[i].name);
            text += manifest.items[i].name + "\n";
        }
    }
    globals.json ? printJson(document) : printText(text);
}

void run(const BatchArguments& arguments, Globals& globals) {
    const jobs::BatchOptions& options = arguments.options.run;
    if (!options.shard.origin.empty())
        note(globals, fmt::format("shard {}/{} of the {}", options.shard.index, options.shard.count,
                                  options.shard.origin));
    jobs::BatchRun result;
    {
        BatchProgress progress(globals, arguments.options.progress);
        result = jobs::runBatch(arguments.manifest, arguments.folder, batchProgram(), options,
                                listenerFor(globals),
                                [&](const jobs::BatchEvent& event) { progress.show(event); });
    }
    if (refuse(result.manifest, arguments.manifest, globals)) return;
    Json document = head(arguments, result.items);
    document["done"] = result.done;
    document["kept"] = result.kept;
    document["failed"] = result.failures.size();
    if (options.seconds) document["left"] = result.left;
    document["seconds"] = result.seconds;
    document["failures"] = Json::array();
    for (const jobs::ItemRecord& record : result.failures)
        document["failures"].push_back(failureJson(record));
    if (globals.json)
        printJson(document);
    else
        printText(fmt::format("{}: {} items, {} done ({} of them kept), {} failed, {:.3g} s\n",
                              arguments.manifest, result.items, result.done, result.kept,
                              result.failures.size(), result.seconds));
    if (result.left > 0)
        endWithoutNumbers(globals, fmt::format("the time was over before {} of {} items began; the "
                                               "same command makes them",
                                               result.left, result.items));
    reportFailed(result.failures, result.items, globals);
}

/// Where the whole batch stands and, if asked for, its table.
void survey(const BatchArguments& arguments, Globals& globals) {
    const jobs::BatchProgram program = batchProgram();
    const jobs::Manifest manifest = jobs::readManifest(arguments.manifest, program);
    if (refuse(manifest, arguments.manifest, globals)) return;
    const auto items = jobs::statusOf(manifest, arguments.folder, program, listenerFor(globals));
    std::array<std::size_t, 4> counts{};
    Json document = head(arguments, items.size()), failures = Json::array();
    for (const jobs::ItemStatus& item : items) {
        ++counts[static_cast<std::size_t>(item.state)];
        if (item.state == jobs::ItemStatus::State::failed)
            failures.push_back(failureJson(*item.record));
    }
    std::string text = fmt::format("{}: {} items", arguments.manifest, items.size());
    for (const auto state : {jobs::ItemStatus::State::done, jobs::ItemStatus::State::failed,
                             jobs::ItemStatus::State::stale, jobs::ItemStatus::State::missing}) {
        const std::size_t count = counts[static_cast<std::size_t>(state)];
        document[std::string(jobs::nameOf(state))] = count;
        text += fmt::format(", {} {}", count, jobs::nameOf(state));
    }
    document["kept"] = document["done"];
    document["failures"] = failures;
    text += "\n";
    if (arguments.options.merge) {
        document["files"] = jobs::mergeBatch(items, arguments.folder, program,
                                             arguments.options.merging, listenerFor(globals));
        for (const auto& file : document["files"]) text += file.get<std::string>() + "\n";
    }
    globals.json ? printJson(document) : printText(text);
}

void runBatch(BatchArguments& arguments, Globals& globals) {
    jobs::BatchRequest& options = arguments.options;
    if (arguments.folder.empty() && !options.check)
        throw UsageError("--output is missing: the folder of the results");
    options.run.shard = jobs::shardOf(options.shard);
    options.run.processes = static_cast<std::size_t>(globals.threads);
    enterFolderOf(arguments);
    if (options.check)
        check(arguments, globals);
    else if (options.status || options.merge)
        survey(arguments, globals);
    else
        run(arguments, globals);
}

constexpr ArgumentRow batchArguments[] = {
    required("MANIFEST", at<&BatchArguments::manifest>,
             "JSON lines, each a command, its input and its options (docs/reference/batch.md)",
             {.files = Files::read, .dash = ""}),
    optionalOutput(at<&BatchArguments::folder>,
                   "Folder of the results, one folder for each item in its items/",
                   {.files = Files::folder}),
};

}  // namespace

CommandRows batchRows() {
    return {batchArguments, {jobs::batchOptions().rows}};
}

void addBatch(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<BatchArguments>();
    addArguments(command, batchArguments, *arguments);
    addOptions(command, jobs::batchOptions(), arguments->options);
    command.callback([arguments, &globals] { runBatch(*arguments, globals); });
}

}  // namespace hshfit::cli
