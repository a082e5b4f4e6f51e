#include "fit_instrument.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace hshfit::cli {

void addInstrumentOptions(CLI::App& command, brdfs::InstrumentText& instrument) {
    command.add_option("--source-aperture", instrument.source,
                       "Directions of the source about the nominal one: cone:HALF or "
                       "rectangle:HALFxHALF (along the polar angle, across), degrees");
    command.add_option("--detector-aperture", instrument.detector,
                       "Directions of the detector, likewise");
    command
        .add_option("--aperture-tolerance", instrument.tolerance,
                    "Relative error of averages over apertures")
        ->capture_default_str();
    command.add_option("--bandwidth", instrument.bandwidth,
                       "Slit of data with wavelengths: box:NM, triangle:NM or gauss:NM, full width "
                       "at half maximum");
    command.add_option("--offset", instrument.offset,
                       "What the instrument adds to f, 1/sr: a number, or fit");
    command.add_option(
        "--dark", instrument.dark,
        "The same over a cosine by which readings are divided: a number, or fit, with "
        ":out (default), :in or :both");
    command.add_option("--stray", instrument.stray,
                       "Share of light that reaches the detector from all of the hemisphere: a "
                       "number, or fit");
    command.add_option("--scan-scale", instrument.scale,
                       "A scale for each of the --scans: the standard deviation about 1 that is "
                       "expected (2%), or fit, relative to the first");
    command.add_option("--incidence-zero", instrument.incidenceZero,
                       "The zero of the angle of incidence is fitted: its standard uncertainty in "
                       "degrees, with :scan for one for each of the --scans (0.05:scan)");
    command.add_option("--detector-zero", instrument.detectorZero,
                       "The zero of the detector's angle, likewise");
}

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
