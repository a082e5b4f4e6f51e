#include <hshfit/representation/halfway/internal/halfway_limit.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <limits>

namespace hshfit::inline representation::inline halfway {
namespace {

struct Grid {
    std::size_t alongA, alongB;
};
/// Where not reciprocal, as many along a on either side.
constexpr std::array grids{Grid{1, 1}, Grid{3, 3},  Grid{5, 4},  Grid{7, 6},
                           Grid{9, 7}, Grid{12, 8}, Grid{16, 8}, Grid{20, 10}};
constexpr std::array ridges{1.0, 0.3, 0.1, 0.05, 0.02};
constexpr double mostLoss = 1.02, mostTaken = 0.03;

/// The greatest share of the albedo of a channel that is lost.
double takenBy(const HalfwayAlbedo& albedo, const std::vector<double>& whole,
               const std::vector<double>& rest) {
    const std::size_t channels = albedo.channels();
    double most = 0;
    for (std::size_t c = 0; c < channels; ++c) {
        double before = 0, after = 0;
        for (std::size_t s = 0; s < albedo.strata(); ++s) {
            // An excess of the expansion over f may be cut off without a cost.
            const std::size_t at = s * channels + c;
            before += albedo.shares[s] * std::min(whole[at], albedo.targets[at]);
            after += albedo.shares[s] * std::min(rest[at], albedo.targets[at]);
        }
        if (before > 0) most = std::max(most, 1 - after / before);
    }
    return most;
}

}  // namespace

std::vector<double> capsAt(const EnvelopeArray& limit, bool reciprocal,
                           const std::vector<EnvelopePoint>& places) {
    const std::size_t channels = limit.logs.shape.back();
    const HalfwayEnvelope envelope(limit, channels, reciprocal, "");
    std::vector<double> caps;
    for (const EnvelopePoint& place : places) {
        const HalfwayEnvelope::Mix mix = envelope.mixAt(place);
        for (std::size_t c = 0; c < channels; ++c) caps.push_back(envelope.logAt(mix, c));
    }
    return caps;
}

EnvelopeArray chooseLimit(const HalfwayTerms& terms, const HalfwayBounds& bounds,
                          const HalfwaySamples& left, const HalfwayAlbedo& albedo,
                          const HalfwayValues& values) {
    const std::vector<double> sums = halfwaySums(terms, left, values);
    const std::vector<double> f = expansionAt(terms, albedo, values);
    const std::vector<double> whole = albedoOf(albedo, f, {});
    const double before = halfwayLoss(left, sums);
    EnvelopeArray best;
    double least = std::numeric_limits<double>::infinity();
    for (const Grid& grid : grids) {
        std::array<EnvelopeArray, ridges.size()> tried;
        std::array<double, ridges.size()> costs{};
        const std::size_t count = grid.alongA == 1 ? 1 : ridges.size();
        tbb::parallel_for(std::size_t{0}, count, [&](std::size_t k) {
            const std::size_t along = bounds.reciprocal ? grid.alongA : 2 * grid.alongA - 1;
            tried[k] = {fitEnvelope(bounds, along, grid.alongB, ridges[k]), ridges[k]};
            const double loss =
                halfwayLoss(left, sums, capsAt(tried[k], bounds.reciprocal, left.places));
            const std::vector<double> rest =
                albedoOf(albedo, f, capsAt(tried[k], bounds.reciprocal, albedo.places));
            const double excess = before > 0 ? loss / before - 1 : (loss > 0 ? 1e9 : 0);
            costs[k] = std::max(excess / (mostLoss - 1), takenBy(albedo, whole, rest) / mostTaken);
        });
        for (std::size_t k = 0; k < count; ++k) {
            if (!(costs[k] < least)) continue;
            least = costs[k];
            best = std::move(tried[k]);
        }
        if (least <= 1) break;
    }
    return best;
}

}  // namespace hshfit::inline representation::inline halfway
