#include <hshfit/brdf/channel_view.h>

#include <algorithm>

namespace hshfit::inline brdf {

void ChannelView::convert(std::span<const double> from, std::span<double> to) const {
    for (std::size_t c = 0; c < to.size(); ++c) {
        to[c] = 0;
        for (std::size_t i = 0; i < from.size(); ++i) to[c] += look_.weights[c][i] * from[i];
    }
}

void ChannelView::eval(const Direction& wo, DirectionBatch wi, double* out) const {
    const std::size_t from = seen_->channels().count(), to = look_.weights.size();
    std::vector<double> values(from * wi.count);
    seen_->eval(wo, wi, values.data());
    std::fill_n(out, to * wi.count, 0.0);
    for (std::size_t c = 0; c < to; ++c) {
        for (std::size_t i = 0; i < from; ++i) {
            const double weight = look_.weights[c][i];
            const double* value = values.data() + i * wi.count;
            double* sum = out + c * wi.count;
            for (std::size_t k = 0; k < wi.count; ++k) sum[k] += weight * value[k];
        }
    }
}

std::vector<Fact> ChannelView::facts() const {
    std::vector<Fact> facts = seen_->facts();
    facts.insert(facts.end(), look_.facts.begin(), look_.facts.end());
    return facts;
}

}  // namespace hshfit::inline brdf
