#include <hshfit/representation/halfway/halfway.h>

#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline representation::inline halfway {
namespace {

HalfwayTerms termsOf(const Representation& representation) {
    try {
        return HalfwayTerms(representation.halfway, halfwaySymmetryOf(representation.head));
    } catch (const UsageError& error) {
        throw InputError(
            fmt::format("coefficients of {}: {}", representation.head.source, error.what()));
    }
}

}  // namespace

HalfwayExpansion::HalfwayExpansion(const Representation& representation)
    : terms_(termsOf(representation)), channels_(representation.head.channels.count()) {
    const auto fail = [&](const std::string& what) {
        throw InputError(fmt::format("coefficients of {}: {}", representation.head.source, what));
    };
    const auto* content = representation.as<HalfwayArray>();
    if (!content) fail("the array 'halfway' is missing");
    const StoredArray& array = content->halfway;
    const std::vector<std::size_t> shape{channels_, terms_.size()};
    if (array.shape != shape || array.values.size() != channels_ * terms_.size()) {
        fail(fmt::format("the array 'halfway' has to be {} channels x {} terms for orders {},{},{}",
                         channels_, terms_.size(), terms_.orders().half, terms_.orders().difference,
                         terms_.orders().azimuth));
    }
    values_.resize(array.values.size());
    for (std::size_t c = 0; c < channels_; ++c) {
        for (std::size_t t = 0; t < terms_.size(); ++t) {
            values_[t * channels_ + c] = array.values[c * terms_.size() + t];
        }
    }
    if (!content->envelope) return;
    envelope_ = HalfwayEnvelope(*content->envelope, channels_, representation.head.reciprocal,
                                fmt::format("coefficients of {}", representation.head.source));
}

void HalfwayExpansion::evaluate(const Direction& wo, DirectionBatch wi, double* out) const {
    std::vector<double> products(terms_.size()), sums(channels_);
    for (std::size_t k = 0; k < wi.count; ++k) {
        const bool above = wi.z[k] > 0 && wo.z > 0;
        std::fill(sums.begin(), sums.end(), 0.0);
        if (above) {
            terms_.evaluate(halfwayPoint({wi.x[k], wi.y[k], wi.z[k]}, wo), products.data());
            for (std::size_t t = 0; t < products.size(); ++t) {
                for (std::size_t c = 0; c < channels_; ++c) {
                    sums[c] += values_[t * channels_ + c] * products[t];
                }
            }
        }
        for (std::size_t c = 0; c < channels_; ++c) {
            out[c * wi.count + k] = std::max(0.0, std::expm1(sums[c]));
        }
        if (envelope_.empty() || !above) continue;
        const auto mix = envelope_.mixAt(envelopePoint({wi.x[k], wi.y[k], wi.z[k]}, wo));
        for (std::size_t c = 0; c < channels_; ++c) {
            double& f = out[c * wi.count + k];
            f = std::min(f, std::exp(envelope_.logAt(mix, c)));
        }
    }
}

}  // namespace hshfit::inline representation::inline halfway
