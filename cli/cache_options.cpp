#include "cache_options.h"
#include "within.h"

#include <hshfit/error.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace hshfit::cli {
namespace {

struct Term {
    const char* name;
    bool CacheOptions::*member;
};
constexpr Term terms[] = {
    {"gradient-limit", &CacheOptions::gradientLimit},
    {"neighbour-clamping", &CacheOptions::neighbourClamping},
    {"error-control", &CacheOptions::errorControl},
};

Gradient gradientOf(const std::string& name) {
    if (name == "none") return Gradient::none;
    return name == "hit-points" ? Gradient::hitPoints : Gradient::strata;
}

}  // namespace

void addCacheOptions(CLI::App& command, CacheArguments& arguments) {
    CacheOptions& options = arguments.options;
    std::vector<std::string> names;
    for (const Term& term : terms) names.emplace_back(term.name);
    const auto add = [&](CLI::Option* option) {
        arguments.all.push_back(option->group("Radiance cache"));
    };
    add(command.add_option("--basis", options.choice.basis, "Basis of incident light")
            ->capture_default_str());
    add(command.add_option("--order", options.choice.order, "Its highest order")
            ->capture_default_str());
    add(command
            .add_option("--loss", options.choice.loss,
                        "Share of the energy of f cos(theta) that a material may lose; it gets the "
                        "lowest order within, and is sampled if there is none")
            ->check(within(jobs::bounds::cacheLoss))
            ->capture_default_str());
    add(command
            .add_option("--choose-by", arguments.choice,
                        "Records or sampling for a material that has coefficients. cost: the way "
                        "with less predicted CPU time at equal error; loss: always records")
            ->check(CLI::IsMember({"cost", "loss"}))
            ->capture_default_str());
    add(command.add_option("--rays", options.rays, "Rays of a record, at most")
            ->check(within(jobs::bounds::cacheRays))
            ->capture_default_str());
    add(command.add_option("--accuracy", options.accuracy, "Reach of records: a of Eq. 23")
            ->capture_default_str());
    add(command
            .add_option("--least-reach", options.leastReach,
                        "Least reach of a record, as a share of the picture's height there")
            ->check(CLI::Range(0.0, 1.0))
            ->capture_default_str());
    add(command
            .add_option("--direct", arguments.direct,
                        "sampled: direct light as with paths; gathered: by the rays of records")
            ->check(CLI::IsMember({"sampled", "gathered"}))
            ->capture_default_str());
    add(command
            .add_option("--gradient", arguments.gradient,
                        "none, hit-points (the paper's), strata (sees what comes into sight)")
            ->check(CLI::IsMember({"none", "hit-points", "strata"}))
            ->capture_default_str());
    add(command
            .add_option("--without", arguments.without,
                        fmt::format("Leave out {}: names with commas", fmt::join(names, ", ")))
            ->delimiter(',')
            ->check(CLI::IsMember(names)));
    add(command.add_flag("--published", arguments.published,
                         "Gradients and spacing of the paper of 2004"));
    add(command
            .add_option("--surface-points", options.surfacePoints,
                        "Points that pass on further bounces between diffuse surfaces")
            ->check(CLI::Range(0, 1 << 24))
            ->capture_default_str());
    add(command.add_option("--surface-rays", options.surfaceRays, "Rays of each of them")
            ->check(CLI::Range(4, 1 << 24))
            ->capture_default_str());
    add(command.add_option("--memory", arguments.megabytes, "Megabytes of records, at most")
            ->check(CLI::Range(0.0, 1e6))
            ->capture_default_str());
}

CacheOptions cacheOptionsOf(const CacheArguments& arguments) {
    CacheOptions options = arguments.options;
    options.direct = arguments.direct == "gathered" ? DirectLight::gathered : DirectLight::sampled;
    options.gradient = gradientOf(arguments.gradient);
    options.mostBytes = static_cast<std::size_t>(arguments.megabytes * 1e6);
    if (arguments.published) options.asPublished();
    const auto leavesOut = [&](const char* name) {
        return std::ranges::find(arguments.without, name) != arguments.without.end();
    };
    if (leavesOut("gradient-limit") && options.errorControl && !leavesOut("error-control")) {
        throw UsageError(
            "--without gradient-limit changes nothing beside error control; leave that out too: "
            "--without gradient-limit,error-control");
    }
    for (const std::string& name : arguments.without) {
        const auto* term = std::ranges::find(terms, name, &Term::name);
        options.*(term->member) = false;
    }
    return options;
}

void refuseCacheOptions(const CacheArguments& arguments, const std::string& method) {
    for (const CLI::Option* option : arguments.all) {
        if (option->count() > 0) {
            throw UsageError(fmt::format("{} is for --method radiance-cache, not {}",
                                         option->get_name(), method));
        }
    }
}

}  // namespace hshfit::cli
