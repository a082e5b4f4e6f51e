#include "grey_colours.h"

#include <brdfs/fit/dispersion.h>
#include <brdfs/fit/parametric_sum.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string_view>
#include <vector>

namespace hshfit::jobs {
namespace {

bool areColoured(const brdfs::FitSamples& samples) {
    constexpr double least = 0.01;
    std::vector<double> sums;
    for (std::size_t c = 0; c < samples.channels.count(); ++c) {
        const double* values = samples.values.data() + c * samples.size();
        sums.push_back(std::accumulate(values, values + samples.size(), 0.0));
    }
    const auto [low, high] = std::ranges::minmax(sums);
    return high - low > least * std::abs(high);
}

}  // namespace

std::string greyColours(const brdfs::FitResult& result, const brdfs::FitSamples& samples,
                        const brdfs::FitOptions& options) {
    if (brdfs::namesMetals(options.model) || result.point.channels.empty()) return {};
    const bool dispersed = !options.dispersion.empty();
    const brdfs::ParametricSum sum(options.model, samples.isotropic, 0,
                                   result.point.channels.front().coloured);
    std::vector<std::string> names = sum.sharedAlbedos();
    if (dispersed)
        std::erase_if(names, [&](const std::string& name) {
            const auto law = std::ranges::find(result.laws, name, &brdfs::FittedLaw::parameter);
            return law != result.laws.end() && law->coefficients.size() > 1;
        });
    if (names.empty() || !areColoured(samples)) return {};
    const std::string_view why =
        dispersed                  ? "no law over the wavelength, such as free, is stated for it"
        : options.instrument.any() ? "terms of an instrument are fitted with one for all"
                                   : "in this model a channel depends on the colours of the others";
    return fmt::format("{} is one number for all channels: {}", fmt::join(names, ", "), why);
}

}  // namespace hshfit::jobs
