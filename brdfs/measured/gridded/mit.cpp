#include <brdfs/measured/gridded/angle_block.h>
#include <brdfs/measured/gridded/mit.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

namespace hshfit::brdfs {
namespace {

/// The number of evaluations between prefetching bins and using them.
constexpr std::size_t prefetchDistance = 4;

/// Whether it is a value: neither negative nor NaN nor infinite.
bool isValue(float v) {
    return v >= 0 && v <= std::numeric_limits<float>::max();
}

/// Bin centres have whole indices: bin i of n over [0, range] is centred at (i + 1/2) range/n.
double centreIndex(double angle, double range, std::size_t bins) {
    return angle * static_cast<double>(bins) / range - 0.5;
}

Between around(double angle, std::size_t bins) {
    const double index = centreIndex(angle, 2 * pi, bins);
    return aroundCircle(index < 0 ? index + static_cast<double>(bins) : index, bins);
}

}  // namespace

/// The sixteen bins around a pair of directions: eight pairs in phi_in.
struct MitBrdf::Corners {
    std::array<std::size_t, 8> row;
    std::array<double, 8> weight;
    Between phiIn;
};

struct MitBrdf::Outgoing {
    double theta, phi;
};

MitBrdf::Outgoing MitBrdf::outgoing(const Direction& wo) const {
    AngleBlock angles;
    angles.set(wo);
    return {angles.theta[0], angles.phi[0]};
}

inline MitBrdf::Corners MitBrdf::corners(const Outgoing& wo, double theta, double phi) const {
    double thetaOut = wo.theta, difference = wo.phi - phi;
    if (difference < 0) difference += 2 * pi;
    if (layout_.half && difference > pi) {
        std::swap(theta, thetaOut);
        phi = wo.phi;
        difference = 2 * pi - difference;
    }
    const Between in = alongLine(centreIndex(theta, pi / 2, layout_.thetaIn), layout_.thetaIn);
    const Between out =
        alongLine(centreIndex(thetaOut, pi / 2, layout_.thetaOut), layout_.thetaOut);
    const Between turn =
        layout_.half
            ? alongLine(centreIndex(difference, pi, layout_.phiDifference), layout_.phiDifference)
            : around(difference, layout_.phiDifference);
    Corners at{.row = {}, .weight = {}, .phiIn = around(phi, layout_.phiIn)};
    for (std::size_t i = 0; i < 8; ++i) {
        const std::size_t a = i & 4 ? in.high : in.low, b = i & 2 ? out.high : out.low;
        const std::size_t c = i & 1 ? turn.high : turn.low;
        at.row[i] = ((a * layout_.thetaOut + b) * layout_.phiDifference + c) * layout_.phiIn;
        at.weight[i] =
            (i & 4 ? in.t : 1 - in.t) * (i & 2 ? out.t : 1 - out.t) * (i & 1 ? turn.t : 1 - turn.t);
    }
    return at;
}

inline void MitBrdf::prefetch(const Corners& at) const {
    for (std::size_t c = 0; c < 3; ++c) {
        for (const std::size_t row : at.row) {
            __builtin_prefetch(bytes_.data() + MitLayout::headerBytes +
                               (c * layout_.cells() + row + at.phiIn.low) * sizeof(float));
        }
    }
}

double MitBrdf::averageOfValid(const Corners& at, std::size_t channel, double* total) const {
    double sum = 0, weight = 0;
    for (std::size_t i = 0; i < 16; ++i) {
        const double w = at.weight[i / 2] * (i % 2 == 0 ? 1 - at.phiIn.t : at.phiIn.t);
        if (w <= 0) continue;
        const std::size_t cell = at.row[i / 2] + (i % 2 == 0 ? at.phiIn.low : at.phiIn.high);
        const float v = raw(channel, cell);
        if (isValue(v)) {
            sum += w * v;
            weight += w;
        } else if (!std::isfinite(v)) {
            corrupt_.store(static_cast<std::int64_t>(channel * layout_.cells() + cell),
                           std::memory_order_relaxed);
        }
    }
    *total = weight;
    return weight > 0 ? sum / weight : 0;
}

inline double MitBrdf::interpolate(const Corners& at, std::size_t channel) const {
    double low = 0, high = 0;
    bool valid = true;
    for (std::size_t i = 0; i < 8; ++i) {
        const float a = raw(channel, at.row[i] + at.phiIn.low);
        const float b = raw(channel, at.row[i] + at.phiIn.high);
        valid = valid && isValue(a) && isValue(b);
        low += at.weight[i] * a;
        high += at.weight[i] * b;
    }
    if (valid) return low + at.phiIn.t * (high - low);
    double weight;
    return averageOfValid(at, channel, &weight);
}

void MitBrdf::eval(const Direction& wo, DirectionBatch wi, double* out) const {
    if (!(wo.z > 0)) {
        std::fill_n(out, 3 * wi.count, 0.0);
        return;
    }
    const Outgoing view = outgoing(wo);
    AngleBlock angles;
    std::array<Corners, AngleBlock::size> at;
    for (std::size_t begin = 0; begin < wi.count; begin += AngleBlock::size) {
        const std::size_t count = std::min(AngleBlock::size, wi.count - begin);
        angles.set(wi, begin, count);
        for (std::size_t k = 0; k < count; ++k) {
            at[k] = corners(view, angles.theta[k], angles.phi[k]);
        }
        for (std::size_t k = 0; k < count; ++k) {
            if (k + prefetchDistance < count) prefetch(at[k + prefetchDistance]);
            const bool above = wi.z[begin + k] > 0;
            for (std::size_t c = 0; c < 3; ++c) {
                out[c * wi.count + begin + k] = above ? scale_ * interpolate(at[k], c) : 0;
            }
        }
    }
}

void MitBrdf::coverage(const Direction& wo, DirectionBatch wi, unsigned char* covered) const {
    const Outgoing view = outgoing(wo);
    AngleBlock angles;
    for (std::size_t begin = 0; begin < wi.count; begin += AngleBlock::size) {
        const std::size_t count = std::min(AngleBlock::size, wi.count - begin);
        angles.set(wi, begin, count);
        for (std::size_t k = 0; k < count; ++k) {
            bool rests = wo.z > 0 && wi.z[begin + k] > 0;
            const Corners at = corners(view, angles.theta[k], angles.phi[k]);
            for (std::size_t c = 0; c < 3 && rests; ++c) {
                double weight;
                averageOfValid(at, c, &weight);
                rests = weight > 0;
            }
            covered[begin + k] = rests;
        }
    }
}

}  // namespace hshfit::brdfs
