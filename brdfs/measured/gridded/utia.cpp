#include <brdfs/measured/gridded/angle_block.h>
#include <brdfs/measured/gridded/utia.h>
#include <hshfit/error.h>

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace hshfit::brdfs {
namespace {

constexpr double thetaStep = 15, phiStep = 7.5;  // degrees
constexpr double lastTheta = 75;

/// The value, with 0 for negative values and for the NaN of an overflow.
double clamped(double value) {
    return value > 0 ? std::min(value, std::numeric_limits<double>::max()) : 0;
}

}  // namespace

/// The position of a direction among the nodes. Its t in theta exceeds 1 past the last node.
struct UtiaBrdf::Place {
    std::array<std::size_t, 4> node;  ///< (low, low), (low, high), (high, low), (high, high)
    std::array<double, 4> weight;
};

UtiaBrdf::Place UtiaBrdf::place(double theta, double phi) const {
    const double along = degrees(theta) / thetaStep;
    const auto low = std::min(static_cast<std::size_t>(along), thetas - 2);
    double t = along - static_cast<double>(low);
    if (options_.beyond == UtiaOptions::Beyond::constant) t = std::min(t, 1.0);
    const Between p = aroundCircle(degrees(phi) / phiStep, phis);
    const std::size_t row = phis * low;
    return {{row + p.low, row + p.high, row + phis + p.low, row + phis + p.high},
            {(1 - t) * (1 - p.t), (1 - t) * p.t, t * (1 - p.t), t * p.t}};
}

/// f for the incoming direction of a node.
inline UtiaBrdf::Value UtiaBrdf::seenFrom(const Place& wo, std::size_t node) const {
    const Value* row = table_.data() + node * nodes;
    Value sum = {};
    for (std::size_t i = 0; i < 4; ++i) {
        const Value& value = row[wo.node[i]];
        for (int c = 0; c < 4; ++c) sum.rgb[c] += wo.weight[i] * value.rgb[c];
    }
    return sum;
}

// wo is constant over a batch: for a large batch, the table is first interpolated at wo for
// every node of wi. Both paths add the same products in the same order.
void UtiaBrdf::eval(const Direction& wo, DirectionBatch wi, double* out) const {
    if (!(wo.z > 0)) {
        std::fill_n(out, 3 * wi.count, 0.0);
        return;
    }
    AngleBlock angles;
    angles.set(wo);
    const Place outgoing = place(angles.theta[0], angles.phi[0]);
    std::vector<Value> seen;
    if (wi.count >= nodes / 4) {
        seen.resize(nodes);
        for (std::size_t n = 0; n < nodes; ++n) seen[n] = seenFrom(outgoing, n);
    }
    for (std::size_t begin = 0; begin < wi.count; begin += AngleBlock::size) {
        const std::size_t count = std::min(AngleBlock::size, wi.count - begin);
        angles.set(wi, begin, count);
        for (std::size_t k = 0; k < count; ++k) {
            double* to = out + begin + k;
            Value sum = {};
            if (wi.z[begin + k] > 0) {
                const Place at = place(angles.theta[k], angles.phi[k]);
                for (std::size_t i = 0; i < 4; ++i) {
                    const Value value =
                        seen.empty() ? seenFrom(outgoing, at.node[i]) : seen[at.node[i]];
                    for (int c = 0; c < 4; ++c) sum.rgb[c] += at.weight[i] * value.rgb[c];
                }
            }
            for (std::size_t c = 0; c < 3; ++c) to[c * wi.count] = clamped(sum.rgb[c]);
        }
    }
}

void UtiaBrdf::coverage(const Direction& wo, DirectionBatch wi, unsigned char* covered) const {
    const double lowest = std::cos(radians(lastTheta)) - 1e-12;
    for (std::size_t k = 0; k < wi.count; ++k) {
        covered[k] = wo.z >= lowest && wi.z[k] >= lowest;
    }
}

std::vector<double> UtiaBrdf::kinks(const Direction&) const {
    std::vector<double> heights;
    for (std::size_t i = 1; i < thetas; ++i) {
        heights.push_back(std::cos(radians(thetaStep * static_cast<double>(i))));
    }
    return heights;
}

std::vector<Axis> UtiaBrdf::axes() const {
    const double lastPhi = 360 - phiStep;
    return {{"theta_i", "degrees", thetas, 0, lastTheta, thetaStep},
            {"phi_i", "degrees", phis, 0, lastPhi, phiStep},
            {"theta_o", "degrees", thetas, 0, lastTheta, thetaStep},
            {"phi_o", "degrees", phis, 0, lastPhi, phiStep}};
}

}  // namespace hshfit::brdfs
