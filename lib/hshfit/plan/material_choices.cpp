#include <hshfit/plan/internal/material_search.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/representation/forms/pair_evaluators.h>
#include <hshfit/representation/forms/represented_brdf.h>
#include <hshfit/tradeoff/timing.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hshfit::plan {
namespace {

constexpr double never = std::numeric_limits<double>::infinity();
/// Forms whose truncation exceeds this share of the budget are not tried, since interpolation
/// rarely lowers the error.
constexpr double floorSlack = 1.25;
constexpr std::size_t shownCheaper = 3;
/// Limits of the search for a dearer choice with half the error.
constexpr std::size_t farthestDearer = 4;
constexpr std::size_t mostTriedDearer = 150;
/// Sizes of the halfway form that are tried to tell a first choice.
constexpr std::size_t mostTriedFirst = 3;
/// The ratio of the budget to the tolerance of a file's projection.
constexpr double fileShare = 100;
/// The number of forms that are timed if times decide.
constexpr std::size_t mostTimed = 12;

std::string keyOf(const Rung& rung) {
    return fmt::format("{} {}", rung.source, optionsOf(rung.form));
}

Rung unrounded(Rung rung) {
    rung.form.precision = Precision::float64;
    return rung;
}

/// For a pair of directions in a batch, on one thread.
double nanosecondsPerPair(const Representation& representation, const BrdfOpener& open) {
    const auto evaluator = pairEvaluator(representation, open);
    const PairEvaluator* const one = evaluator.get();
    const auto times = tradeoff::timePairs({&one, 1}, representation.head.channels.count());
    return times.front().batch.median;
}

std::vector<Radiance> withAdded(std::vector<Radiance> radiance,
                                const std::vector<Radiance>& added) {
    for (std::size_t o = 0; o < added.size(); ++o) {
        for (std::size_t v = 0; v < added[o].size(); ++v) {
            for (std::size_t c = 0; c < 3; ++c) radiance[o][v][c] += added[o][v][c];
        }
    }
    return radiance;
}

}  // namespace

double MaterialSearch::floorOf(const Rung& rung) {
    if (rung.form.kind == Representation::Kind::halfway) return 0;
    const auto& floors = partOf(rung).floor;
    const auto found = floors.find(rung.form.basis + " " + quantityName(rung.form.quantity));
    return found == floors.end() ? 0 : found->second[static_cast<std::size_t>(rung.form.order) - 1];
}

std::vector<Radiance> MaterialSearch::radianceOf(const Representation& representation,
                                                 const Part& part) {
    if (representation.kind() == Representation::Kind::halfway) {
        return light_->radianceOf(*pairEvaluator(representation, open_),
                                  representation.head.channels.count());
    }
    // One table of the light serves all orders, which are its prefixes.
    const std::string& basis = representation.head.basis;
    const int order = std::min(options_.maxOrder, bases::find(basis).maxOrder);
    const std::vector<BasisLight>& light = light_->in(basis, order, representation.head.quantity);
    std::vector<Radiance> radiance;
    for (const BasisLight& each : light) {
        radiance.push_back(linearRadiance(representation, each, light_->views()));
    }
    return withAdded(std::move(radiance), part.addedRadiance);
}

std::optional<double> MaterialSearch::errorOf(const Rung& rung) {
    const std::string key = keyOf(rung);
    if (const auto found = errors_.find(key); found != errors_.end()) return found->second;
    std::optional<double> error;
    try {
        Part& part = partOf(rung);
        error = light_->errorOf(radianceOf(represent(*part.kept, rung.form, part.added), part));
    } catch (const NumericError& failure) {
        lastFailure_ = failure.what();
    } catch (const UsageError& failure) {
        lastFailure_ = failure.what();
    }
    ++plan_.tried;
    return errors_[key] = error;
}

bool MaterialSearch::wasTried(const Rung& rung) const {
    const auto found = errors_.find(keyOf(rung));
    return found != errors_.end() && found->second;
}

std::optional<double> MaterialSearch::unroundedError(const Rung& rung) {
    return errorOf(unrounded(rung));
}

const choice::RowMeasurement& MaterialSearch::measurement() {
    if (!measurement_) measurement_.emplace(*versions_.front().brdf, PoorBounds{}, costs_);
    return *measurement_;
}

const LatticeCheck& MaterialSearch::check() {
    if (!check_) check_.emplace(scene_, plan_.material, *versions_.front().brdf);
    return *check_;
}

bool MaterialSearch::looksRight(const Rung& rung) {
    const std::optional<double> most = plan_.material.budget.flip;
    if (!most) return true;
    const auto [found, added] = looksRight_.try_emplace(keyOf(rung), false);
    if (added) {
        Part& part = partOf(rung);
        const auto brdf = reconstruct(represent(*part.kept, rung.form, part.added), open_);
        found->second = measurement().pictures().flipWithin(*brdf, *most).has_value();
    }
    return found->second;
}

/// A hundredth of the budget, since a finer projection would change no digit that is shown.
double MaterialSearch::toleranceOf(const Form& form) const {
    if (form.kind == Representation::Kind::halfway) return 0;
    return std::max(versions_.front().brdf->defaultTolerance(),
                    plan_.material.budget.error / fileShare);
}

Choice MaterialSearch::choiceOf(const Rung& rung, double error) const {
    return {.spec = versions_[rung.source].spec,
            .form = rung.form,
            .tolerance = toleranceOf(rung.form),
            .bytes = rung.bytes,
            .error = error};
}

Choice MaterialSearch::shownChoice(const Rung& rung, double error) {
    Choice choice = choiceOf(rung, error);
    if (!plan_.material.budget.flip) return choice;
    Part& part = partOf(rung);
    const auto brdf = reconstruct(represent(*part.kept, rung.form, part.added), open_);
    choice.flip = measurement().pictures().flipWithin(*brdf, never);
    return choice;
}

Representation MaterialSearch::fileOf(const Rung& rung) {
    Part& part = partOf(rung);
    // A fit asks for no tolerance: the search's own is the file's.
    if (rung.form.kind == Representation::Kind::halfway)
        return represent(*part.kept, rung.form, part.added);
    tradeoff::KeepOptions how;
    how.projection.tolerance = toleranceOf(rung.form);
    how.folder = &options_.folder;
    how.split = rung.form.split;
    tradeoff::KeptProjections finer(part.kept->remainder(), std::move(how));
    return represent(finer, rung.form, part.added);
}

std::optional<Accepted> MaterialSearch::accept(const Rung& rung) {
    std::optional<double>& known = errors_[keyOf(rung)];
    Accepted result{.choice = choiceOf(rung, 0), .representation = {}};
    try {
        result.representation = fileOf(rung);
    } catch (const NumericError& failure) {
        lastFailure_ = failure.what();
        known.reset();
        return {};
    }
    result.choice.bytes = result.representation.bytes();
    result.choice.error = light_->errorOf(radianceOf(result.representation, partOf(rung)));
    const auto again = reconstruct(result.representation, open_);
    const LatticeCheck::Result checked = check().of(*again);
    result.verified = checked.error;
    result.thetas = checked.thetas;
    result.errors = checked.byElevation;
    const Budget& budget = plan_.material.budget;
    const bool holds = result.choice.error <= budget.error && result.verified <= budget.error &&
                       result.choice.bytes <= scene_.limits.bytes;
    if (!holds) known = std::max(result.choice.error, result.verified);
    if (!holds) return std::nullopt;
    result.picture = measurement().pictures().errorOf(*again);
    if (result.picture.flip.mean > budget.flip.value_or(never)) return std::nullopt;
    // A version of one channel has pairs of its own.
    const bool whole = rung.source == 0 && measurement().pairs();
    result.pairs = whole ? summaryOf(*measurement().pairs(), *again)
                         : summaryOf(*versions_[rung.source].brdf, *again);
    if (costs_) result.cost = costs_->of(result.representation);
    return result;
}

void MaterialSearch::sayFirst() {
    if (!options_.found || limit_.isOver()) return;
    std::size_t tried = 0;
    for (const Rung& rung : halfwayRungs({.brdf = versions_.front().brdf.get()}, ladderOptions_)) {
        if (rung.form.precision != Precision::half) continue;
        if (++tried > mostTriedFirst) return;
        const double error = errorOf(rung).value_or(never);
        if (error > plan_.material.budget.error || !looksRight(rung)) continue;
        options_.found(plan_.material, choiceOf(rung, error));
        return;
    }
}

bool MaterialSearch::makeWay(std::size_t place) {
    Rung& rung = rungs_[place];
    if (rung.form.kind != Representation::Kind::halfway) return false;
    Part& part = partOf(rung);
    const std::size_t bytes = represent(*part.kept, rung.form, part.added).bytes();
    if (bytes <= rung.bytes) return false;
    rung.bytes = bytes;
    const auto here = rungs_.begin() + static_cast<std::ptrdiff_t>(place);
    const auto above = std::find_if(here + 1, rungs_.end(),
                                    [&](const Rung& other) { return other.bytes > bytes; });
    std::rotate(here, here + 1, above);
    return above != here + 1;
}

std::optional<std::size_t> MaterialSearch::firstWithin(std::size_t from) {
    const double budget = plan_.material.budget.error;
    for (std::size_t i = from; i < rungs_.size() && !limit_.isOver();) {
        const bool within = floorOf(rungs_[i]) <= floorSlack * budget &&
                            unroundedError(rungs_[i]).value_or(never) <= budget &&
                            errorOf(rungs_[i]).value_or(never) <= budget &&
                            looksRight(unrounded(rungs_[i])) && looksRight(rungs_[i]);
        if (!within) {
            ++i;
        } else if (!makeWay(i)) {
            return i;
        }
    }
    return {};
}

void MaterialSearch::takeCheapest() {
    std::size_t raised = 0;
    for (auto found = firstWithin(0); found; found = firstWithin(*found + 1), ++raised) {
        if (auto accepted = accept(rungs_[*found])) {
            plan_.accepted = std::move(accepted);
            plan_.accepted->raised = raised;
            findNeighbours(*found);
            return;
        }
    }
}

void MaterialSearch::takeLarge() {
    const auto last = std::find_if(rungs_.rbegin(), rungs_.rend(), [](const Rung& rung) {
        return rung.form.kind == Representation::Kind::halfway &&
               rung.form.precision == Precision::half && rung.source == 0;
    });
    if (last == rungs_.rend()) return;
    plan_.accepted = accept(*last);
    if (plan_.accepted) findNeighbours(static_cast<std::size_t>(rungs_.rend() - last) - 1);
}

void MaterialSearch::takeFastest() {
    struct Timed {
        std::size_t rung;
        double nanoseconds;
    };
    std::vector<Timed> timed;
    std::vector<Form> forms;
    for (auto found = firstWithin(0); found && forms.size() < mostTimed;
         found = firstWithin(*found + 1)) {
        const Rung& rung = rungs_[*found];
        const bool known = std::any_of(forms.begin(), forms.end(), [&](const Form& form) {
            return sameNumbers(form, rung.form);
        });
        if (known) continue;
        forms.push_back(rung.form);
        Part& part = partOf(rung);
        const double time = nanosecondsPerPair(represent(*part.kept, rung.form, part.added), open_);
        if (time <= scene_.limits.nanoseconds.value_or(never)) timed.push_back({*found, time});
    }
    std::stable_sort(timed.begin(), timed.end(),
                     [](const Timed& a, const Timed& b) { return a.nanoseconds < b.nanoseconds; });
    for (const Timed& each : timed) {
        if (auto accepted = accept(rungs_[each.rung])) {
            plan_.accepted = std::move(accepted);
            plan_.accepted->choice.nanoseconds = each.nanoseconds;
            findNeighbours(each.rung);
            return;
        }
    }
    if (!forms.empty() && timed.empty()) {
        plan_.refused = fmt::format("{} forms keep to the budget, none within {:g} ns a pair",
                                    forms.size(), scene_.limits.nanoseconds.value_or(never));
    }
}

/// Finds the front of error over bytes below the chosen rung, by known errors or bounds from
/// truncation, and measures it. Finds the first rung above with at most half the error.
void MaterialSearch::findNeighbours(std::size_t chosen) {
    std::vector<std::size_t> front;
    double least = never;
    for (std::size_t i = 0; i < rungs_.size(); ++i) {
        if (plan_.accepted && rungs_[i].bytes >= rungs_[chosen].bytes) break;
        if ((!plan_.accepted || plan_.cut) && !wasTried(rungs_[i])) continue;
        const double floor = floorOf(rungs_[i]);
        if (!(floor < least)) continue;
        const double error = errorOf(rungs_[i]).value_or(never);
        if (!(error < least)) continue;
        least = error;
        front.push_back(i);
    }
    const std::size_t first = front.size() - std::min(front.size(), shownCheaper);
    for (std::size_t k = first; k < front.size(); ++k) {
        plan_.cheaper.push_back(shownChoice(rungs_[front[k]], *errorOf(rungs_[front[k]])));
    }
    if (!plan_.accepted || plan_.cut) return;
    const double wanted = plan_.accepted->choice.error / 2;
    const std::size_t enough = plan_.tried + mostTriedDearer;
    for (std::size_t i = chosen + 1; i < rungs_.size() && plan_.tried < enough; ++i) {
        if (rungs_[i].bytes > farthestDearer * rungs_[chosen].bytes) return;
        if (floorOf(rungs_[i]) > wanted) continue;
        const double error = errorOf(rungs_[i]).value_or(never);
        if (error > wanted) continue;
        plan_.dearer = shownChoice(rungs_[i], error);
        return;
    }
}

}  // namespace hshfit::plan
