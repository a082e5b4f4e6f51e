#include <hshfit/representation/halfway/halfway.h>

#include <hshfit/error.h>
#include <hshfit/representation/halfway/internal/halfway_kernel.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hshfit::inline representation::inline halfway {
namespace {

[[noreturn]] void fail(const Representation& representation, const std::string& what) {
    throw InputError(fmt::format("coefficients of {}: {}", representation.head.source, what));
}

HalfwayTerms termsOf(const Representation& representation) {
    try {
        return HalfwayTerms(representation.halfway, halfwaySymmetryOf(representation.head));
    } catch (const UsageError& error) {
        fail(representation, error.what());
    }
}

HalfwayAxes axesOf(const Representation& representation) {
    const auto* content = representation.as<HalfwayArray>();
    if (!content) fail(representation, "the array 'halfway' is missing");
    const HalfwayLobe& lobe = content->lobe;
    for (const double width : {lobe.along, lobe.across}) {
        if (width >= narrowestLobe && width <= widestLobe) continue;
        fail(representation, fmt::format("a lobe of the halfway form is from {} to {} wide, not {}",
                                         narrowestLobe, widestLobe, width));
    }
    if (!(lobe.shelf >= leastShelf && lobe.shelf <= 1)) {
        fail(representation,
             fmt::format("the shelf of the halfway form's lobe is from {} to 1, not "
                         "{}",
                         leastShelf, lobe.shelf));
    }
    const bool round = lobe.along == lobe.across && lobe.turn == 0;
    if (!std::isfinite(lobe.turn) || (representation.head.isotropic && !round)) {
        fail(representation, "the lobe of an isotropic halfway form has one width and no turn");
    }
    return HalfwayAxes(lobe);
}

}  // namespace

HalfwayExpansion::HalfwayExpansion(const Representation& representation)
    : terms_(termsOf(representation)),
      axes_(axesOf(representation)),
      channels_(representation.head.channels.count()) {
    const auto& content = *representation.as<HalfwayArray>();
    const StoredArray& array = content.halfway;
    const std::vector<std::size_t> shape{channels_, terms_.size()};
    if (array.shape != shape || array.values.size() != channels_ * terms_.size()) {
        fail(representation,
             fmt::format("the array 'halfway' has to be {} channels x {} terms for orders {},{},{}",
                         channels_, terms_.size(), terms_.orders().half, terms_.orders().difference,
                         terms_.orders().azimuth));
    }
    values_.resize(array.values.size());
    for (std::size_t c = 0; c < channels_; ++c) {
        for (std::size_t t = 0; t < terms_.size(); ++t) {
            values_[t * channels_ + c] = array.values[c * terms_.size() + t];
        }
    }
    ceilings_ = content.ceilings;
    const auto holds = [](const HalfwayCeiling& ceiling) {
        return std::isfinite(ceiling.smooth) && std::isfinite(ceiling.lobe) && ceiling.top >= 0 &&
               std::isfinite(ceiling.top);
    };
    if (ceilings_.size() != channels_ || !std::ranges::all_of(ceilings_, holds)) {
        fail(representation,
             fmt::format("the halfway form needs {} ceilings of finite numbers, one a channel",
                         channels_));
    }
    layout_ = std::make_shared<const HalfwayLayout<double>>(halfwayLayoutOf<double>(*this));
}

void HalfwayExpansion::evaluate(const Direction& wo, DirectionBatch wi, double* out) const {
    constexpr std::size_t most = 64;
    std::array<std::array<double, most>, 3> one;
    const std::size_t filled = std::min(most, wi.count);
    std::fill_n(one[0].begin(), filled, wo.x);
    std::fill_n(one[1].begin(), filled, wo.y);
    std::fill_n(one[2].begin(), filled, wo.z);
    for (std::size_t first = 0; first < wi.count; first += most) {
        const std::size_t count = std::min(most, wi.count - first);
        evaluateHalfwayPairs(*layout_, {wi.x + first, wi.y + first, wi.z + first, count},
                             {one[0].data(), one[1].data(), one[2].data(), count}, wi.count,
                             out + first);
    }
}

}  // namespace hshfit::inline representation::inline halfway
