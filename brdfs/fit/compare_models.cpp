#include <brdfs/fit/compare_models.h>

#include <brdfs/catalog/tables.h>
#include <brdfs/fit/dispersion.h>
#include <brdfs/fit/distributions.h>
#include <brdfs/fit/parametric_sum.h>
#include <hshfit/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

namespace hshfit::brdfs {
namespace {

constexpr std::size_t foldCount = 5;
using Folds = std::array<std::vector<std::size_t>, foldCount>;
using Groups = std::map<std::pair<int, int>, std::vector<std::size_t>>;

/// Samples that are held out together: scans, or rings in elevation.
Groups groupsOf(const FitSamples& samples) {
    Groups groups;
    if (!samples.scans.empty()) {
        for (std::size_t k = 0; k < samples.size(); ++k)
            groups[{0, static_cast<int>(samples.scans[k])}].push_back(k);
        if (groups.size() >= foldCount) return groups;
        groups.clear();
    }
    for (std::size_t k = 0; k < samples.size(); ++k) {
        const int ring = static_cast<int>(degrees(polarAngle(samples.wo[k])) / 3);
        const int sector =
            samples.isotropic ? 0 : static_cast<int>(degrees(azimuth(samples.wo[k]) + pi) / 30);
        groups[{sector, ring}].push_back(k);
    }
    return groups;
}

Folds foldsOf(const FitSamples& samples, const Groups& rings) {
    Folds folds;
    if (rings.size() < foldCount) {
        for (std::size_t k = 0; k < samples.size(); ++k)
            folds[k * foldCount / samples.size()].push_back(k);
        return folds;
    }
    std::size_t next = 0;
    for (const auto& [place, members] : rings) {
        std::vector<std::size_t>& fold = folds[next++ % foldCount];
        fold.insert(fold.end(), members.begin(), members.end());
    }
    for (auto& fold : folds) std::ranges::sort(fold);
    return folds;
}

/// All samples but these.
FitSamples without(const FitSamples& samples, const std::vector<std::size_t>& fold) {
    std::vector<std::size_t> rest;
    std::size_t at = 0;
    for (std::size_t k = 0; k < samples.size(); ++k) {
        if (at < fold.size() && fold[at] == k)
            ++at;
        else
            rest.push_back(k);
    }
    return samples.subset(rest);
}

struct HeldOut {
    double loss = 0;
    std::vector<double> squares;  ///< weighted squared residuals of each sample, over channels
};

/// Whether the samples say more of their errors than that they are of one kind.
bool stated(const FitSamples& samples) {
    return !samples.sigmas.empty() || !samples.scans.empty();
}

void addSquares(const std::vector<double>& f, const FitSamples& held, Loss::Kind loss,
                const std::vector<std::size_t>& fold, HeldOut& result) {
    for (std::size_t c = 0; c < held.channels.count(); ++c)
        for (std::size_t k = 0; k < held.size(); ++k) {
            const double r = mapValue(loss, f[c * held.size() + k], held.wiZ[k]).value -
                             mapValue(loss, held.value(c, k), held.wiZ[k]).value;
            result.squares[fold[k]] += held.weight(c, k) * r * r;
        }
}

/// The loss at each fold of a fit to the others. These fits start at `whole`, that to all samples.
HeldOut heldOutOf(const FitSamples& samples, const Folds& folds, const FitResult& whole,
                  FitOptions options) {
    options.starts = std::max(1, options.starts / 4);
    options.from = shapesOf(whole, options, samples);
    options.progress = {};
    options.uncertainty = {};
    options.contributions.clear();
    double squares = 0, weights = 0;
    HeldOut heldOut;
    heldOut.squares.assign(samples.size(), 0);
    for (const std::vector<std::size_t>& fold : folds) {
        if (fold.empty()) continue;
        FitSamples rest = without(samples, fold);
        // Errors of parameters are of no use here.
        if (!options.instrument.scales) rest.scans.clear();
        const FitResult result = fit(rest, options);
        const FitSamples held = samples.subset(fold);
        double weight = 0;
        for (const std::size_t k : fold) {
            if (samples.sigmas.empty()) weight += samples.weights[k];
            for (std::size_t c = 0; !samples.sigmas.empty() && c < samples.channels.count(); ++c)
                weight += samples.weight(c, k);
        }
        const std::vector<double> predicted = predictedValues(result, held);
        const double loss = lossOf(predicted, held, options.loss);
        squares += weight * loss * loss;
        weights += weight;
        addSquares(predicted, held, options.loss, fold, heldOut);
    }
    heldOut.loss = std::sqrt(squares / weights);
    return heldOut;
}

HeldOutError errorOf(const HeldOut& heldOut, const Groups& groups) {
    HeldOutError error{.loss = heldOut.loss, .squares = {}};
    for (const auto& [place, members] : groups) {
        error.squares.push_back(0);
        for (const std::size_t k : members) error.squares.back() += heldOut.squares[k];
    }
    return error;
}

}  // namespace

std::vector<double> shapesOf(const FitResult& fit, const FitOptions& options,
                             const FitSamples& samples) {
    if (options.perChannel || options.instrument.any() || fit.point.channels.empty()) return {};
    if (!options.dispersion.empty() || namesMetals(options.model)) return {};
    const std::vector<double>& values = fit.point.channels.front().values;
    const auto count = static_cast<std::ptrdiff_t>(
        ParametricSum(options.model, samples.isotropic, 0, fit.point.channels.front().coloured)
            .shapes()
            .size());
    return {values.begin(), values.begin() + count};
}

HeldOutError heldOutError(const FitSamples& samples, const FitResult& whole,
                          const FitOptions& options) {
    const Groups groups = groupsOf(samples);
    return errorOf(heldOutOf(samples, foldsOf(samples, groups), whole, options), groups);
}

bool differ(const HeldOutError& a, const HeldOutError& b) {
    if (a.squares.size() < 2) return true;
    const double count = static_cast<double>(a.squares.size());
    std::vector<double> differences;
    double mean = 0, spread = 0;
    for (std::size_t k = 0; k < a.squares.size(); ++k) {
        differences.push_back(b.squares[k] - a.squares[k]);
        mean += differences.back() / count;
    }
    for (const double difference : differences) spread += (difference - mean) * (difference - mean);
    const double error = std::sqrt(spread / (count * (count - 1)));
    return std::abs(mean) > studentBound(0.05, count - 1) * error;
}

std::vector<ModelRank> compareModels(const FitSamples& samples, std::span<const std::string> models,
                                     FitOptions options) {
    // A model that is misspelt shows before the others are fitted.
    for (const std::string& model : models) ParametricSum(model, samples.isotropic);
    const Groups groups = groupsOf(samples);
    const Folds folds = foldsOf(samples, groups);
    std::vector<ModelRank> ranks;
    std::vector<HeldOutError> heldOut;
    for (const std::string& model : models) {
        ModelRank rank{.model = model, .fit = {}, .failure = {}};
        options.model = model;
        try {
            rank.fit = fit(samples, options);
            heldOut.push_back(errorOf(heldOutOf(samples, folds, rank.fit, options), groups));
            rank.heldOut = heldOut.back().loss;
        } catch (const NumericError& error) {
            rank.failure = error.what();
        }
        ranks.push_back(std::move(rank));
    }
    std::string least;
    if (stated(samples) && !heldOut.empty()) {
        const auto best = std::ranges::min_element(heldOut, {}, &HeldOutError::loss);
        auto own = heldOut.begin();
        for (ModelRank& rank : ranks)
            if (rank.failure.empty()) {
                rank.tied = own == best || !differ(*best, *own);
                if (own == best) least = rank.model;
                ++own;
            }
    }
    std::ranges::stable_sort(ranks, {}, [](const ModelRank& rank) {
        return std::tuple(!rank.failure.empty(), !rank.tied,
                          rank.tied ? rank.fit.parameters.size() : 0, rank.heldOut);
    });
    ranks.front().simplest = ranks.front().tied && ranks.front().model != least;
    ranks.front().tied = false;
    return ranks;
}

}  // namespace hshfit::brdfs
