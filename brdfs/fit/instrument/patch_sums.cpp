#include <brdfs/fit/instrument/patch_sums.h>

#include <hshfit/brdf/vectors.h>
#include <hshfit/each_in_parallel.h>
#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace hshfit::brdfs {
namespace {

/// Pairs of nodes of one sample, and of all (56 bytes each).
constexpr std::size_t mostOfOne = std::size_t{1} << 16, mostOfAll = std::size_t{1} << 23;
constexpr std::array<std::size_t, 15> ladder{1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 80, 96, 128};

std::size_t onLadder(double least) {
    for (const std::size_t level : ladder)
        if (static_cast<double>(level) >= least) return level;
    return ladder.back();
}

std::size_t nodesOf(const Instrument& instrument, const PatchLevels& levels) {
    const std::size_t source = instrument.source.finite() ? 4 * levels.source * levels.source : 1,
                      detector =
                          instrument.detector.finite() ? 4 * levels.detector * levels.detector : 1;
    return source * detector;
}

Direction incidentOf(const FitSamples& samples, std::size_t k) {
    return {samples.wiX[k], samples.wiY[k], samples.wiZ[k]};
}

double reachOf(const Aperture& aperture) {
    return aperture.finite() ? std::hypot(aperture.half, aperture.across) : 0;
}

/// The least levels with nodes as close as the narrowest lobe within reach is wide. The half vector
/// turns by half of what one direction does.
PatchLevels levelsOfLobes(const Brdf& brdf, const Direction& wi, const Direction& wo,
                          const Instrument& instrument) {
    const double reach = reachOf(instrument.source) + reachOf(instrument.detector);
    PatchLevels least;
    for (const Lobe& lobe : brdf.lobes(wo)) {
        double away = 0, turn = 1;
        if (lobe.about == Lobe::About::halfway) {
            turn = 0.5;
            away = std::hypot(wi.x + wo.x, wi.y + wo.y) / (wi.z + wo.z);
        } else {
            away = angleBetween(wi, lobe.axis);
        }
        constexpr double near = 4;  // widths
        if (away > turn * reach + near * lobe.width) continue;
        const auto own = [&](const Aperture& aperture) {
            return onLadder(turn * reachOf(aperture) / std::max(lobe.width, 1e-9));
        };
        least.source = std::max(least.source, own(instrument.source));
        least.detector = std::max(least.detector, own(instrument.detector));
    }
    // As far as nodes are allowed.
    while (nodesOf(instrument, least) > mostOfOne) {
        std::size_t& larger = least.source > least.detector ? least.source : least.detector;
        larger = *std::prev(std::ranges::find(ladder, larger));
    }
    return least;
}

/// f of all channels averaged over the patches.
std::vector<double> average(const Brdf& brdf, const Direction& wi, const Direction& wo,
                            const Instrument& instrument, const PatchLevels& levels) {
    const PatchNodes in = patchNodes(instrument.source, wi, levels.source),
                     out = patchNodes(instrument.detector, wo, levels.detector);
    const std::size_t channels = brdf.channels().count(), count = in.directions.size();
    std::vector<double> x, y, z, f(channels * count), result(channels, 0);
    for (const Direction& d : in.directions) x.push_back(d.x), y.push_back(d.y), z.push_back(d.z);
    for (std::size_t j = 0; j < out.directions.size(); ++j) {
        brdf.eval(out.directions[j], {x.data(), y.data(), z.data(), count}, f.data());
        for (std::size_t c = 0; c < channels; ++c)
            for (std::size_t i = 0; i < count; ++i)
                result[c] += out.weights[j] * in.weights[i] * f[c * count + i];
    }
    const double weight = std::reduce(in.weights.begin(), in.weights.end()) *
                          std::reduce(out.weights.begin(), out.weights.end());
    for (double& value : result) value /= weight;
    return result;
}

double largestChange(const std::vector<double>& a, const std::vector<double>& b, double floor) {
    double change = 0;
    for (std::size_t c = 0; c < a.size(); ++c) {
        const double size = std::max({std::abs(a[c]), std::abs(b[c]), floor});
        if (size > 0) change = std::max(change, std::abs(a[c] - b[c]) / size);
    }
    return change;
}

/// The search of one sample.
struct Found {
    PatchLevels levels;
    double change = 0;
    bool exhausted = false;
};

Found searchOne(const Brdf& brdf, const Direction& wi, const Direction& wo,
                const Instrument& instrument, PatchLevels least, double floor) {
    const PatchLevels lobes = levelsOfLobes(brdf, wi, wo, instrument);
    Found found{{std::max(least.source, lobes.source), std::max(least.detector, lobes.detector)}};
    if (nodesOf(instrument, found.levels) > mostOfOne) found.levels = lobes;
    std::vector<double> own = average(brdf, wi, wo, instrument, found.levels);
    // Each patch has passed since the other was last refined.
    for (int passed = 0, patch = 0; passed < 2; patch = 1 - patch) {
        const Aperture& aperture = patch == 0 ? instrument.source : instrument.detector;
        ++passed;
        if (!aperture.finite()) continue;
        PatchLevels next = found.levels;
        std::size_t& level = patch == 0 ? next.source : next.detector;
        if (level == ladder.back()) {
            found.exhausted = true;
            return found;
        }
        level = *std::next(std::ranges::find(ladder, level));
        std::vector<double> finer = average(brdf, wi, wo, instrument, next);
        const double change = largestChange(own, finer, floor);
        if (change <= instrument.tolerance) {
            found.change = std::max(found.change, change);
            continue;
        }
        if (nodesOf(instrument, next) > mostOfOne) {
            found.change = change;
            found.exhausted = true;
            return found;
        }
        found.levels = next;
        found.change = 0;
        own = std::move(finer);
        passed = 0;
    }
    return found;
}

}  // namespace

FitSamples averaged(const FitSamples& samples, const Instrument& instrument,
                    const std::vector<PatchLevels>& levels) {
    if (!instrument.averages()) return samples;
    std::size_t total = 0;
    for (const PatchLevels& own : levels) total += nodesOf(instrument, own);
    if (total > mostOfAll)
        throw NumericError(fmt::format(
            "averages over the apertures need {} pairs of directions for {} samples, expected at "
            "most {}: take a larger tolerance or fewer samples",
            total, samples.size(), mostOfAll));
    NodeSums sums;
    FitSamples result = samples;
    for (std::size_t k = 0; k < samples.size(); ++k) {
        const PatchNodes in = patchNodes(instrument.source, incidentOf(samples, k),
                                         levels[k].source),
                         out = patchNodes(instrument.detector, samples.wo[k], levels[k].detector);
        const double weight = std::reduce(in.weights.begin(), in.weights.end()) *
                              std::reduce(out.weights.begin(), out.weights.end());
        sums.rows.push_back({.firstNode = sums.size(),
                             .nodes = in.directions.size() * out.directions.size(),
                             .firstFactor = sums.factors.size()});
        result.sumRows.push_back(k);
        for (std::size_t j = 0; j < out.directions.size(); ++j)
            for (std::size_t i = 0; i < in.directions.size(); ++i) {
                sums.wiX.push_back(in.directions[i].x);
                sums.wiY.push_back(in.directions[i].y);
                sums.wiZ.push_back(in.directions[i].z);
                sums.wo.push_back(out.directions[j]);
                sums.factors.push_back(in.weights[i] * out.weights[j] / weight);
            }
    }
    result.sums = std::make_shared<const NodeSums>(std::move(sums));
    return result;
}

PatchSearch searchLevels(const Brdf& brdf, const FitSamples& samples, const Instrument& instrument,
                         std::vector<PatchLevels> levels) {
    PatchSearch search;
    search.levels = std::move(levels);
    if (!instrument.averages()) return search;
    // Averages at the nominal directions' own level give the size of f.
    std::vector<Found> found(samples.size());
    std::vector<double> sizes(samples.size(), 0);
    eachInParallel(samples.size(), [&](std::size_t k) {
        for (const double f : average(brdf, incidentOf(samples, k), samples.wo[k], instrument, {}))
            sizes[k] = std::max(sizes[k], std::abs(f));
    });
    const double floor = 1e-6 * *std::ranges::max_element(sizes);
    eachInParallel(samples.size(), [&](std::size_t k) {
        found[k] = searchOne(brdf, incidentOf(samples, k), samples.wo[k], instrument,
                             search.levels[k], floor);
    });
    for (std::size_t k = 0; k < samples.size(); ++k) {
        search.levels[k] = found[k].levels;
        if ((found[k].exhausted && !search.exhausted) ||
            (found[k].exhausted == search.exhausted && found[k].change > search.change)) {
            search.exhausted = search.exhausted || found[k].exhausted;
            search.change = found[k].change;
            search.sample = k;
        }
    }
    return search;
}

}  // namespace hshfit::brdfs
