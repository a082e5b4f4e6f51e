#include <brdfs/analytic/term_brdf.h>

#include <algorithm>
#include <array>
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

TermBrdf::TermBrdf(const Model& model, const Parameters& parameters, Laws laws,
                   const Colour& constant, const std::vector<Colour>& weights)
    : name_(model.name),
      model_(model.name),
      source_(model.source),
      laws_(laws),
      termCount_(weights.size()) {
    assert(weights.size() <= maxTerms);
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

void TermBrdf::eval(const Direction& wo, DirectionBatch wi, double* out) const {
    const std::size_t channels = constant_.size();
    if (!(wo.z > 0)) {
        std::fill(out, out + channels * wi.count, 0.0);
        return;
    }
    constexpr double most = std::numeric_limits<double>::max();
    std::array<double, maxTerms * blockSize> buffer;
    for (std::size_t start = 0; start < wi.count; start += blockSize) {
        const DirectionBatch part{wi.x + start, wi.y + start, wi.z + start,
                                  std::min(blockSize, wi.count - start)};
        if (termCount_ > 0) terms(wo, part, buffer.data());
        for (std::size_t i = 0; i < termCount_ * part.count; ++i)
            buffer[i] = buffer[i] > most ? most : buffer[i];
        for (std::size_t c = 0; c < channels; ++c) {
            const double* weights = weights_.data() + c * termCount_;
            double* values = out + c * wi.count + start;
            std::fill(values, values + part.count, constant_[c]);
            for (std::size_t t = 0; t < termCount_; ++t)
                for (std::size_t k = 0; k < part.count; ++k)
                    values[k] += weights[t] * buffer[t * part.count + k];
            for (std::size_t k = 0; k < part.count; ++k)
                values[k] = part.z[k] > 0 ? std::clamp(values[k], 0.0, most) : 0.0;
        }
    }
}

std::vector<Fact> TermBrdf::facts() const {
    return {{"model", model_}, {"source", source_}};
}

double bounded(double value) {
    return std::min(value, std::numeric_limits<double>::max());
}

}  // namespace hshfit::brdfs
