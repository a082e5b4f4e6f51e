#include "command.h"
#include "svbrdf_filtered.h"
#include "within.h"

#include <hshfit/error.h>
#include <hshfit/files/output_rule.h>
#include <hshfit/percent.h>
#include <hshfit/pictures/poor.h>
#include <hshfit/representation/forms/form.h>

#include <jobs/maps/map_answers.h>
#include <jobs/maps/map_processes.h>
#include <jobs/maps/svbrdf.h>
#include <jobs/source/quality.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <cstdlib>

namespace hshfit::cli {
namespace {

struct SvbrdfArguments {
    std::string description, output;
    std::string mips = "reflectance", writes = "direct", halfway = "8,4,3";
    std::size_t memoryMegabytes = 1024;
    int harmonics = 0;
    double error = 0;
    jobs::SvbrdfOptions options;
};

double megabytes(std::size_t bytes) {
    return static_cast<double>(bytes) / 1e6;
}

/// The call that captures more of the poorest lobe; empty if none is known.
std::string betterCall(const jobs::Svbrdf& done) {
    const std::string call =
        fmt::format("hshfit svbrdf {} -o {} --force", done.description, done.folder);
    if (done.betterOrder) return fmt::format("{} --order {}", call, *done.betterOrder);
    return done.halfwayIsBetter ? call + " --form halfway" : "";
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
    if (!done.levelPairs.empty()) {
        const jobs::TexelPairErrors& pairs = done.levelPairs[level];
        text += fmt::format("; materials: log error {:.2g}, {:.2g} at most at ({}, {})",
                            pairs.meanLog, pairs.worstLog, pairs.worstAt.column, pairs.worstAt.row);
    }
    return text + "\n";
}

std::string textOf(const jobs::Svbrdf& done) {
    std::string text =
        fmt::format("{}: {} x {} texels of {}, {} outgoing directions", done.description,
                    done.width, done.height, done.model, done.outgoing);
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
        const std::string better = betterCall(done);
        text += fmt::format(
            "the basis captures {} of the energy of {}, the least of all lobes{}{}\n",
            percent(done.captured, 2), done.leastCaptured,
            done.captured < PoorBounds{}.captured && done.form != "halfway" ? ": poor" : "",
            better.empty() ? "" : "; better: " + better);
    }
    if (done.choices.size() > 1 || done.choices.front().pairs) text += choicesText(done.choices);
    text +=
        fmt::format("{}{}, {:.4g} MB, {:.1f} s ({:.3g} texels a second; the bare kernel {:.3g})\n",
                    done.form, done.count > 0 ? fmt::format(" {}", done.count) : "",
                    megabytes(done.bytes), done.seconds, done.rate, done.kernelRate);
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

/// Options that were given, but belong to other forms.
void refuseOptions(const CLI::App& command, const std::string& form,
                   std::initializer_list<const char*> options) {
    for (const char* option : options) {
        if (command.count(option) > 0)
            throw UsageError(fmt::format("{} does not belong to --form {}", option, form));
    }
}

void runFiltered(const SvbrdfArguments& arguments, const CLI::App& command,
                 const Globals& globals) {
    const jobs::SvbrdfOptions& from = arguments.options;
    refuseOptions(command, from.form,
                  {"--basis", "--order", "--outgoing", "--cosine", "--tolerance", "--rank",
                   "--clusters", "--halfway", "--memory", "--writes"});
    if (from.form == "ellipse") refuseOptions(command, from.form, {"--harmonics"});
    jobs::FilteredMapOptions options{.form = from.form,
                                     .harmonics = arguments.harmonics,
                                     .precision = from.precision,
                                     .mips = from.mips,
                                     .force = from.force,
                                     .checks = static_cast<int>(from.checks)};
    if (command.count("--error") > 0) options.error = arguments.error;
    runFilteredMap(arguments.description, arguments.output, options, globals);
}

void runSvbrdf(SvbrdfArguments& arguments, const CLI::App& command, const Globals& globals) {
    jobs::SvbrdfOptions& options = arguments.options;
    if (options.form.empty())
        options.form = jobs::turnsTexels(arguments.description) ? "filtered" : "outgoing";
    options.mips = arguments.mips == "reflectance";
    options.memory = arguments.memoryMegabytes << 20;
    options.pastPageCache = arguments.writes == "direct";
    options.halfway = parseHalfway(arguments.halfway);
    // Also where a file of a valid set was taken away.
    options.force = outputRule().replace;
    refuseLaunchers();
    if (options.precision == "half") options.precision = "float16";
    if (jobs::isFilteredForm(options.form)) return runFiltered(arguments, command, globals);
    refuseOptions(command, options.form, {"--harmonics"});
    if (options.form != "halfway") refuseOptions(command, options.form, {"--halfway"});
    if (command.count("--error") > 0) options.error = arguments.error;
    if (options.rank > 0 && options.form == "outgoing")
        throw UsageError("--rank belongs to --form low-rank, clusters or halfway");
    const jobs::Svbrdf done =
        jobs::svbrdf(arguments.description, arguments.output, options, listenerFor(globals));
    if (globals.json) {
        nlohmann::ordered_json json = jobs::svbrdfJson(done);
        if (const std::string better = betterCall(done); !better.empty())
            json["captured"]["better"] = better;
        return printJson(json);
    }
    printText(textOf(done));
}

}  // namespace

void addSvbrdf(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<SvbrdfArguments>();
    jobs::SvbrdfOptions& options = arguments->options;
    options.form.clear();  // by the description
    command
        .add_option("DESCRIPTION", arguments->description,
                    "A model and its parameters, numbers or maps, as JSON")
        ->required();
    command
        .add_option("-o,--output", arguments->output,
                    "Folder for material.ktx2, material.json, errors.png and, of harmonics, "
                    "harmonics.ktx2, of halfway, the materials")
        ->required();
    command
        .add_option("--form", options.form,
                    "outgoing: all coefficients; low-rank: weights of shared shapes; clusters: "
                    "the index of a shared material; halfway: likewise, of a material in the "
                    "halfway form. Of turned texels: ellipse or harmonics of the "
                    "normals' distribution; filtered: the cheaper one within --error (default: "
                    "filtered where the description has normals or directions, else outgoing)")
        ->check(CLI::IsMember(
            std::vector<std::string>(std::begin(jobs::mapForms), std::end(jobs::mapForms))));
    command.add_option("--basis", options.basis, "Basis over incoming directions")
        ->capture_default_str();
    command.add_option("--order", options.order, "Bands of the basis")
        ->check(within(jobs::bounds::mapOrder))
        ->capture_default_str();
    command.add_option("--outgoing", options.outgoing,
                       "Outgoing directions: N elevations, or WxH (default: 8 elevations where all "
                       "texels are isotropic, else 8x8)");
    command.add_flag("--cosine", options.cosine, "Coefficients of f cos(theta_i) instead of f");
    command.add_option("--precision", options.precision, "Numbers of the texture: half or float32")
        ->check(CLI::IsMember({"half", "float16", "float32"}))
        ->default_str("half");
    command
        .add_option("--tolerance", options.tolerance,
                    "Relative error of lobes between the nodes of their table")
        ->check(within(jobs::bounds::mapTolerance))
        ->capture_default_str();
    command.add_option("--rank", options.rank, "Shared shapes (default: by --error)")
        ->check(within(jobs::bounds::mapRank));
    command
        .add_option("--error", arguments->error,
                    "With --form low-rank or clusters: the largest relative error that shared "
                    "shapes may leave in a sampled texel (default: 0.01); with --form filtered or "
                    "harmonics: that of a level against samples (default: 0.1)")
        ->check(within(jobs::bounds::mapError));
    command
        .add_option("--harmonics", arguments->harmonics,
                    "Order of the harmonics of --form harmonics, odd (default: 9, 17 or 33 by "
                    "--error)")
        ->check(within(jobs::bounds::mapHarmonics));
    command
        .add_option("--halfway", arguments->halfway,
                    "Functions along each axis of the materials of --form halfway, as of hshfit "
                    "project")
        ->capture_default_str();
    command
        .add_option("--clusters", options.clusters,
                    "Shared materials of --form clusters or halfway, of each level")
        ->check(within(jobs::bounds::mapClusters))
        ->capture_default_str();
    command
        .add_option("--mips", arguments->mips,
                    "reflectance: levels of averaged reflectance; none: level 0 alone")
        ->check(CLI::IsMember({"reflectance", "none"}))
        ->capture_default_str();
    command
        .add_option("--checks", options.checks,
                    "Texels of each level that are measured against the texels that they stand for")
        ->check(within(jobs::bounds::mapChecks))
        ->capture_default_str();
    command
        .add_option("--memory", arguments->memoryMegabytes,
                    "MiB that bands of the map may take, of each process")
        ->check(within(jobs::bounds::mapMemory))
        ->capture_default_str();
    command
        .add_option("--writes", arguments->writes,
                    "direct: texels go past the page cache, where the file system can; cached: "
                    "through it, for a slow disk or files that are read at once")
        ->check(CLI::IsMember({"direct", "cached"}))
        ->capture_default_str();
    command.add_flag("--force", options.force, "Replace existing files");
    command.callback([arguments, &command, &globals] { runSvbrdf(*arguments, command, globals); });
}

}  // namespace hshfit::cli
