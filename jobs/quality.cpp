#include "quality.h"

#include <hshfit/bases/catalog.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

namespace hshfit::jobs {
namespace {

using Kind = Representation::Kind;

std::string percent(double share) {
    return fmt::format("{:.3g} %", 100 * share);
}

Setting kindSetting(Kind kind) {
    return {"Form::kind", std::string(kindName(kind))};
}

/// The source projected once more, to the same file.
std::string projectedAgain(const CoefficientHead& head, std::vector<Setting> settings,
                           const std::string& output) {
    return fmt::format("{}", Call{.function = "writeRepresentation",
                                  .subject = head.source,
                                  .settings = std::move(settings),
                                  .output = output});
}

/// To twice the order: every band adds to the energy captured.
std::string toTwiceTheOrder(const CoefficientHead& head, const std::string& output) {
    std::vector<Setting> settings = {{"Form::basis", head.basis},
                                     {"Form::order", std::to_string(2 * head.order)},
                                     {"Form::outgoing", head.outgoing.spec()}};
    if (head.quantity == Quantity::brdfCosine) settings.push_back({"Form::quantity"});
    return projectedAgain(head, std::move(settings), output);
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

std::optional<Poor> judgeShare(double share, const CoefficientHead& head,
                               const std::string& output) {
    if (share >= leastCaptured) return std::nullopt;
    // The halfway form holds f, of isotropic BRDFs, at every direction.
    const bool fits = head.isotropic && head.quantity == Quantity::brdf &&
                      head.outgoing.map != OutgoingSet::Map::direction;
    return Poor{fmt::format("{} of the energy is captured", percent(share)),
                fits ? projectedAgain(head, {kindSetting(Kind::halfway)}, output)
                     : toTwiceTheOrder(head, output)};
}

/// By the squares of the coefficients of an orthonormal basis. None for other forms and bases.
std::optional<double> capturedBy(const Representation& kept) {
    const CoefficientHead& head = kept.head;
    if (kept.kind() != Kind::outgoing || !kept.added.empty() || !head.energy.finite ||
        !(head.energy.value > 0) || !bases::find(head.basis).orthonormal)
        return std::nullopt;
    const Coefficients c = decoded(kept);
    const std::size_t size = c.channels.count() * static_cast<std::size_t>(c.slots());
    double captured = 0;
    for (std::size_t k = 0; k < c.outgoing.size(); ++k) {
        const double* values = c.at(k, 0);
        captured +=
            c.outgoing.solidAngles[k] * std::inner_product(values, values + size, values, 0.0);
    }
    return captured / head.energy.value;
}

}  // namespace

std::string Poor::line() const {
    return fmt::format("poor: {}; better: {}", reason, better);
}

nlohmann::ordered_json poorJson(const Poor& poor) {
    return {{"reason", poor.reason}, {"better", poor.better}};
}

std::optional<Poor> judge(const Projection& projection, const std::string& output) {
    const Coefficients& c = projection.coefficients;
    if (c.leastSquares) {
        if (c.leastSquares->residual <= mostError) return std::nullopt;
        return Poor{
            fmt::format("the residual is {} of the samples", percent(c.leastSquares->residual)),
            projectedAgain(c, {kindSetting(Kind::halfway)}, output)};
    }
    if (!c.energy.finite || !(c.energy.value > 0) || projection.captured.empty())
        return std::nullopt;
    return judgeShare(projection.captured.back() / c.energy.value, c, output);
}

std::optional<Poor> judge(const Representation& kept, const std::string& output) {
    if (kept.kind() == Kind::halfway || kept.steps.empty()) return std::nullopt;
    const auto worst = std::ranges::max_element(kept.steps, {}, &RepresentationStep::change);
    if (!(worst->change > mostError)) {
        const auto share = capturedBy(kept);
        return share ? judgeShare(*share, kept.head, output) : std::nullopt;
    }
    // Without any step.
    std::vector<Setting> settings = {{"Form::basis", kept.head.basis},
                                     {"Form::order", std::to_string(kept.head.order)}};
    if (kept.kind() == Kind::basis) settings.insert(settings.begin(), kindSetting(kept.kind()));
    return Poor{fmt::format("{} changes it by {}", worst->what, percent(worst->change)),
                projectedAgain(kept.head, std::move(settings), output)};
}

std::optional<Poor> judge(const gpu::ErrorSplit& split, const gpu::Payload& payload,
                          const std::string& path, const std::string& folder) {
    if (split.total <= mostError) return std::nullopt;
    const CoefficientHead& head = payload.head;
    const std::vector<Setting> plain = {{"Form::basis", head.basis},
                                        {"Form::order", std::to_string(head.order)}};
    std::vector<Setting> dense = plain;
    dense.push_back({"Form::outgoing", finer(head.outgoing)});
    const Call wider{.function = "exportCoefficients",
                     .subject = path,
                     .settings = {{"PackOptions::number", "float32"}},
                     .output = folder};
    struct Cause {
        double share;
        std::string_view name;
        std::string better;
    };
    const std::array<Cause, 4> causes{
        {{split.truncation, "truncation", toTwiceTheOrder(head, path)},
         {split.form, "the form of the coefficients", projectedAgain(head, plain, path)},
         {split.interpolation, "interpolation between outgoing directions",
          projectedAgain(head, dense, path)},
         {split.quantisation, "storage", fmt::format("{}", wider)}}};
    const auto* const worst = std::ranges::max_element(causes, {}, &Cause::share);
    return Poor{
        fmt::format("the error is {} of f, most of it {}", percent(split.total), worst->name),
        worst->better};
}

std::optional<Poor> judgeFit(double explained, const std::string& data, const std::string& model) {
    if (explained >= leastCaptured) return std::nullopt;
    // A second lobe: the first alone is one of its sums, so that the loss cannot grow.
    const std::string second = model.starts_with("ggx") ? "eon" : "ggx";
    const Call wider{.function = "fit",
                     .subject = data,
                     .settings = {{"FitOptions::model", model + "+" + second}}};
    return Poor{fmt::format("the fit explains {} of the data", percent(std::max(explained, 0.0))),
                fmt::format("{}", wider)};
}

}  // namespace hshfit::jobs
