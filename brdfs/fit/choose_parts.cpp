#include <brdfs/fit/choose_parts.h>

#include <brdfs/fit/compare_models.h>
#include <brdfs/fit/free_parameters.h>
#include <brdfs/fit/parametric_sum.h>
#include <hshfit/error.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
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

/// The name of the parameter that a fit states to add a part, or "".
std::string_view statedKeyOf(const ModelPart& part) {
    return part.with.substr(0, std::min(part.with.find('='), part.with.size()));
}

std::string extended(const std::string& spec, std::string_view more) {
    return fmt::format("{}{}{}", spec, spec.find(':') == spec.npos ? ':' : ',', more);
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
    std::string stated = {};  ///< PartSearch::stated, of the part that is new
    HeldOutError heldOut = {};
};

std::pair<bool, double> lessOf(const TriedParts& own) {
    return {!own.trial.failure.empty(), own.trial.loss};
}

/// The error of a fit in hue: the root mean square of the residuals of RGB, after a change of the
/// brightness of f and added white are taken out of each. Parts other than films change no hue with
/// the directions.
double errorOfHue(const FitSamples& samples, const FitResult& result, Loss::Kind loss) {
    const std::vector<double> model = predictedValues(result, samples);
    const std::size_t count = samples.size();
    double sum = 0, weights = 0;
    for (std::size_t k = 0; k < count; ++k) {
        Eigen::Vector3d r, brighter, whiter;
        for (Eigen::Index c = 0; c < 3; ++c) {
            const auto channel = static_cast<std::size_t>(c);
            const std::size_t v = channel * count + k;
            const double weight = std::sqrt(samples.weight(channel, k)), z = samples.wiZ[k];
            weights += weight * weight;
            const Mapped own = mapValue(loss, samples.values[v], z);
            r(c) = weight * (mapValue(loss, model[v], z).value - own.value);
            whiter(c) = weight * own.slope;
            brighter(c) = whiter(c) * samples.values[v];
        }
        // Grey values have no second direction to leave out.
        constexpr double grey = 0.02;
        const Eigen::Vector3d across = brighter.cross(whiter);
        const double length = across.norm(), most = brighter.norm() * whiter.norm();
        if (length > grey * most)
            sum += std::pow(r.dot(across) / length, 2);
        else if (most > 0)
            sum += r.cross(whiter).squaredNorm() / whiter.squaredNorm();
    }
    return weights > 0 ? std::sqrt(sum / weights) : 0;
}

/// Fits of a model with some of its parts.
class Trials {
public:
    Trials(const Model& model, const FitSamples& samples, const FitOptions& fit,
           const PartOptions& options, std::size_t most)
        : model_(model),
          samples_(samples),
          fit_(fit),
          options_(options),
          base_(fit.model),
          most_(most) {}

    /// To all samples. `before`: a fit with fewer parts, of which the shapes start where it ended.
    TriedParts fitted(std::vector<std::string> parts, const TriedParts* before) {
        const std::string model = withParts(base_, parts);
        return fitted(std::move(parts), model, before);
    }

    /// With one part more; of a film the best of some shares of the facets that it covers, from as
    /// many thicknesses as a fit has starts if it lowers the loss at all.
    TriedParts added(const std::string& name, const TriedParts& before) {
        std::vector<std::string> parts = before.trial.parts;
        parts.push_back(name);
        const std::string_view key = statedKeyOf(partNamed(model_, name));
        if (key.empty()) return fitted(std::move(parts), &before);
        const auto covering = [&](double share, int starts) {
            const std::string stated = fmt::format("{}={}", key, share);
            TriedParts own =
                fitted(parts, withParts(extended(base_, stated), parts), &before, starts);
            own.stated = stated;
            return own;
        };
        TriedParts best;
        double bestShare = 0;
        for (const double share : {0.5, 1., 0.25}) {
            TriedParts own = covering(share, std::max(1, fit_.starts / 2));
            if (bestShare == 0 || lessOf(own) < lessOf(best))
                best = std::move(own), bestShare = share;
        }
        if (!best.trial.failure.empty() ||
            best.trial.loss > (1 - options_.leastGain) * before.trial.loss)
            return best;
        TriedParts own = covering(bestShare, fit_.starts);
        return lessOf(own) < lessOf(best) ? own : best;
    }
    /// Later fits have the film of this one.
    void goOnFrom(const TriedParts& taken) {
        if (!taken.stated.empty()) base_ = extended(base_, taken.stated);
    }

    /// A fit of a model that holds more than the parts say.
    TriedParts fitted(std::vector<std::string> parts, std::string model, const TriedParts* before,
                      int starts = 0) {
        TriedParts own;
        own.trial.parts = std::move(parts);
        own.options = fit_;
        own.options.model = std::move(model);
        own.options.progress = {};
        own.options.uncertainty = {};
        own.options.contributions.clear();
        own.options.starts = starts > 0 ? starts : std::max(1, fit_.starts / 4);
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
            own.heldOut = heldOutError(samples_, own.result, own.options);
            own.trial.heldOut = own.heldOut.loss;
        } catch (const NumericError& error) {
            own.trial.failure = error.what();
        }
    }

    /// Whether a part may lower the loss of a fit by more than chance.
    bool worthTrying(const std::string& name, const TriedParts& current) const {
        return partNamed(model_, name).with.empty() ||
               (samples_.origin == SampleOrigin::pixels &&
                errorOfHue(samples_, current.result, fit_.loss) >= options_.leastHue);
    }

private:
    /// Values of the shapes by which models with and without a part are told, NaN for new ones.
    std::vector<double> startOf(const FitOptions& own, const TriedParts& before) const {
        const std::vector<double> known = shapesOf(before.result, before.options, samples_);
        if (known.empty()) return {};
        const bool coloured = before.result.point.channels.front().coloured;
        const ParametricSum sum(own.model, samples_.isotropic, 0, coloured),
            last(before.options.model, samples_.isotropic, 0, coloured);
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

    const Model& model_;
    const FitSamples& samples_;
    const FitOptions& fit_;
    const PartOptions& options_;
    std::string base_;  ///< the model, with a film where one was taken
    std::size_t most_, done_ = 0;
};

/// "held out 0.0274, taken", the loss where it fell too little for that, or the failure.
std::string outcomeOf(const PartTrial& trial) {
    if (!trial.failure.empty()) return trial.failure;
    return fmt::format("{} {:.6g}{}", trial.heldOut ? "held out" : "rms",
                       trial.heldOut.value_or(trial.loss), trial.taken ? ", taken" : "");
}

std::string holding(const std::string& spec, const HeldParameter& held) {
    return extended(spec, fmt::format("{}={}", held.name, held.value));
}

/// The parameters of the parts of a fit, then the parameters of the base except its colours, which
/// are always fitted.
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
/// `most`; the fit becomes that with them.
std::vector<HeldParameter> undecided(const Model& model, const FitSamples& samples, Trials& trials,
                                     TriedParts& current, double most) {
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

/// The parts of which a fit would move a parameter, and that are not there already.
std::vector<std::string> openParts(const Model& model, const std::string& spec,
                                   const FitSamples& samples) {
    std::vector<std::string> open;
    for (const std::string& name : partsFor(model, samples.channels)) {
        const ModelPart& part = partNamed(model, name);
        if (statedIn(spec, model).given(statedKeyOf(part))) continue;
        const std::string with = part.with.empty() ? spec : withParts(spec, {name});
        if (isFree(model, part, statedIn(with, model), samples.isotropic)) open.push_back(name);
    }
    return open;
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
        const std::string_view own = statedKeyOf(part);
        if (has(parts, part.name) && !own.empty() && !stated.given(own))
            result = extended(result, part.with);
        if (has(parts, part.name) || !own.empty()) continue;
        for (const std::string_view key : part.parameters) {
            if (stated.given(key)) continue;
            const auto row = std::ranges::find(model->parameters, key, &Parameter::name);
            result = extended(result, fmt::format("{}={}", key, *row->fallback));
        }
    }
    return result;
}

std::vector<std::string> partsFor(const Model& model, const Channels& channels) {
    std::vector<std::string> names;
    for (const ModelPart& part : model.parts)
        if (part.with.empty() || channels.kind == Channels::Kind::rgb)
            names.emplace_back(part.name);
    return names;
}

std::string withParts(std::string_view spec, const PartSearch& search) {
    const std::string base(spec);
    std::string result =
        withParts(search.stated.empty() ? base : extended(base, search.stated), search.parts);
    for (const HeldParameter& held : search.held) result = holding(result, held);
    return result;
}

PartSearch chooseParts(const FitSamples& all, const FitOptions& fit, const PartOptions& options) {
    const Model* model = modelWithParts(fit.model);
    if (!model) throw UsageError(fmt::format("'{}': no model with optional parts", fit.model));
    const FitSamples samples = all.fewer                      ? *all.fewer
                               : all.size() > options.samples ? all.drawn(options.samples, fit.seed)
                                                              : all;
    std::vector<std::string> open = openParts(*model, fit.model, samples);
    Trials trials(*model, samples, fit, options, 1 + open.size() * (open.size() + 1) / 2);
    PartSearch search;
    // Pixels are without noise, and hundreds for each parameter.
    const bool pixels = samples.origin == SampleOrigin::pixels;
    const double unseen = pixels ? options.unseen : 0, least = 1 - options.leastGain;
    TriedParts current = trials.fitted({}, nullptr);
    if (!pixels) trials.holdOut(current);
    current.trial.taken = true;
    search.trials.push_back(current.trial);
    const auto isWorthIt = [&](TriedParts& own) {
        if (!own.trial.failure.empty() || own.trial.loss > least * current.trial.loss) return false;
        if (!pixels) trials.holdOut(own);
        // A few samples of a peak may rule both errors, so that parts fit their noise.
        const bool measured = samples.origin == SampleOrigin::measured;
        own.trial.taken =
            pixels || (own.trial.heldOut && *own.trial.heldOut <= least * *current.trial.heldOut &&
                       (!measured || differ(own.heldOut, current.heldOut)));
        return own.trial.taken;
    };
    // Films last: they are tried where the others leave colours that change with the directions.
    for (bool films = false; current.trial.failure.empty() && current.trial.loss > unseen;) {
        std::vector<TriedParts> wider;
        for (const std::string& name : open)
            if (partNamed(*model, name).with.empty() != films && trials.worthTrying(name, current))
                wider.push_back(trials.added(name, current));
        std::ranges::stable_sort(wider, {}, lessOf);
        const auto taken = std::ranges::find_if(wider, isWorthIt);
        for (const TriedParts& own : wider) search.trials.push_back(own.trial);
        if (taken == wider.end()) {
            if (films) break;
            films = true;
            continue;
        }
        current = std::move(*taken);
        trials.goOnFrom(current);
        search.parts = current.trial.parts;
        if (!current.stated.empty()) search.stated = current.stated;
        std::erase(open, search.parts.back());
        films = false;
    }
    if (!current.trial.failure.empty()) return search;
    search.held =
        undecided(*model, samples, trials, current, std::max(current.trial.loss / least, unseen));
    if (!search.stated.empty()) search.from = shapesOf(current.result, current.options, samples);
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
