#include <brdfs/fit/compare_models.h>

#include <brdfs/catalog.h>
#include <brdfs/fit/parametric_sum.h>
#include <hshfit/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace hshfit::brdfs {
namespace {

constexpr std::size_t foldCount = 5;
using Folds = std::array<std::vector<std::size_t>, foldCount>;

Folds foldsOf(const FitSamples& samples) {
    std::map<std::pair<int, int>, std::vector<std::size_t>> rings;
    for (std::size_t k = 0; k < samples.size(); ++k) {
        const int ring = static_cast<int>(degrees(polarAngle(samples.wo[k])) / 3);
        const int sector =
            samples.isotropic ? 0 : static_cast<int>(degrees(azimuth(samples.wo[k]) + pi) / 30);
        rings[{sector, ring}].push_back(k);
    }
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

/// Of all samples but these.
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

double heldOutLoss(const FitSamples& samples, const Folds& folds, FitOptions options) {
    options.starts = std::max(1, options.starts / 4);
    options.progress = {};
    options.uncertainty = {};
    double squares = 0, weights = 0;
    for (const std::vector<std::size_t>& fold : folds) {
        if (fold.empty()) continue;
        const FitResult result = fit(without(samples, fold), options);
        const FitSamples held = samples.subset(fold);
        double weight = 0;
        for (const std::size_t k : fold) weight += samples.weights[k];
        const double loss = lossOf(*openFit(result), held, options.loss);
        squares += weight * loss * loss;
        weights += weight;
    }
    return std::sqrt(squares / weights);
}

}  // namespace

std::vector<ModelRank> compareModels(const FitSamples& samples, std::span<const std::string> models,
                                     FitOptions options) {
    // A model that is misspelt shows before the others are fitted.
    for (const std::string& model : models) ParametricSum(model, samples.isotropic);
    const Folds folds = foldsOf(samples);
    std::vector<ModelRank> ranks;
    for (const std::string& model : models) {
        ModelRank rank{.model = model, .fit = {}, .failure = {}};
        options.model = model;
        try {
            rank.fit = fit(samples, options);
            rank.heldOut = heldOutLoss(samples, folds, options);
        } catch (const NumericError& error) {
            rank.failure = error.what();
        }
        ranks.push_back(std::move(rank));
    }
    std::ranges::stable_sort(ranks, [](const ModelRank& a, const ModelRank& b) {
        if (a.failure.empty() != b.failure.empty()) return a.failure.empty();
        return a.heldOut < b.heldOut;
    });
    return ranks;
}

}  // namespace hshfit::brdfs
