#include <brdfs/fit/choose_parts.h>

#include <brdfs/fit/compare_models.h>
#include <brdfs/fit/free_parameters.h>
#include <brdfs/fit/parametric_sum.h>
#include <hshfit/error.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <utility>

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

struct TriedParts {
    PartTrial trial = {};
    FitOptions options = {};
    FitResult result = {};
};

/// Fits of a model with some of its parts.
class Trials {
public:
    Trials(const FitSamples& samples, const FitOptions& fit, const PartOptions& options,
           std::size_t most)
        : samples_(samples), fit_(fit), options_(options), most_(most) {}

    /// To all samples. `before`: a fit with fewer parts, of which the shapes start where it ended.
    TriedParts fitted(std::vector<std::string> parts, const TriedParts* before) {
        const std::string model = withParts(fit_.model, parts);
        return fitted(std::move(parts), model, before);
    }

    /// The same of a model that holds more.
    TriedParts fitted(std::vector<std::string> parts, std::string model, const TriedParts* before) {
        TriedParts own;
        own.trial.parts = std::move(parts);
        own.options = fit_;
        own.options.model = std::move(model);
        own.options.progress = {};
        own.options.uncertainty = {};
        own.options.contributions.clear();
        own.options.starts = std::max(1, fit_.starts / 4);
        // Along a level valley a search goes on for long after the held-out error has settled.
        own.options.iterations = std::min(fit_.iterations, 30);
        own.options.brief = true;
        if (before) own.options.from = startOf(own.options, *before);
        try {
            own.result = brdfs::fit(samples_, own.options);
            own.trial.loss = own.result.loss;
        } catch (const NumericError& error) {
            own.trial.failure = error.what();
        }
        if (options_.progress) options_.progress(++done_, most_);
        return own;
    }

    void holdOut(TriedParts& own) const {
        if (!own.trial.failure.empty()) return;
        try {
            own.trial.heldOut = heldOutLoss(samples_, own.result, own.options);
        } catch (const NumericError& error) {
            own.trial.failure = error.what();
        }
    }

private:
    /// Values of the shapes by which models with and without a part are told, NaN for new ones.
    std::vector<double> startOf(const FitOptions& own, const TriedParts& before) const {
        const std::vector<double> known = shapesOf(before.result, before.options, samples_);
        if (known.empty()) return {};
        const ParametricSum sum(own.model, samples_.isotropic),
            last(before.options.model, samples_.isotropic);
        std::vector<double> from;
        for (const ShapeParameter& shape : sum.shapes()) {
            const auto same =
                std::ranges::find(last.shapes(), shape.free.keys,
                                  [](const ShapeParameter& s) { return s.free.keys; });
            from.push_back(same == last.shapes().end()
                               ? std::numeric_limits<double>::quiet_NaN()
                               : known[static_cast<std::size_t>(same - last.shapes().begin())]);
        }
        return from;
    }

    const FitSamples& samples_;
    const FitOptions& fit_;
    const PartOptions& options_;
    std::size_t most_, done_ = 0;
};

/// "held out 0.0274, taken", the loss where it fell too little for that, or the failure.
std::string outcomeOf(const PartTrial& trial) {
    if (!trial.failure.empty()) return trial.failure;
    return fmt::format("{} {:.6g}{}", trial.heldOut ? "held out" : "rms",
                       trial.heldOut.value_or(trial.loss), trial.taken ? ", taken" : "");
}

std::string holding(const std::string& spec, const HeldParameter& held) {
    return fmt::format("{}{}{}={}", spec, spec.find(':') == spec.npos ? ':' : ',', held.name,
                       held.value);
}

/// The parameters of the parts of a fit, then those of the base but its colours, which are never
/// left open.
std::vector<std::string_view> heldInTurn(const Model& model,
                                         const std::vector<std::string>& parts) {
    std::vector<std::string_view> keys, ofParts;
    for (const ModelPart& part : model.parts) {
        ofParts.insert(ofParts.end(), part.parameters.begin(), part.parameters.end());
        if (has(parts, part.name))
            keys.insert(keys.end(), part.parameters.begin(), part.parameters.end());
    }
    for (const Parameter& parameter : model.parameters)
        if (parameter.kind == Parameter::Kind::number &&
            std::ranges::find(ofParts, parameter.name) == ofParts.end())
            keys.push_back(parameter.name);
    return keys;
}

/// The parameters of a fit that may stay at their defaults, one after another, with a loss of
/// `most`.
std::vector<HeldParameter> undecided(const Model& model, const FitSamples& samples, Trials& trials,
                                     TriedParts current, double most) {
    std::vector<HeldParameter> held;
    for (const std::string_view key : heldInTurn(model, current.trial.parts)) {
        const Parameters stated = statedIn(current.options.model, model);
        if (stated.given(key) || !isFree(model, {key, {}, {key}}, stated, samples.isotropic))
            continue;
        const auto row = std::ranges::find(model.parameters, key, &Parameter::name);
        HeldParameter own{std::string(key), *row->fallback};
        TriedParts without =
            trials.fitted(current.trial.parts, holding(current.options.model, own), &current);
        if (!without.trial.failure.empty() || without.trial.loss > most) continue;
        own.loss = without.trial.loss;
        held.push_back(std::move(own));
        current = std::move(without);
    }
    return held;
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

std::string withParts(std::string_view spec, const PartSearch& search) {
    std::string result = withParts(spec, search.parts);
    for (const HeldParameter& held : search.held) result = holding(result, held);
    return result;
}

PartSearch chooseParts(const FitSamples& all, const FitOptions& fit, const PartOptions& options) {
    const Model* model = modelWithParts(fit.model);
    if (!model) throw UsageError(fmt::format("'{}': no model with optional parts", fit.model));
    const FitSamples samples = all.fewer                      ? *all.fewer
                               : all.size() > options.samples ? all.drawn(options.samples, fit.seed)
                                                              : all;
    const Parameters stated = statedIn(fit.model, *model);
    std::vector<std::string> open;
    for (const ModelPart& part : model->parts)
        if (isFree(*model, part, stated, samples.isotropic)) open.emplace_back(part.name);
    Trials trials(samples, fit, options, 1 + open.size() * (open.size() + 1) / 2);
    PartSearch search;
    // Pixels are without noise, and hundreds for each parameter.
    const bool pixels = samples.origin == SampleOrigin::pixels;
    const double unseen = pixels ? options.unseen : 0;
    TriedParts current = trials.fitted({}, nullptr);
    if (!pixels) trials.holdOut(current);
    current.trial.taken = true;
    search.trials.push_back(current.trial);
    while (current.trial.failure.empty() && !open.empty() && current.trial.loss > unseen) {
        std::vector<TriedParts> wider;
        for (const std::string& name : open) {
            std::vector<std::string> parts = search.parts;
            parts.push_back(name);
            wider.push_back(trials.fitted(std::move(parts), &current));
        }
        std::ranges::stable_sort(wider, {}, [](const TriedParts& own) {
            return std::pair(!own.trial.failure.empty(), own.trial.loss);
        });
        const double least = 1 - options.leastGain;
        const auto taken = std::ranges::find_if(wider, [&](TriedParts& own) {
            if (!own.trial.failure.empty() || own.trial.loss > least * current.trial.loss)
                return false;
            if (!pixels) trials.holdOut(own);
            own.trial.taken = pixels || (own.trial.heldOut &&
                                         *own.trial.heldOut <= least * *current.trial.heldOut);
            return own.trial.taken;
        });
        for (const TriedParts& own : wider) search.trials.push_back(own.trial);
        if (taken == wider.end()) break;
        current = std::move(*taken);
        search.parts = current.trial.parts;
        std::erase(open, search.parts.back());
    }
    if (current.trial.failure.empty())
        search.held = undecided(*model, samples, trials, current,
                                std::max(current.trial.loss / (1 - options.leastGain), unseen));
    return search;
}

std::string textOf(const PartSearch& search) {
    std::string lines;
    for (const PartTrial& trial : search.trials) {
        const std::string name =
            trial.parts.empty() ? "no extension" : fmt::format("{}", fmt::join(trial.parts, " + "));
        lines += fmt::format("  {:<40} {}\n", name, outcomeOf(trial));
    }
    for (const HeldParameter& held : search.held)
        lines += fmt::format("  {:<40} {:g}, its default: the data do not decide it (rms {:.6g})\n",
                             held.name, held.value, held.loss);
    return lines;
}

}  // namespace hshfit::brdfs
