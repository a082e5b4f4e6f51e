#include <brdfs/fit/choose_parts.h>

#include <brdfs/fit/compare_models.h>
#include <brdfs/fit/free_parameters.h>
#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>

namespace hshfit::brdfs {
namespace {

std::string_view nameIn(std::string_view spec) {
    return spec.substr(0, spec.find(':'));
}

Parameters statedIn(std::string_view spec, const Model& model) {
    const std::size_t colon = spec.find(':');
    return readParameters(model.name, model.parameters,
                          colon == spec.npos ? std::string_view() : spec.substr(colon + 1));
}

const ModelPart& partNamed(const Model& model, std::string_view name) {
    const auto found = std::ranges::find(model.parts, name, &ModelPart::name);
    if (found != model.parts.end()) return *found;
    std::vector<std::string_view> known;
    for (const ModelPart& part : model.parts) known.push_back(part.name);
    throw UsageError(fmt::format("{}: unknown part '{}'{}; known: {}", model.name, name,
                                 suggestion(name, known), joined(known)));
}

bool has(const std::vector<std::string>& parts, std::string_view name) {
    return std::ranges::find(parts, name) != parts.end();
}

/// Whether a fit would move any parameter of a part.
bool isFree(const Model& model, const ModelPart& part, const Parameters& stated, bool isotropic) {
    const std::vector<FreeParameter> free = freeParameters(model, stated, isotropic, false);
    return std::ranges::any_of(free, [&](const FreeParameter& parameter) {
        return std::ranges::any_of(parameter.keys, [&](const std::string& key) {
            return std::ranges::find(part.parameters, key) != part.parameters.end();
        });
    });
}

}  // namespace

const Model* modelWithParts(std::string_view spec) {
    const auto found = std::ranges::find(models(), nameIn(spec), &Model::name);
    return found == models().end() || found->parts.empty() ? nullptr : &*found;
}

std::string withParts(std::string_view spec, const std::vector<std::string>& parts) {
    const Model* model = modelWithParts(spec);
    if (!model) throw UsageError(fmt::format("'{}': no model with optional parts", nameIn(spec)));
    for (const std::string& part : parts) partNamed(*model, part);
    const Parameters stated = statedIn(spec, *model);
    std::string result(spec);
    for (const ModelPart& part : model->parts) {
        if (has(parts, part.name)) continue;
        for (const std::string_view key : part.parameters) {
            if (stated.given(key)) continue;
            const auto row = std::ranges::find(model->parameters, key, &Parameter::name);
            result += fmt::format("{}{}={}", result.find(':') == result.npos ? ':' : ',', key,
                                  *row->fallback);
        }
    }
    return result;
}

PartSearch chooseParts(const FitSamples& all, const FitOptions& fit, const PartOptions& options) {
    const Model* model = modelWithParts(fit.model);
    if (!model) throw UsageError(fmt::format("'{}': no model with optional parts", fit.model));
    const FitSamples samples =
        all.size() > options.samples ? all.drawn(options.samples, fit.seed) : all;
    const Parameters stated = statedIn(fit.model, *model);
    std::vector<std::string> open;
    for (const ModelPart& part : model->parts)
        if (isFree(*model, part, stated, samples.isotropic)) open.emplace_back(part.name);
    std::size_t done = 0;
    const std::size_t most = 1 + open.size() * (open.size() + 1) / 2;
    const auto tried = [&](std::vector<std::string> parts) {
        FitOptions how = fit;
        how.progress = {};
        how.uncertainty = {};
        how.starts = std::max(1, fit.starts / 4);
        // Along a level valley a search goes on for long after the held-out error has settled.
        how.iterations = std::min(fit.iterations, 30);
        const std::vector<std::string> specs{withParts(fit.model, parts)};
        const ModelRank rank = compareModels(samples, specs, how).front();
        if (options.progress) options.progress(++done, most);
        return PartTrial{std::move(parts), rank.heldOut, false, rank.failure};
    };
    PartSearch search;
    search.trials.push_back(tried({}));
    search.trials.back().taken = true;
    if (!search.trials.back().failure.empty()) return search;
    double best = search.trials.back().heldOut;
    while (!open.empty()) {
        std::optional<std::size_t> winner;
        for (const std::string& name : open) {
            std::vector<std::string> parts = search.parts;
            parts.push_back(name);
            search.trials.push_back(tried(std::move(parts)));
            const PartTrial& trial = search.trials.back();
            if (trial.failure.empty() &&
                (!winner || trial.heldOut < search.trials[*winner].heldOut))
                winner = search.trials.size() - 1;
        }
        if (!winner || search.trials[*winner].heldOut > (1 - options.leastGain) * best) break;
        search.trials[*winner].taken = true;
        best = search.trials[*winner].heldOut;
        search.parts = search.trials[*winner].parts;
        std::erase(open, search.parts.back());
    }
    return search;
}

}  // namespace hshfit::brdfs
