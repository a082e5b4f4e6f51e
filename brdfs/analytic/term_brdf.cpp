#include <brdfs/analytic/term_brdf.h>

#include <algorithm>
#include <cassert>
#include <limits>

namespace hshfit::brdfs {
namespace {

double valueAt(const Colour& colour, std::size_t channel) {
    return colour[colour.size() == 1 ? 0 : channel];
}

}  // namespace

Colour mapped(const Colour& a, const std::function<double(double)>& f) {
    Colour result;
    for (const double value : a) result.push_back(f(value));
    return result;
}

Colour mapped(const Colour& a, const Colour& b, const std::function<double(double, double)>& f) {
    Colour result;
    for (std::size_t c = 0; c < std::max(a.size(), b.size()); ++c)
        result.push_back(f(valueAt(a, c), valueAt(b, c)));
    return result;
}

double largest(const Colour& a) {
    return *std::ranges::max_element(a);
}

Colour overPi(const Colour& a) {
    return mapped(a, [](double value) { return value / pi; });
}

std::vector<Colour> eachInItsChannel(const Colour& colour, std::size_t count) {
    if (count == 1) return {colour};
    std::vector<Colour> weights;
    for (std::size_t c = 0; c < count; ++c) {
        weights.push_back(Colour(count, 0.0));
        weights.back()[c] = valueAt(colour, c);
    }
    return weights;
}

Lobe halfwayLobe(double widthX, double widthY) {
    const auto [narrow, wide] = std::minmax(widthX, widthY);
    return {.about = Lobe::About::halfway,
            .width = narrow,
            .axis = widthX > widthY ? Direction{1, 0, 0} : Direction{0, 1, 0},
            .spread = wide};
}

TermBrdf::TermBrdf(const Model& model, const Parameters& parameters, Laws laws,
                   const Colour& constant, const std::vector<Colour>& weights)
    : name_(model.name),
      model_(model.name),
      source_(model.source),
      laws_(laws),
      termCount_(weights.size()),
      known_(model.sampling ? model.sampling(parameters) : Known{}) {
    assert(weights.size() <= TermBatch::maxTerms);
    const std::string values = parameters.canonical();
    if (!values.empty()) name_ += ":" + values;

    std::size_t channels = constant.size();
    for (const Colour& weight : weights) channels = std::max(channels, weight.size());
    channels_ = channels == 1 ? Channels::grey() : Channels::rgb();
    for (std::size_t c = 0; c < channels; ++c) {
        constant_.push_back(valueAt(constant, c));
        for (const Colour& weight : weights) weights_.push_back(valueAt(weight, c));
    }
}

TermBatch TermBrdf::batch(const Direction& wo, const DirectionBatch& wi, double* out) const {
    return {wo, wi, out, constant_.size(), termCount_, constant_.data(), weights_.data()};
}

void TermBrdf::eval(const Direction& wo, DirectionBatch wi, double* out) const {
    if (wo.z > 0)
        evalBatch(batch(wo, wi, out));
    else
        std::fill_n(out, constant_.size() * wi.count, 0.0);
}

void TermBrdf::evalScalar(const Direction& wo, DirectionBatch wi, double* out) const {
    if (wo.z > 0)
        evalBatchScalar(batch(wo, wi, out));
    else
        std::fill_n(out, constant_.size() * wi.count, 0.0);
}

std::vector<Fact> TermBrdf::facts() const {
    return {{"model", model_}, {"source", source_}};
}

double atMostLargest(double value) {
    return std::min(value, std::numeric_limits<double>::max());
}

}  // namespace hshfit::brdfs
