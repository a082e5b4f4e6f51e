#include "stress.h"

#include <jobs/source/source.h>

#include <fmt/format.h>

#include <memory>

namespace hshfit::jobs {
namespace {

/// From Lambert to a mirror, as exponents and as roughness.
std::vector<std::string> defaultLobes() {
    std::vector<std::string> specs = {"lambert"};
    for (int e = 0; e <= 6; ++e) specs.push_back(fmt::format("phong:exponent=1e{}", e));
    for (int e = 0; e <= 4; ++e) specs.push_back(fmt::format("ggx:alpha=1e-{},F0=1", e));
    for (int e = 0; e <= 4; ++e) specs.push_back(fmt::format("ward:ax=1e-{0},ay=1e-{0}", e));
    return specs;
}

}  // namespace

stability::StressReport stress(const std::string& output, const StressOptions& options,
                               const Listener& listener) {
    std::vector<std::unique_ptr<Brdf>> opened;
    std::vector<const Brdf*> lobes;
    for (const std::string& spec : options.lobes.empty() ? defaultLobes() : options.lobes) {
        opened.push_back(openBrdf(spec));
        lobes.push_back(opened.back().get());
    }
    stability::StressReport report =
        stability::stress(bases::select(options.bases), lobes,
                          {.maxOrder = options.maxOrder, .progress = listener.part("stress")});
    const std::size_t trials =
        options.trials.value_or(options.lobes.empty() ? brdfs::RandomCasesOptions{}.count : 0);
    if (trials > 0) {
        report.triedTolerance = options.tolerance;
        report.statedErrors = stability::summarise(stability::tryErrors(
            brdfs::randomCases({.count = trials, .seed = options.seed, .only = options.of}),
            {.tolerance = options.tolerance,
             .progress = listener.part("trials of stated errors")}));
    }
    if (!output.empty()) stability::writeStress(report, output);
    return report;
}

}  // namespace hshfit::jobs
