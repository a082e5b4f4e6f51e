#include <hshfit/lighting/internal/lobe_taps.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace hshfit::lighting {
namespace {

constexpr int scales = 240;  // of the tabulated moments, even in the logarithm
constexpr double widestScale = 30, narrowestScale = 1e-3;
// Between taps, in root mean squares of the kernel across a meridian. Beyond it, a lobe of few taps
// shows them under a sun (docs/explanation/lighting.md).
constexpr double mostStep = 1;

}  // namespace

LobeTaps::LobeTaps(std::size_t count) {
    assert(count % 2 == 1);
    double sum = 0;
    for (std::size_t k = 0; k < count; ++k) {
        const double x =
            count == 1 ? 0 : 4 * static_cast<double>(k) / static_cast<double>(count - 1) - 2;
        offsets.push_back(x);
        weights.push_back(std::exp(-x * x / 2));
        sum += weights.back();
    }
    for (double& weight : weights) weight /= sum;
}

double LobeTaps::meanCosine(double spread) const {
    double sum = 0;
    for (std::size_t k = 0; k < offsets.size(); ++k)
        sum += weights[k] * std::cos(offsets[k] * spread);
    return sum;
}

double LobeTaps::meanSquareSine(double spread) const {
    double sum = 0;
    for (std::size_t k = 0; k < offsets.size(); ++k)
        sum += weights[k] * std::pow(std::sin(offsets[k] * spread), 2);
    return sum;
}

SpreadSolver::SpreadSolver(const LobeKernel& kernel, const LobeTaps& taps) : taps_(taps) {
    for (int k = 0; k < scales; ++k) {
        const double share = static_cast<double>(k) / (scales - 1);
        logarithms_.push_back(std::log(widestScale) +
                              share * std::log(narrowestScale / widestScale));
        const LobeKernel::Moments moments = kernel.moments(std::exp(logarithms_.back()));
        cosines_.push_back(moments.meanCosine);
        squares_.push_back(moments.meanSquare);
    }
}

double SpreadSolver::lookUp(double cosine, const std::vector<double>& values) const {
    const auto after = std::ranges::upper_bound(cosines_, cosine) - cosines_.begin();
    if (after == 0) return values.front();
    if (after == scales) return values.back();
    const auto k = static_cast<std::size_t>(after);
    const double share = (cosine - cosines_[k - 1]) / (cosines_[k] - cosines_[k - 1]);
    return values[k - 1] + share * (values[k] - values[k - 1]);
}

double SpreadSolver::scaleFor(double cosine) const {
    return std::exp(lookUp(cosine, logarithms_));
}

// A kernel about a tap at the angle a, with mean square cosine q, has mean squares along and
// across the taps of q sin^2 a + (1 - q) / 2 cos^2 a and (1 - q) / 2.
SpreadLobe SpreadSolver::solve(double meanCosine, const LobeSpread& spread) const {
    SpreadLobe lobe{.meanCosine = meanCosine, .angle = spread.angle()};
    const double wanted = std::hypot(spread.difference, spread.product);
    if (taps_.offsets.size() == 1 || meanCosine >= cosines_.back()) return lobe;
    const double step = taps_.offsets[1] - taps_.offsets[0];
    double low = 0, high = pi / 4;
    for (int k = 0; k < 40; ++k) {
        const double middle = (low + high) / 2;
        const double kernel = meanCosine / taps_.meanCosine(middle);
        const double square = lookUp(kernel, squares_);
        const bool tooWide = kernel >= cosines_.back() ||
                             middle * step > mostStep * std::sqrt((1 - square) / 2) ||
                             taps_.meanSquareSine(middle) * (3 * square - 1) / 2 > wanted;
        (tooWide ? high : low) = middle;
    }
    lobe.spread = low;
    lobe.meanCosine = meanCosine / taps_.meanCosine(low);
    return lobe;
}

Direction turnedAside(const Direction& axis, const Direction& across, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    return {c * axis.x + s * across.x, c * axis.y + s * across.y, c * axis.z + s * across.z};
}

}  // namespace hshfit::lighting
