#include <brdfs/fit/instrument/quadratures.h>

#include <brdfs/fit/fit_result.h>
#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>

namespace hshfit::brdfs {
namespace {

double statedAt(const FitSamples& samples, std::size_t k, const Instrument& instrument) {
    return instrument.offset.value + instrument.dark.value * overCosines(instrument.darkOver,
                                                                         samples.wiZ[k],
                                                                         samples.wo[k].z);
}

}  // namespace

NumericError unsettled(int searches) {
    return NumericError(fmt::format(
        "the quadratures over apertures did not settle in {} searches: each led to a material "
        "that needs finer ones",
        searches));
}

bool Quadratures::refine(const Brdf& material, const FitSamples& samples,
                         const Instrument& instrument) {
    const PatchSearch search = searchLevels(material, samples, instrument, levels);
    bool same = true;
    for (std::size_t k = 0; k < samples.size(); ++k)
        same = same && search.levels[k].source == levels[k].source &&
               search.levels[k].detector == levels[k].detector;
    if (same && search.exhausted)
        throw NumericError(fmt::format(
            "the average over the apertures at sample {} changes by {:.2g} with the next finer "
            "quadrature, expected at most {:.2g}: the lobe that was fitted is too narrow for this "
            "aperture",
            search.sample + 1, search.change, instrument.tolerance));
    levels = search.levels;
    averageChange = search.change;
    if (instrument.stray.from == InstrumentTerm::From::nothing) return same;
    strayChange = veil ? veilChange(*veil, material, instrument.tolerance) : 1;
    if (strayChange <= instrument.tolerance) return same;
    veil = veilOf(material, samples, instrument.tolerance);
    return false;
}

void Quadratures::describe(const FitSamples& averaged, FittedInstrument& result) const {
    result.averageChange = averageChange;
    result.strayChange = strayChange;
    if (!averaged.sums) return;
    result.nodes = averaged.sums->size();
    for (const NodeSums::Row& row : averaged.sums->rows)
        result.mostNodes = std::max(result.mostNodes, row.nodes);
}

FitSamples withoutStated(const FitSamples& samples, const Instrument& instrument) {
    FitSamples result = samples;
    for (std::size_t v = 0; v < result.values.size(); ++v)
        result.values[v] -= statedAt(samples, v % samples.size(), instrument);
    return result;
}

std::vector<double> statedReadings(const Brdf& material, const FitSamples& samples,
                                   const Instrument& instrument) {
    Quadratures quadratures;
    quadratures.levels.resize(samples.size());
    quadratures.refine(material, samples, instrument);
    const std::vector<double> f =
        valuesOf(material, averaged(samples, instrument, quadratures.levels));
    const std::vector<double> mix = slitMatrix(instrument.slit, samples.channels);
    const std::size_t channels = samples.channels.count(), count = samples.size();
    std::vector<double> result(f.size(), 0);
    for (std::size_t c = 0; c < channels; ++c)
        for (std::size_t k = 0; k < count; ++k) {
            for (std::size_t from = 0; from < channels; ++from)
                result[c * count + k] += mix[c * channels + from] * f[from * count + k];
            result[c * count + k] += statedAt(samples, k, instrument);
        }
    return result;
}

}  // namespace hshfit::brdfs
