#include "fit_instrument.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace hshfit::cli {

std::string instrumentText(const brdfs::FitResult& result) {
    if (!result.instrument) return {};
    const brdfs::FittedInstrument& fitted = *result.instrument;
    std::string lines;
    if (!fitted.scales.empty()) {
        const auto [low, high] = std::ranges::minmax_element(fitted.scales);
        double squares = 0;
        for (const double scale : fitted.scales) squares += (scale - 1) * (scale - 1);
        const auto number = [&](auto place) { return place - fitted.scales.begin() + 1; };
        lines += fmt::format(
            "  scales of {} scans: {:.4g} (scan {}) to {:.4g} (scan {}), {:.2g} about 1 in "
            "squares\n",
            fitted.scales.size(), *low, number(low), *high, number(high),
            std::sqrt(squares / static_cast<double>(fitted.scales.size())));
    }
    for (const auto& [name, zeros] : {std::pair{"incidence", &fitted.incidenceZeros},
                                      std::pair{"detector", &fitted.detectorZeros}}) {
        if (zeros->size() < 2) continue;
        const auto [low, high] = std::ranges::minmax_element(*zeros);
        lines += fmt::format(
            "  zeros of the angle of {} of {} scans: {:.3g} (scan {}) to {:.3g} degrees (scan "
            "{})\n",
            name, zeros->size(), *low, low - zeros->begin() + 1, *high, high - zeros->begin() + 1);
    }
    if (fitted.instrument.averages())
        lines += fmt::format(
            "  averages over apertures: {} pairs of directions, at most {} for a sample; the next "
            "finer quadrature changes them by at most {:.1e}\n",
            fitted.nodes, fitted.mostNodes, fitted.averageChange);
    return lines;
}

}  // namespace hshfit::cli
