#include "map_forms.h"

#include "map_processes.h"

#include <hshfit/error.h>
#include <hshfit/material_maps/cluster_encoder.h>
#include <hshfit/material_maps/texel_errors.h>

#include <fmt/format.h>

#include <algorithm>

namespace hshfit::jobs {
namespace {

gpu::Number numberOf(const SvbrdfOptions& options) {
    const gpu::Number number = gpu::parseNumber(options.precision);
    if (gpu::isNormalised(number))
        throw UsageError("coefficients of maps are stored as float16 or float32");
    return number;
}

/// Errors of a form against BRDFs, where they are measured.
template <class Form>
std::optional<TexelPairErrors> measured(const ChoiceErrors* checks, const Form& form) {
    return checks ? std::optional(checks->of(form)) : std::nullopt;
}

/// The encoder of clusters; lists other numbers of them.
std::unique_ptr<TexelEncoder> clustersFor(MapWork& work, const SvbrdfOptions& options,
                                          const LowRank& lowRank, const std::vector<float>& samples,
                                          const ChoiceErrors* checks, Svbrdf& result,
                                          Processes& processes, const Listener& listener) {
    constexpr std::size_t blocks = 512;
    const std::size_t floats = work.layout.floats();
    const LevelSamples levels =
        sampleLevels(work.texels, lowRank, samples, result.levels, blocks, processes);
    std::vector<std::size_t> counts{16, 64, 256, 1024};
    if (std::ranges::find(counts, options.clusters) == counts.end())
        counts.push_back(options.clusters);
    std::ranges::sort(counts);
    std::unique_ptr<TexelEncoder> chosen;
    bool allMaterials = false;  // a trial had a cluster for each
    for (const std::size_t clusters : counts) {
        if (clusters > std::max<std::size_t>(1024, options.clusters)) continue;
        const bool isAsked = clusters == options.clusters;
        if (!isAsked && allMaterials) continue;
        if (!isAsked && isOver(work.time, processes)) {
            result.timeIsOver = true;
            continue;
        }
        const ClusterEncoder::Options asked{.clusters = clusters,
                                            .levels = isAsked ? result.levels.size() : 1,
                                            .progress = listener.part("clusters")};
        auto encoder = std::make_unique<ClusterEncoder>(
            lowRank, isAsked ? levels : LevelSamples{levels.front()}, asked, processes);
        const std::size_t count = encoder->count(0);
        // Where the map has fewer materials than were asked for, trials of more are this one.
        if (allMaterials) result.choices.pop_back();
        allMaterials = count < clusters;
        result.choices.push_back({.form = "clusters",
                                  .count = count,
                                  .bytesOfTexel = 4,
                                  .sharedBytes = count * floats * sizeof(float),
                                  .errors = errorsOf(*encoder, levels.front()),
                                  .pairs = measured(checks, *encoder)});
        if (!isAsked) continue;
        result.count = count;
        chosen = std::move(encoder);
    }
    return chosen;
}

void requireKnown(const MapWork& work, const SvbrdfOptions& options) {
    const std::string& form = options.form;
    if (form != "outgoing" && form != "low-rank" && form != "clusters" && form != "halfway") {
        throw UsageError(
            fmt::format("unknown form '{}'; known: outgoing, low-rank, clusters, halfway", form));
    }
    if (form != "halfway") return;
    if (work.measured) {
        throw UsageError(
            "the form halfway is fitted to the BRDFs of a model, and measured texels have samples "
            "alone; the forms outgoing, low-rank and clusters take them");
    }
    if (options.cosine)
        throw UsageError("the form halfway holds f; it has no coefficients of f cos(theta_i)");
}

}  // namespace

MapForm formFor(MapWork& work, const SvbrdfOptions& options, Svbrdf& result, Processes& processes,
                const Listener& listener) {
    requireKnown(work, options);
    const gpu::Number number = numberOf(options);
    const TexelLayout& layout = work.layout;
    const double numberBytes = static_cast<double>(gpu::numberBytes(number));
    MapForm chosen;
    if (work.model && options.checks > 0) {
        chosen.checks = std::make_unique<ChoiceErrors>(
            work.model->maps, work.texels, work.head(options, result.levels),
            std::min(options.checks, mostPairTexels), processes);
    }
    const ChoiceErrors* const checks = chosen.checks.get();
    result.choices.push_back({.form = "outgoing",
                              .count = layout.shape(),
                              .bytesOfTexel = numberBytes * static_cast<double>(layout.floats()),
                              .errors = TexelErrors{}});
    if (checks) result.choices.back().pairs = checks->ofTexels();
    if (options.form == "outgoing") {
        chosen.encoder = std::make_unique<PlainEncoder>(layout, number);
        return chosen;
    }
    const std::vector<float> samples = sampleTexels(work.texels, options.samples, processes);
    const PrincipalShapes principal(layout, samples, processes);
    const std::vector<TexelErrors> errors = principal.errors(samples, processes);
    for (std::size_t rank = 1; rank <= principal.most(); rank *= 2) {
        const LowRankEncoder encoder(principal.lowRank(rank), number);
        result.choices.push_back(
            {.form = "low-rank",
             .count = rank,
             .bytesOfTexel = 4 * numberBytes * static_cast<double>(encoder.layers()),
             .sharedBytes = rank * layout.shape() * sizeof(float),
             .errors = errors[rank - 1],
             .pairs = measured(checks, encoder.lowRank())});
    }
    const std::size_t rank = options.rank > 0 ? std::min(options.rank, principal.most())
                                              : leastRank(errors, options.error);
    const LowRank lowRank = principal.lowRank(rank);
    if (options.form != "low-rank") {
        chosen.encoder =
            clustersFor(work, options, lowRank, samples, checks, result, processes, listener);
        return chosen;
    }
    result.count = rank;
    chosen.encoder = std::make_unique<LowRankEncoder>(lowRank, number);
    return chosen;
}

}  // namespace hshfit::jobs
