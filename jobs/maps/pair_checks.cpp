#include "pair_checks.h"

#include <hshfit/each_in_parallel.h>

#include <array>
#include <cmath>
#include <utility>

namespace hshfit::jobs {
namespace {

constexpr SpreadOptions pairsOfTexel{.incoming = 64};
/// Texels of level 0 of which a texel of another level is the mean here.
constexpr std::size_t mostPartsOfPairs = 64;

Direction directionAt(const double* values) {
    return {values[0], values[1], values[2]};
}

}  // namespace

PairChecks::PairChecks(ParameterMaps& maps, const std::vector<LevelSize>& levels,
                       std::vector<TexelPlace> places, Processes& processes)
    : places_(std::move(places)), processes_(processes), mine_(processes.share(places_.size())) {
    const std::vector<TexelPlace> own(places_.begin() + static_cast<std::ptrdiff_t>(mine_.first),
                                      places_.begin() + static_cast<std::ptrdiff_t>(mine_.last));
    const std::vector<SpecShares> specs = brdfsOfTexels(maps, levels, own, mostPartsOfPairs);
    references_.resize(own.size());
    eachInParallel(own.size(), [&](std::size_t k) {
        references_[k] =
            std::make_unique<PairReference>(*openShares(specs[k]), spreadPairs(pairsOfTexel));
    });
}

PairChecks::~PairChecks() = default;

TexelPairErrors PairChecks::errorsOf(
    const std::function<std::unique_ptr<Brdf>(std::size_t)>& at) const {
    enum : std::size_t { log, logError, mirror, largest, wi, wo = wi + 3, albedo = wo + 3, off };
    constexpr std::size_t values = off + 1;
    std::vector<double> all(places_.size() * values);
    eachInParallel(references_.size(), [&](std::size_t k) {
        const PairReference& reference = *references_[k];
        const std::size_t texel = mine_.first + k;
        const PairSummary summary = summaryOf(reference.pairs(), reference.errorsOf(*at(texel)));
        const Direction &in = summary.at.wi, &out = summary.at.wo;
        const std::array<double, values> found{
            summary.meanLog.value,
            summary.meanLog.error,
            summary.zones[static_cast<std::size_t>(PairZone::mirror)].value,
            summary.maximum,
            in.x,
            in.y,
            in.z,
            out.x,
            out.y,
            out.z,
            summary.albedo.value,
            summary.albedo.error};
        std::ranges::copy(found, all.begin() + static_cast<std::ptrdiff_t>(texel * values));
    });
    gatherValues(processes_, places_.size(), all);
    TexelPairErrors result{.texels = places_.size()};
    const auto count = static_cast<double>(places_.size());
    double variance = 0;
    for (std::size_t k = 0; k < places_.size(); ++k) {
        const double* texel = all.data() + k * values;
        result.meanLog += texel[log] / count;
        variance += texel[logError] * texel[logError];
        result.mirror += texel[mirror] / count;
        if (k == 0 || texel[log] > result.worstLog) {
            result.worstLog = texel[log];
            result.worstAt = places_[k];
        }
        if (k == 0 || texel[largest] > result.largest) {
            result.largest = texel[largest];
            result.pair = {directionAt(texel + wi), directionAt(texel + wo)};
            result.largestAt = places_[k];
        }
        if (k == 0 || texel[albedo] > result.albedo) {
            result.albedo = texel[albedo];
            result.albedoUncertainty = texel[off];
            result.albedoAt = places_[k];
        }
    }
    if (!places_.empty()) result.uncertainty = std::sqrt(variance) / count;
    return result;
}

}  // namespace hshfit::jobs
