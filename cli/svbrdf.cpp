#include "command.h"
#include "command_rows.h"
#include "job_options.h"
#include "svbrdf_filtered.h"

#include <hshfit/error.h>
#include <hshfit/files/output_rule.h>
#include <hshfit/percent.h>
#include <hshfit/pictures/poor.h>

#include <jobs/common/clock.h>
#include <jobs/maps/map_answers.h>
#include <jobs/maps/map_options.h>
#include <jobs/maps/map_processes.h>
#include <jobs/source/quality.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdlib>
#include <variant>

namespace hshfit::cli {
namespace {

struct SvbrdfArguments {
    std::string description, output;
    jobs::MapOptions options;
};

double megabytes(std::size_t bytes) {
    return static_cast<double>(bytes) / 1e6;
}

/// The call that captures more of the poorest lobe, and whether an order that suffices was found;
/// of the form halfway no texel was tried. Empty if none is known.
struct Advice {
    std::string call;
    bool isTried = false;
};

Advice adviceOf(const jobs::Svbrdf& done) {
    const std::string call =
        fmt::format("hshfit svbrdf {} -o {} --force", done.description, done.folder);
    if (done.betterOrder) return {fmt::format("{} --order {}", call, *done.betterOrder), true};
    return {done.halfwayIsBetter ? call + " --form halfway" : "", false};
}

std::string textOf(const jobs::MapChoice& choice) {
    std::string text = fmt::format(
        "  {:<10} {:>6}  {:>8.4g} bytes a texel{}", choice.form, choice.count, choice.bytesOfTexel,
        choice.sharedBytes > 0 ? fmt::format(" and {:.3g} MB", megabytes(choice.sharedBytes)) : "");
    if (choice.errors) {
        text += fmt::format(
            ", error {} mean, {} of 99 %, {} at most", percent(choice.errors->mean, 2),
            percent(choice.errors->percentile99, 2), percent(choice.errors->maximum, 2));
    }
    if (choice.pairs) {
        const jobs::TexelPairErrors& pairs = *choice.pairs;
        text += fmt::format(
            "; log error {:.2g}, {:.2g} at most, albedo off by {:.2g} +- {:.1g} at most",
            pairs.meanLog, pairs.worstLog, pairs.albedo, pairs.albedoUncertainty);
    }
    return text + "\n";
}

std::string choicesText(const std::vector<jobs::MapChoice>& choices) {
    std::string text = "forms; errors over sampled texels are relative to the norm of a texel";
    if (const auto& pairs = choices.front().pairs) {
        text += fmt::format("; log errors are against the BRDFs of {} texels, +- {:.1g}",
                            pairs->texels, pairs->uncertainty);
    }
    text += ":\n";
    for (const jobs::MapChoice& choice : choices) text += textOf(choice);
    return text;
}

std::string levelText(const jobs::Svbrdf& done, std::size_t level) {
    const LevelErrors& errors = done.errors[level];
    std::string text = fmt::format("  level {:>2}: {} x {}", level, done.levels[level].width,
                                   done.levels[level].height);
    if (done.form != "outgoing") {
        text += fmt::format(", error of the form {} mean, {} at most at ({}, {})",
                            percent(errors.mean, 2), percent(errors.maximum, 2), errors.column,
                            errors.row);
    }
    for (const jobs::LevelCheck& check : done.checks) {
        if (check.level != level) continue;
        text += fmt::format(
            "; against samples of the reflectance {} mean, {} at most (averaged parameters: {}, "
            "{})",
            percent(check.stored, 2), percent(check.storedMaximum, 2), percent(check.parameters, 2),
            percent(check.parametersMaximum, 2));
    }
    if (level < done.levelPairs.size()) {
        const jobs::TexelPairErrors& pairs = done.levelPairs[level];
        text += fmt::format("; {}: log error {:.2g}, {:.2g} at most at ({}, {})",
                            done.library ? "texels" : "materials", pairs.meanLog, pairs.worstLog,
                            pairs.worstAt.column, pairs.worstAt.row);
    }
    return text + "\n";
}

std::string textOf(const jobs::MapLibrary& library) {
    std::string text = library.given.empty()
                           ? fmt::format("library of {} texels of the map", library.materials)
                           : fmt::format("library {}", library.given);
    if (library.pictures > 0) {
        text += fmt::format("; spheres of {} texels: FLIP {:.3f}, {:.3f} at most at ({}, {})",
                            library.pictures, library.flip, library.worstFlip,
                            library.worstAt.column, library.worstAt.row);
    }
    if (!library.poor.empty()) text += "; poor: " + library.poor;
    return text + "\n";
}

/// The time of the whole job, and its parts.
std::string timesText(const jobs::Svbrdf& done, double total) {
    return fmt::format(
        "{:.1f} s in all: {:.1f} s for {}, {:.1f} s for writing, {:.1f} s for checks "
        "of what was written\n",
        total, done.tableSeconds,
        done.library ? "maps and the library" : "maps, the table of lobes and measuring of forms",
        done.seconds, std::max(0.0, total - done.tableSeconds - done.seconds));
}

std::string textOf(const jobs::Svbrdf& done, double total) {
    std::string text = fmt::format("{}: {} x {} texels of {}", done.description, done.width,
                                   done.height, done.model);
    if (!done.outgoing.empty()) text += fmt::format(", {} outgoing directions", done.outgoing);
    if (!done.lobes.empty()) text += fmt::format("; lobes {}", fmt::join(done.lobes, ", "));
    if (!done.axes.empty()) {
        text += fmt::format(" at {} nodes over {}, error {}", done.tableNodes,
                            fmt::join(done.axes, ", "), percent(done.tableError, 2));
    }
    text += "\n";
    if (done.fit.texels > 0) {
        text += fmt::format(
            "coefficients are off the samples of {} texels by {} in the mean, {} at most at ({}, "
            "{})\n",
            done.fit.texels, percent(done.fit.mean, 2), percent(done.fit.maximum, 2),
            done.fit.column, done.fit.row);
    }
    if (!done.leastCaptured.empty()) {
        const Advice advice = adviceOf(done);
        text += fmt::format(
            "the basis captures {} of the energy of {}, the least of all lobes{}{}\n",
            percent(done.captured, 2), done.leastCaptured,
            done.captured < PoorBounds{}.captured && done.form != "halfway" ? ": poor" : "",
            advice.call.empty() ? ""
                                : (advice.isTried ? "; better: " : "; to try: ") + advice.call);
    }
    if (done.choices.size() > 1 || done.choices.front().pairs) text += choicesText(done.choices);
    if (done.library) text += textOf(*done.library);
    text += fmt::format(
        "{}{}, {:.4g} MB, written in {:.1f} s ({:.3g} texels a second{})\n", done.form,
        done.count > 0 ? fmt::format(" {}", done.count) : "", megabytes(done.bytes), done.seconds,
        done.rate,
        done.kernelRate > 0 ? fmt::format("; the bare kernel {:.3g}", done.kernelRate) : "");
    text += timesText(done, total);
    for (std::size_t level = 0; level < done.levels.size(); ++level) text += levelText(done, level);
    std::size_t materials = 0;
    for (const std::string& file : done.files) {
        // The first of the materials of the form halfway stands for all.
        if (file.find("/material_") != std::string::npos && ++materials > 1) continue;
        text += fmt::format("  {}\n", file);
    }
    if (materials > 1) text += fmt::format("  … {} materials in all\n", materials);
    return text;
}

/// Several processes that a launcher started would each make the whole map, unless they share it.
void refuseLaunchers() {
    if (jobs::processesOfMaps().count() > 1) return;
    for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"}) {
        const char* text = std::getenv(name);
        const long count = text ? std::strtol(text, nullptr, 10) : 1;
        if (count > 1) {
            throw UsageError(fmt::format(
                "{} processes were started ({}), and each would make the whole map; start "
                "hshfit-mpi svbrdf with that MPI (built with -DHSHFIT_MPI=ON), or one process",
                count, name));
        }
    }
}

void print(const jobs::Svbrdf& done, double total, const Globals& globals) {
    if (!globals.json) return printText(textOf(done, total));
    nlohmann::ordered_json json = jobs::svbrdfJson(done);
    json["seconds"]["total"] = total;
    if (const Advice advice = adviceOf(done); !advice.call.empty())
        json["captured"][advice.isTried ? "better" : "to_try"] = advice.call;
    printJson(json);
}

void print(const jobs::FilteredMapAnswer& done, double, const Globals& globals) {
    if (globals.json) return printJson(jobs::filteredMapJson(done));
    printText(cli::textOf(done));
}

void runSvbrdf(SvbrdfArguments& arguments, const CLI::App& command, const Globals& globals) {
    jobs::MapOptions& options = arguments.options;
    // Also where a file of a valid set was taken away.
    options.texels.force = outputRule().replace;
    refuseLaunchers();
    options.form = jobs::mapFormOf(arguments.description, options);
    if (const auto given =
            misplacedOption(command, jobs::mapOptions().rows, jobs::mapFormBit(options.form)))
        throw UsageError(fmt::format("{} is for --form {}, not for {}", given->name,
                                     jobs::mapFormNames(given->row->inputs), options.form));
    const auto start = jobs::Clock::now();
    const auto done =
        jobs::makeMap(arguments.description, arguments.output, options, listenerFor(globals));
    const double total = jobs::secondsSince(start);
    std::visit([&](const auto& made) { print(made, total, globals); }, done);
}

constexpr ArgumentRow svbrdfArguments[] = {
    required("DESCRIPTION", at<&SvbrdfArguments::description>,
             "A model and its parameters, numbers or maps, as JSON",
             {.files = Files::read, .dash = ".json"}),
    requiredOutput(at<&SvbrdfArguments::output>,
                   "Folder for material.ktx2, material.json, errors.png and, of harmonics, "
                   "harmonics.ktx2, of halfway, the materials, of library, material.library",
                   {.files = Files::folder}),
};

}  // namespace

CommandRows svbrdfRows() {
    return {svbrdfArguments, {jobs::mapOptions().rows}};
}

void addSvbrdf(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<SvbrdfArguments>();
    addArguments(command, svbrdfArguments, *arguments);
    addOptions(command, jobs::mapOptions(), arguments->options);
    command.callback([arguments, &command, &globals] { runSvbrdf(*arguments, command, globals); });
}

}  // namespace hshfit::cli
