#include "quality.h"

#include "better_form.h"
#include "source.h"

#include <hshfit/accuracy/metrics.h>
#include <hshfit/bases/catalog.h>
#include <hshfit/coefficients/reconstruction.h>
#include <hshfit/error.h>
#include <hshfit/percent.h>
#include <hshfit/pictures/poor.h>
#include <hshfit/projection/one_basis.h>
#include <hshfit/representation/forms/represented_brdf.h>
#include <hshfit/representation/hemisphere_gram.h>
#include <hshfit/representation/split.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

namespace hshfit::jobs {
namespace {

using Kind = Representation::Kind;

/// A step of a form that changes it by more than this (relative L2) is named beside the reason.
constexpr double muchChanged = 0.3;

Poor poorWith(const std::string& reason, Advice advice) {
    return {reason, std::move(advice.better), std::move(advice.toTry)};
}

/// A set of twice as many elevations, or texels along each side; as it is for one direction.
std::string finer(const OutgoingSet& set) {
    switch (set.map) {
        case OutgoingSet::Map::parabolic:
            return fmt::format("{}x{}", 2 * set.width, 2 * set.height);
        case OutgoingSet::Map::elevations:
            return std::to_string(2 * set.width);
        default:
            return set.spec();
    }
}

/// The highest order of a trial, the share of the energy that it has to capture to be suggested, as
/// it sees few outgoing directions, and its tolerance.
constexpr int trialOrder = 24;
constexpr double trialCaptured = 0.93, trialTolerance = 1e-2;
constexpr int trialElevations = 6, trialTexels = 4;

/// A few of the outgoing directions of `head`, or of those that it would have.
OutgoingSet fewOf(const CoefficientHead& head) {
    const OutgoingSet& own = head.outgoing;
    if (!own.directions.empty() && own.map == OutgoingSet::Map::direction) return own;
    if (head.isotropic) return OutgoingSet::elevations(trialElevations);
    return OutgoingSet::parabolic(trialTexels, trialTexels);
}

/// The change of a form by a step that a share with six digits does not show.
constexpr double notShown = 1e-7;

std::string_view functionOf(Quantity quantity) {
    return quantity == Quantity::brdfCosine ? "f cos(theta_i)" : "f";
}

/// 1 - relative L2^2 of f or f cos(theta_i), as `compare` measures it.
std::optional<double> measuredShare(const Brdf& source, const Brdf& result, const OutgoingSet& set,
                                    Quantity quantity) {
    const auto metric =
        selectMetrics(quantity == Quantity::brdfCosine ? "relative-l2-cosine" : "relative-l2");
    try {
        const auto error = compare(source, result, set, metric)[0].value;
        return error && std::isfinite(*error) ? std::optional(1 - *error * *error) : std::nullopt;
    } catch (const NumericError&) {
        return std::nullopt;
    }
}

/// Over pairs of directions, of f cos(theta_i) cos(theta_o).
std::optional<double> shareOverPairs(const Brdf& source, const Brdf& result,
                                     const std::optional<PairSummary>& pairs) {
    try {
        const double left = (pairs ? *pairs : summaryOf(source, result)).energyLeft.value;
        return std::isfinite(left) ? std::optional(1 - left) : std::nullopt;
    } catch (const NumericError&) {
        return std::nullopt;
    }
}

/// Coefficients whose squares are the energy in the norm of their basis.
std::vector<double> normalised(const Coefficients& c) {
    std::vector<double> values = c.values;
    if (bases::find(c.basis).orthonormal) return values;
    const auto basis = bases::make(c.basis, c.order, {.condonShortley = c.condonShortley});
    const HemisphereGram gram(*basis);
    for (std::size_t at = 0; at < values.size(); at += c.slots()) gram.whiten(values.data() + at);
    return values;
}

/// The products of coefficients, summed with the solid angles of the outgoing directions.
double product(const OutgoingSet& set, const std::vector<double>& a, const std::vector<double>& b) {
    const auto size = static_cast<std::ptrdiff_t>(a.size() / set.size());
    double sum = 0;
    for (std::size_t k = 0; k < set.size(); ++k) {
        const auto first = static_cast<std::ptrdiff_t>(k) * size;
        sum += set.solidAngles[k] * std::inner_product(a.begin() + first, a.begin() + first + size,
                                                       b.begin() + first, 0.0);
    }
    return sum;
}

/// A form whose coefficients c are no longer those that were projected, c0, of the remainder
/// r = f - added: the energy that it misses is that of r, less 2 c c0, plus c c.
std::optional<double> shareOfChanged(const Representation& kept, const std::vector<double>& c,
                                     const Brdf& source) {
    const CoefficientHead& head = kept.head;
    const auto basis = bases::make(head.basis, head.order, {.condonShortley = head.condonShortley});
    const auto projected = [&](const Brdf& brdf) {
        return hshfit::project(brdf, *basis, head.outgoing,
                               {.quantity = head.quantity, .tolerance = head.tolerance})
            .coefficients;
    };
    const bool isWhole = kept.added.empty();
    const Remainder remainder(source, isWhole ? nullptr : sourceOpener()(kept.added), false);
    const Coefficients before = projected(remainder);
    const Energy energy = isWhole ? before.energy : projected(source).energy;
    if (!energy.finite || !(energy.value > 0)) return std::nullopt;
    const double left = before.energy.value - 2 * product(head.outgoing, c, normalised(before)) +
                        product(head.outgoing, c, c);
    return 1 - left / energy.value;
}

std::optional<double> shareByCoefficients(const Representation& kept, const Brdf& source) {
    const CoefficientHead& head = kept.head;
    const std::vector<double> c = normalised(decoded(kept));
    const bool isUnchanged =
        kept.added.empty() && std::ranges::all_of(kept.steps, [](const RepresentationStep& step) {
            return step.change <= notShown;
        });
    if (isUnchanged)
        return head.energy.value > 0
                   ? std::optional(product(head.outgoing, c, c) / head.energy.value)
                   : std::nullopt;
    try {
        return shareOfChanged(kept, c, source);
    } catch (const NumericError&) {  // a bound of the evaluations that the file was made without
        return measuredShare(source, *reconstruct(kept, sourceOpener()), head.outgoing,
                             head.quantity);
    }
}

/// The quantity whose energy exists.
Quantity capturedQuantity(const CoefficientHead& head) {
    return head.energy.finite ? head.quantity : Quantity::brdfCosine;
}

std::string fitAgain(const FitCall& call, const std::string& model, std::vector<Setting> settings) {
    settings.insert(settings.begin(), {"FitOptions::model", model});
    return fmt::format(
        "{}", Call{.function = "fit", .subject = call.data, .settings = std::move(settings)});
}

/// The fit whose error is least, if that is a tenth below the poor fit's `own`.
std::optional<Poor> withLeast(std::optional<double> TriedFit::*error, std::string_view unit,
                              double own, const std::string& reason, const FitCall& call,
                              const std::vector<TriedFit>& fits) {
    constexpr double leastGain = 0.9;
    const auto errorOf = [&](const TriedFit& fit) { return (fit.*error).value_or(own); };
    const auto best = std::ranges::min_element(fits, {}, errorOf);
    // An error without bound is no gain over another.
    if (best == fits.end() || !std::isfinite(errorOf(*best)) || errorOf(*best) > leastGain * own)
        return std::nullopt;
    const bool same = best->loss.empty();
    return Poor{
        fmt::format("{}; {} by the loss {} has {} {:.3g} in place of {:.3g}", reason, best->model,
                    same ? call.loss : best->loss, unit, errorOf(*best), own),
        fitAgain(call, best->model,
                 same ? call.settings : std::vector<Setting>{{"FitOptions::loss", best->loss}})};
}

/// The model that explains most in units of the same loss, if that is 2 % more.
std::optional<Poor> withMostExplained(const std::string& reason, const FitCall& call,
                                      const std::vector<TriedFit>& fits) {
    constexpr double leastGain = 0.02;
    const auto explained = [](const TriedFit& fit) { return fit.loss.empty() ? fit.explained : 0; };
    const auto best = std::ranges::max_element(fits, {}, explained);
    if (best == fits.end() || explained(*best) < call.explained + leastGain) return std::nullopt;
    return Poor{
        fmt::format("{}; {} explains {} of the data, {} {}", reason, call.model,
                    percent(std::max(call.explained, 0.0)), best->model, percent(best->explained)),
        fitAgain(call, best->model, call.settings)};
}

}  // namespace

std::optional<int> sufficientOrder(const Brdf& source, const CoefficientHead& head) {
    const bool nested = !head.basis.empty() && bases::find(head.basis).nested &&
                        bases::find(head.basis).maxOrder >= trialOrder;
    try {
        const auto basis = bases::make(nested ? head.basis : "hsh", trialOrder);
        const Projection trial = hshfit::project(
            source, *basis, fewOf(head), {.quantity = head.quantity, .tolerance = trialTolerance});
        const Energy& energy = trial.coefficients.energy;
        if (!energy.finite || !(energy.value > 0)) return std::nullopt;
        const auto enough = std::ranges::find_if(
            trial.captured, [&](double c) { return c >= trialCaptured * energy.value; });
        if (enough == trial.captured.end()) return std::nullopt;
        return 1 + static_cast<int>(enough - trial.captured.begin());
    } catch (const NumericError&) {
        return std::nullopt;
    }
}

bool isAboutTheMirror(const Brdf& source) {
    const double within = std::cos(radians(20));
    const PairSample pairs = spreadPairs({.replicates = 2});
    const std::vector<double> f = evaluateOn(source, pairs);
    double near = 0, all = 0;
    for (std::size_t k = 0; k < f.size(); ++k) {
        const std::size_t p = k % pairs.size();
        const Direction wi = pairs.incoming(p), wo = pairs.outgoing(p);
        const double energy = pairs.weights[p] * std::pow(f[k] * wi.z * wo.z, 2);
        all += energy;
        const double half = (wi.z + wo.z) / std::hypot(wi.x + wo.x, wi.y + wo.y, wi.z + wo.z);
        if (half > within) near += energy;
    }
    return 2 * near > all;
}

std::string Poor::line() const {
    if (!better.empty()) return fmt::format("poor: {}; better: {}", reason, better);
    if (!toTry.empty()) return fmt::format("poor: {}; to try: {}", reason, toTry);
    return fmt::format("poor: {}; no form is known to do better", reason);
}

nlohmann::ordered_json poorJson(const Poor& poor) {
    nlohmann::ordered_json json = {{"reason", poor.reason}, {"better", poor.better}};
    if (!poor.toTry.empty()) json["to_try"] = poor.toTry;
    return json;
}

std::optional<double> capturedShare(const Projection& projection, const Brdf& source) {
    const Coefficients& c = projection.coefficients;
    if (!c.leastSquares && !c.energy.finite)
        return measuredShare(source, Reconstruction(c), c.outgoing, capturedQuantity(c));
    return hshfit::capturedShare(projection);
}

std::optional<double> capturedShare(const Coefficients& coefficients) {
    const Energy& energy = coefficients.energy;
    if (coefficients.leastSquares || !energy.finite || !(energy.value > 0)) return std::nullopt;
    const std::vector<double> c = normalised(coefficients);
    return product(coefficients.outgoing, c, c) / energy.value;
}

std::string poorContents(const Brdf& opened) {
    const auto* plain = dynamic_cast<const Reconstruction*>(&opened);
    if (!plain) return {};
    const auto share = capturedShare(plain->coefficients());
    if (!share || !poorReason(share, {})) return {};
    return fmt::format(
        "poor: {} of the energy of {} is captured, and pictures are of another material",
        percent(*share), plain->coefficients().source);
}

std::string unmeasuredContents(const Brdf& opened) {
    constexpr std::size_t viewers = 24, directions = 96;
    constexpr double least = 0.05;
    // Even in (x, y), by a spiral of the golden angle: as cos(theta) d omega, and as the normals of
    // a sphere in its picture.
    const auto spiral = [](std::size_t k, std::size_t count) {
        const double golden = pi * (3 - std::sqrt(5.0));
        const double sine = std::sqrt((static_cast<double>(k) + 0.5) / static_cast<double>(count));
        return directionFromAngles(std::asin(sine), golden * static_cast<double>(k));
    };
    std::vector<double> x, y, z;
    for (std::size_t k = 0; k < directions; ++k) {
        const Direction wi = spiral(k, directions);
        x.push_back(wi.x), y.push_back(wi.y), z.push_back(wi.z);
    }
    const DirectionBatch wi{x.data(), y.data(), z.data(), directions};
    const std::size_t channels = opened.channels().count();
    std::vector<double> f(channels * directions);
    std::vector<unsigned char> covered(directions);
    std::size_t absent = 0;
    for (std::size_t v = 0; v < viewers; ++v) {
        const Direction wo = spiral(v, viewers);
        opened.eval(wo, wi, f.data());
        opened.coverage(wo, wi, covered.data());
        for (std::size_t k = 0; k < directions; ++k) {
            bool black = covered[k] == 0;
            for (std::size_t c = 0; c < channels; ++c) black &= f[c * directions + k] == 0;
            absent += black ? 1 : 0;
        }
    }
    const double share = static_cast<double>(absent) / (viewers * directions);
    if (share < least) return {};
    return fmt::format(
        "{} of the pairs of directions that light a sphere were not measured, and are drawn black; "
        "a fitted model continues there",
        percent(share, 2));
}

std::optional<double> capturedShare(const Representation& kept, const Brdf& source,
                                    const std::optional<PairSummary>& pairs) {
    const CoefficientHead& head = kept.head;
    if (kept.kind() == Kind::outgoing && head.energy.finite)
        return shareByCoefficients(kept, source);
    const auto result = reconstruct(kept, sourceOpener());
    if (kept.kind() == Kind::halfway) return shareOverPairs(source, *result, pairs);
    return measuredShare(
        source, *result,
        kept.kind() == Kind::outgoing ? head.outgoing : comparedOutgoing(head.isotropic),
        capturedQuantity(head));
}

std::string_view capturedFunction(const Projection& projection) {
    return functionOf(capturedQuantity(projection.coefficients));
}

std::string_view capturedFunction(const Representation& kept) {
    return kept.kind() == Kind::halfway ? "f cos(theta_i) cos(theta_o)"
                                        : functionOf(capturedQuantity(kept.head));
}

std::string betterCall(const CoefficientHead& head, const Brdf& source, const std::string& output) {
    if (const auto order = sufficientOrder(source, head); order && *order > head.order) {
        const auto functions = static_cast<std::size_t>(*order) * static_cast<std::size_t>(*order);
        return determine(source, functions) ? callOf(coefficientsOf(*order, head), head, output)
                                            : callOfModel(head);
    }
    const bool all =
        head.outgoing.directions.empty() || head.outgoing.map != OutgoingSet::Map::direction;
    if (!all || !isAboutTheMirror(source)) return {};
    return callOfHalfway(head, source, output);
}

std::optional<Poor> judge(const Projection& projection, std::optional<double> captured,
                          const std::optional<PictureError>& picture, const Brdf& source,
                          const std::string& output) {
    const auto reason = poorReason(captured, picture);
    if (!reason) return std::nullopt;
    return poorWith(*reason, adviceBeside(projection.coefficients, nullptr, source, output));
}

std::optional<Poor> judge(const Representation& kept, std::optional<double> captured,
                          const std::optional<PictureError>& picture, const Brdf& source,
                          const std::string& output) {
    auto reason = poorReason(captured, picture);
    if (!reason) return std::nullopt;
    const bool halfway = kept.kind() == Kind::halfway;
    std::vector<Form> first;
    const auto worst = std::ranges::max_element(kept.steps, {}, &RepresentationStep::change);
    if (!halfway && worst != kept.steps.end() && worst->change > muchChanged) {
        *reason += fmt::format("; {} changes it by {}", worst->what, percent(worst->change));
        Form without = coefficientsOf(kept.head.order, kept.head);  // without any step
        without.kind = kept.kind();
        first.push_back(std::move(without));
    }
    return poorWith(*reason,
                    adviceBeside(kept.head, halfway ? &kept : nullptr, source, output, first));
}

std::optional<Poor> judge(const gpu::ErrorSplit& split, const std::optional<PictureError>& picture,
                          const gpu::Payload& payload, const Brdf& source, const std::string& path,
                          const std::string& folder) {
    const auto reason = poorReason(1 - split.total * split.total, picture);
    if (!reason) return std::nullopt;
    const CoefficientHead& head = payload.head;
    const Form plain = coefficientsOf(head.order, head);
    Form dense = plain;
    dense.outgoing = finer(head.outgoing);
    struct Cause {
        double share;
        std::string_view name;
        std::vector<Form> remedy;
    };
    const std::array<Cause, 4> causes{
        {{split.truncation, "truncation", {}},
         {split.form, "the form of the coefficients", {plain}},
         {split.interpolation, "interpolation between outgoing directions", {dense}},
         {split.quantisation, "storage", {}}}};
    const auto* const worst = std::ranges::max_element(causes, {}, &Cause::share);
    const std::string text = fmt::format("{}; most of the error of {} is {}", *reason,
                                         percent(split.total), worst->name);
    if (worst == &causes.back() && passes(plain, source))
        return Poor{text, fmt::format("{}", Call{.function = "exportCoefficients",
                                                 .subject = path,
                                                 .settings = {{"PackOptions::number", "float32"}},
                                                 .output = folder})};
    return poorWith(text, adviceBeside(head, nullptr, source, path, worst->remedy));
}

std::string adviceBeyondModels(const Brdf& data) {
    const std::size_t functions = halfwayFunctions(data.laws());
    if (determine(data, functions)) return {};
    const std::size_t pairs = *measuredPairs(data);
    return fmt::format(
        "more measurements, as {} of directions {} not determine the {} functions of the halfway "
        "form",
        pairs == 1 ? "1 pair" : fmt::format("{} pairs", pairs), pairs == 1 ? "does" : "do",
        functions);
}

std::optional<Poor> judgeFit(const std::optional<PictureError>& picture, const FitCall& call,
                             const std::function<std::vector<TriedFit>()>& tried) {
    constexpr double mostFactor = 2;
    const bool looksPoor = picture && picture->flip.mean > PoorBounds{}.flip;
    const bool isFarOff = call.factor > mostFactor;
    const std::optional<std::string> reason =
        isFarOff ? fmt::format("half of the samples are off by more than a factor of {:.3g}",
                               call.factor)
                 : poorReason(1 - call.relativeError * call.relativeError, picture);
    if (!reason) return std::nullopt;
    if (!looksPoor && !isFarOff && call.relativeError > 1 && call.loss != "cosine" &&
        call.loss != "l2")
        return Poor{
            .reason = fmt::format("{}; the error of f cos(theta_i) is {} of it, in peaks that "
                                  "the loss {} hardly sees",
                                  *reason, percent(call.relativeError), call.loss),
            .toTry = fitAgain(call, call.model, {{"FitOptions::loss", "cosine"}})};
    const std::vector<TriedFit> fits = tried();
    std::optional<Poor> better;
    if (looksPoor)
        better = withLeast(&TriedFit::flip, "FLIP", picture->flip.mean, *reason, call, fits);
    else if (isFarOff)
        better = withLeast(&TriedFit::factor, "a factor of", call.factor, *reason, call, fits);
    else
        better = withMostExplained(*reason, call, fits);
    if (better) return better;
    if (!call.otherwise.empty()) return Poor{*reason, {}, call.otherwise};
    CoefficientHead head;
    head.source = call.data;
    return Poor{*reason, {}, callOf({.kind = Kind::halfway}, head, "halfway.json")};
}

}  // namespace hshfit::jobs
