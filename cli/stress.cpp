#include "command.h"

#include <hshfit/error.h>
#include <hshfit/stability/stress.h>

#include <brdfs/catalog.h>
#include <brdfs/random_cases.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <optional>

namespace hshfit::cli {
namespace {

struct StressArguments {
    std::vector<std::string> lobes;
    std::string bases = "all", output;
    int maxOrder = stability::StressOptions{}.maxOrder;
    std::optional<std::size_t> trials;
    std::uint64_t seed = brdfs::RandomCasesOptions{}.seed;
};

/// From Lambert to a mirror, as exponents and as roughness.
std::vector<std::string> defaultLobes() {
    std::vector<std::string> specs = {"lambert"};
    for (int e = 0; e <= 6; ++e) specs.push_back(fmt::format("phong:exponent=1e{}", e));
    for (int e = 0; e <= 4; ++e) specs.push_back(fmt::format("ggx:alpha=1e-{},F0=1", e));
    for (int e = 0; e <= 4; ++e) specs.push_back(fmt::format("ward:ax=1e-{0},ay=1e-{0}", e));
    return specs;
}

void runStress(const StressArguments& arguments, const Globals& globals) {
    std::vector<std::unique_ptr<Brdf>> opened;
    std::vector<const Brdf*> lobes;
    for (const std::string& spec : arguments.lobes.empty() ? defaultLobes() : arguments.lobes) {
        opened.push_back(brdfs::open(spec));
        lobes.push_back(opened.back().get());
    }
    stability::StressReport report;
    {
        Progress progress(globals, "stress");
        report =
            stability::stress(bases::select(arguments.bases), lobes,
                              {.maxOrder = arguments.maxOrder, .progress = progress.callback()});
    }
    const std::size_t trials =
        arguments.trials.value_or(arguments.lobes.empty() ? brdfs::RandomCasesOptions{}.count : 0);
    if (trials > 0) {
        Progress progress(globals, "trials of stated errors");
        report.statedErrors = stability::summarise(
            stability::tryErrors(brdfs::randomCases({.count = trials, .seed = arguments.seed}),
                                 {.progress = progress.callback()}));
    }
    if (!arguments.output.empty()) stability::writeStress(report, arguments.output);
    printText(globals.json ? stability::stressJson(report) : stability::stressMarkdown(report));
}

}  // namespace

void addStress(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<StressArguments>();
    command.add_option("SPEC", arguments->lobes,
                       "Lobes to project (default: Lambert, and Phong, GGX and Ward to a mirror)");
    command.add_option("--bases", arguments->bases, "all, or names from hshfit list bases")
        ->capture_default_str();
    command.add_option("--max-order", arguments->maxOrder, "Bands to look at")
        ->check(CLI::Range(2, 1000))
        ->capture_default_str();
    command.add_option("--trials", arguments->trials,
                       "Random projections over the catalog whose stated errors are tried "
                       "(default: 2000, or none if lobes are given)");
    command.add_option("--seed", arguments->seed, "Of the random projections")
        ->capture_default_str();
    command.add_option("-o,--output", arguments->output,
                       "Folder for stress.json, stress.md and stress.csv, made if absent");
    command.callback([arguments, &globals] { runStress(*arguments, globals); });
}

}  // namespace hshfit::cli
