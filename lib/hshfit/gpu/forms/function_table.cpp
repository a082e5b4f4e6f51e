#include <hshfit/gpu/forms/function_table.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace hshfit::gpu::inline forms {
namespace {

constexpr double filterSteps = 256;

double halfOf(const HalfwayAxes::Constants& k, double sine2, double cosine) {
    constexpr double bend = TablePlace::halfBend;
    const double x = std::log1p(k.xx * k.xx * sine2) * k.perLog;
    return (1 - bend) * std::pow(x, 0.45) + bend * (1 - std::cbrt(cosine));
}

double planeOf(double rho) {
    constexpr double bend = TablePlace::planeBend;
    return (1 - bend) * rho * rho * rho + bend * std::cbrt(rho);
}

/// The places between 0 and `last` where a rising function has the values of `count` nodes.
template <class Rising>
std::vector<double> nodesOf(std::size_t count, double last, const Rising& rising) {
    std::vector<double> nodes(count);
    for (std::size_t n = 0; n < count; ++n) {
        const double value = static_cast<double>(n) / static_cast<double>(count - 1);
        double low = 0, high = last;
        for (int step = 0; step < 60; ++step) {
            const double middle = (low + high) / 2;
            (rising(middle) < value ? low : high) = middle;
        }
        nodes[n] = (low + high) / 2;
    }
    return nodes;
}

/// m / (rho cos(theta_h)) and its place.
double horizonOf(double share) {
    return std::sqrt(std::max(0.0, 1 - std::sqrt(std::sqrt(share))));
}

/// The point with this theta_h, rho, and m / (rho cos(theta_h)).
HalfwayPoint pointAt(const HalfwayAxes::Constants& k, double angle, double rho, double share) {
    const double c = std::cos(angle), s = std::sin(angle);
    const double turn = std::max(0.0, std::acos(std::min(1.0, share * c)) - angle);
    HalfwayPoint p{};
    p.v = rho * std::cos(turn);
    p.kappa = rho * std::sin(turn);
    const double lower = std::cbrt(std::max(0.0, p.v * c - p.kappa * s)),
                 upper = std::cbrt(p.v * c + p.kappa * s);
    p.mean = (lower + upper) / 2;
    p.product = lower * upper;
    p.x = std::log1p(k.xx * k.xx * s * s) * k.perLog;
    return p;
}

/// Takes a sixteenth of the second difference along an axis off; the ends have the difference of
/// their neighbour. Linear interpolation is off by an eighth in the middle between nodes.
void lower(std::vector<double>& values, std::size_t count, std::size_t stride) {
    if (count < 3) return;
    std::vector<double> line(count);
    for (std::size_t first = 0; first < values.size(); ++first) {
        if (first / stride % count != 0) continue;
        for (std::size_t n = 0; n < count; ++n) line[n] = values[first + n * stride];
        for (std::size_t n = 0; n < count; ++n) {
            const std::size_t m = std::clamp(n, std::size_t{1}, count - 2);
            values[first + n * stride] -= (line[m - 1] - 2 * line[m] + line[m + 1]) / 16;
        }
    }
}

/// The sums at all nodes, [channel][horizon][plane][half].
std::vector<std::vector<double>> sumsAtNodes(const HalfwayExpansion& expansion,
                                             const TableSize& size) {
    const HalfwayAxes::Constants& k = expansion.axes().constants();
    const std::size_t channels = expansion.channels();
    const std::vector<double> angles = nodesOf(size.half, pi / 2, [&](double t) {
        return halfOf(k, std::sin(t) * std::sin(t), std::cos(t));
    });
    const std::vector<double> lengths = nodesOf(size.plane, 1, planeOf);
    const std::vector<double> shares =
        nodesOf(size.horizon, 1, [](double t) { return horizonOf(1 - t); });
    std::vector<std::vector<double>> sums(channels, std::vector<double>(size.nodes()));
    tbb::parallel_for(std::size_t{0}, size.horizon * size.plane, [&](std::size_t row) {
        for (std::size_t n = 0; n < size.half; ++n) {
            const std::vector<double> at = sumsAt(
                expansion,
                pointAt(k, angles[n], lengths[row % size.plane], 1 - shares[row / size.plane]));
            for (std::size_t c = 0; c < channels; ++c) sums[c][row * size.half + n] = at[c];
        }
    });
    return sums;
}

/// A place along an axis: the node before it and the weight of the next.
struct Between {
    std::size_t node;
    double weight;

    Between(double place, std::size_t count, bool filtered) {
        double at = std::clamp(place, 0.0, 1.0) * static_cast<double>(count - 1);
        if (filtered) at = std::round(at * filterSteps) / filterSteps;
        node = std::min(static_cast<std::size_t>(at), count - 2);
        weight = at - static_cast<double>(node);
    }
    double of(std::size_t corner) const { return corner == 0 ? 1 - weight : weight; }
};

}  // namespace

std::vector<double> sumsAt(const HalfwayExpansion& expansion, const HalfwayPoint& point) {
    std::vector<double> values(expansion.terms().size()), sums(expansion.channels(), 0.0);
    expansion.terms().evaluate(point, values.data());
    for (std::size_t t = 0; t < values.size(); ++t)
        for (std::size_t c = 0; c < sums.size(); ++c) sums[c] += expansion.value(t, c) * values[t];
    return sums;
}

TablePlace tablePlace(const HalfwayAxes& axes, const Direction& wi, const Direction& wo) {
    const double hx = wi.x + wo.x, hy = wi.y + wo.y, hz = wi.z + wo.z, gap = wo.z - wi.z;
    const double across = hx * hx + hy * hy;
    const double square = across + hz * hz + TablePlace::leastSquare;
    const double sine2 = across / square, cosine = hz / std::sqrt(square);
    const double rho =
        std::min(1.0, std::sqrt((square + gap * gap / (sine2 + TablePlace::leastSine2)) / 4));
    return {halfOf(axes.constants(), sine2, cosine), planeOf(rho),
            horizonOf(std::min(wi.z, wo.z) / (rho * cosine))};
}

FunctionTable::FunctionTable(const Representation& functions, const TableSize& size)
    : size_(size), axes_(functions.as<HalfwayArray>()->lobe) {
    assert(functions.head.isotropic && functions.head.bilateral && functions.head.reciprocal);
    assert(std::min({size.half, size.plane, size.horizon}) >= 2);
    std::vector<std::vector<double>> sums = sumsAtNodes(HalfwayExpansion(functions), size);
    const std::size_t groups = (sums.size() + 3) / 4, nodes = size.nodes();
    std::vector<double> numbers(4 * groups * nodes, 0.0);
    tbb::parallel_for(std::size_t{0}, sums.size(), [&](std::size_t c) {
        lower(sums[c], size.half, 1);
        lower(sums[c], size.plane, size.half);
        lower(sums[c], size.horizon, size.half * size.plane);
        for (std::size_t n = 0; n < nodes; ++n)
            numbers[(c / 4 * nodes + n) * 4 + c % 4] = sums[c][n];
    });
    texels_ = encode(numbers, static_cast<int>(size.half),
                     static_cast<int>(size.plane * size.horizon), groups, Number::float16);
    const std::vector<double> read = decode(texels_);
    values_.assign(read.begin(), read.end());
}

void FunctionTable::evaluate(const Direction& wi, const Direction& wo, Weights weights,
                             double* out) const {
    const bool filtered = weights == Weights::filtered;
    const TablePlace place = tablePlace(axes_, wi, wo);
    const Between x(place.half, size_.half, filtered), y(place.plane, size_.plane, filtered),
        z(place.horizon, size_.horizon, false);
    std::fill_n(out, 4 * groups(), 0.0);
    for (std::size_t corner = 0; corner < 8; ++corner) {
        const std::size_t i = corner & 1, j = corner >> 1 & 1, k = corner >> 2;
        const double weight = x.of(i) * y.of(j) * z.of(k);
        const std::size_t node =
            ((z.node + k) * size_.plane + y.node + j) * size_.half + x.node + i;
        for (std::size_t g = 0; g < groups(); ++g) {
            const float* const texel = &values_[4 * (g * size_.nodes() + node)];
            for (std::size_t c = 0; c < 4; ++c) out[4 * g + c] += weight * double{texel[c]};
        }
    }
}

}  // namespace hshfit::gpu::inline forms
