#include <hshfit/representation/halfway/internal/halfway_bounds.h>

#include <hshfit/error.h>

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hshfit::inline representation::inline halfway {
namespace {

/// Points along the axes, close enough for powers of the cosine and for lobes of a roughness of
/// 0.05 (IsBracketedOverAllElevations in halfway_bound_test), and the cosine that stands for the
/// horizon: 89.9994 degrees.
constexpr int pointsAlongA = 96, pointsAlongB = 80;
/// Where f depends on the azimuth of wo too, there are half as many of each, so that evaluations
/// stay within a million.
constexpr int anisotropicDivisor = 2;
constexpr double leastCosine = 1e-5;
constexpr int azimuths = 48, turns = 6;
constexpr double leastFloor = 1e-30;
/// The part of the logarithm of boundFactor that is left to changes of f between the points and to
/// rounding to eight bits.
constexpr double margin = 0.1;
/// Sweeps that raise the envelope where it cuts f off, then such that lower it where it is too
/// high.
constexpr int raising = 60, lowering = 400;
/// Rounds in which nodes rise again where f is cut off and every point leaves room.
constexpr int filling = 40;
/// Of a shortage where f cos is small, this share is made up for in a sweep.
constexpr double leastImportance = 0.02;

struct Elevations {
    EnvelopePoint point;
    double thetaIncoming, thetaOutgoing;
};

/// Every pair of elevations that is looked at; a < 0 only if `both`.
std::vector<Elevations> elevationsOver(bool both, int divisor) {
    const int alongA = pointsAlongA / divisor, alongB = pointsAlongB / divisor;
    std::vector<Elevations> found;
    // By the root of the axis a: the ridge is where f changes most.
    const auto bOf = [](double lower) {
        return std::sqrt(std::sqrt(std::max(0.0, std::cos(lower))));
    };
    const auto add = [&](double a, double b, double lower, double upper) {
        found.push_back({{a * a, b}, lower, upper});
        if (both && a > 0) found.push_back({{-a * a, b}, upper, lower});
    };
    const double lowest = std::acos(leastCosine);
    for (int i = 0; i <= alongA; ++i) {
        const double a = static_cast<double>(i) / alongA;
        const double apart = std::min(std::acos(1 - std::pow(a, 4)), lowest);
        for (int j = 0; j <= alongB; ++j) {
            const double cosine = std::pow(static_cast<double>(j) / alongB, 4);
            const double lower = std::acos(std::clamp(cosine, leastCosine, 1.0));
            // Below the least cosine f counts as it is there, down to b = 0.
            const double b = cosine < leastCosine ? static_cast<double>(j) / alongB : bOf(lower);
            if (lower >= apart) add(a, b, lower, lower - apart);
        }
        add(a, bOf(apart), apart, 0);
    }
    for (int j = 0; j <= alongB; ++j) {
        const double cosine = std::max(std::pow(static_cast<double>(j) / alongB, 4), leastCosine);
        add(std::sqrt(std::sqrt(1 - cosine)), bOf(std::acos(cosine)), std::acos(cosine), 0);
    }
    return found;
}

Direction at(double theta, double phi) {
    const double s = std::sin(theta);
    return {s * std::cos(phi), s * std::sin(phi), std::cos(theta)};
}

/// Raises `greatest` to f at wi and wo of these elevations at all azimuths.
void raise(const Brdf& brdf, double thetaIncoming, double thetaOutgoing, double* greatest) {
    const bool mirror = brdf.laws().mirrorSymmetric;
    const int around = brdf.laws().isotropic ? 1 : turns;
    std::vector<double> x, y, z;
    std::vector<double> values;
    for (int t = 0; t < around; ++t) {
        const double turn = 2 * pi * t / around;
        x.clear();
        y.clear();
        z.clear();
        const int count = around == 1 ? azimuths : azimuths / anisotropicDivisor;
        for (int k = 0; k < count; ++k) {
            // Quadratically towards the mirror direction, the last one being where wo is.
            const double from = pi * std::pow(static_cast<double>(k) / (count - 1), 2);
            for (const double phi : {pi + from, pi - from}) {
                const Direction wi = at(thetaIncoming, turn + phi);
                x.push_back(wi.x);
                y.push_back(wi.y);
                z.push_back(wi.z);
                if (mirror && around == 1) break;
            }
        }
        const std::size_t channels = brdf.channels().count();
        values.resize(channels * x.size());
        brdf.eval(at(thetaOutgoing, turn), {x.data(), y.data(), z.data(), x.size()}, values.data());
        for (std::size_t k = 0; k < values.size(); ++k) {
            if (!std::isfinite(values[k])) {
                throw NumericError(fmt::format(
                    "{}: f is {} at theta_i {:.6g}, theta_o {:.6g} degrees; the "
                    "halfway form needs finite values",
                    brdf.name(), values[k], degrees(thetaIncoming), degrees(thetaOutgoing)));
            }
            double& highest = greatest[k / x.size()];
            highest = std::max(highest, values[k]);
        }
    }
}

/// The points of one channel as rows over the nodes, each with the band that it has to be in.
class ChannelFit {
public:
    ChannelFit(const HalfwayBounds& bounds, std::size_t channel,
               const std::vector<HalfwayEnvelope::Mix>& mixes, std::size_t nodes)
        : mixes_(mixes), logs_(nodes, 0.0) {
        for (std::size_t s = 0; s < mixes.size(); ++s) {
            lower_.push_back(bounds.logs[s * bounds.channels + channel]);
            double squares = 0;
            for (const double w : mixes[s].weight) squares += w * w;
            squares_.push_back(squares);
            const double bright = std::exp(lower_.back()) * std::pow(bounds.points[s].b, 4);
            importance_.push_back(std::min(1.0, leastImportance + bright));
        }
    }

    std::vector<double> run() {
        start();
        for (int sweep = 0; sweep < raising; ++sweep) {
            for (std::size_t s = 0; s < mixes_.size(); ++s) {
                const double shortage = lower_[s] - value(s);
                if (shortage > 0) move(s, shortage * importance_[s]);
                lowerAt(s);
            }
        }
        for (int sweep = 0; sweep < lowering; ++sweep) {
            bool moved = false;
            for (std::size_t s = 0; s < mixes_.size(); ++s) moved |= lowerAt(s);
            if (!moved) break;
        }
        lowerAll();
        fill();
        return logs_;
    }

private:
    const double band = std::log(boundFactor) - margin;

    double value(std::size_t s) const {
        double sum = 0;
        for (std::size_t n = 0; n < 4; ++n) sum += mixes_[s].weight[n] * logs_[mixes_[s].node[n]];
        return sum;
    }
    void move(std::size_t s, double by) {
        for (std::size_t n = 0; n < 4; ++n) {
            logs_[mixes_[s].node[n]] += by * mixes_[s].weight[n] / squares_[s];
        }
    }
    bool lowerAt(std::size_t s) {
        const double excess = value(s) - (lower_[s] + band);
        if (excess > 1e-9) move(s, -excess);
        return excess > 1e-9;
    }
    /// Lowers the nodes of each point by the excess that the sweeps have left there.
    void lowerAll() {
        for (std::size_t s = 0; s < mixes_.size(); ++s) {
            const double excess = value(s) - (lower_[s] + band);
            if (!(excess > 0)) continue;
            for (std::size_t n = 0; n < 4; ++n) {
                // Nodes that two corners share are lowered once.
                const auto* begin = mixes_[s].node.data();
                if (std::find(begin, begin + n, mixes_[s].node[n]) == begin + n) {
                    logs_[mixes_[s].node[n]] -= excess;
                }
            }
        }
    }
    /// A sweep that lowers a point takes all of its nodes along, which may leave some of them lower
    /// than any point asks for. In each round a node rises by half of what its points lack, or of
    /// the room that they leave, whichever is less: weights are not negative, so that no point
    /// leaves its band.
    void fill() {
        std::vector<double> wanted(logs_.size()), room(logs_.size());
        for (int round = 0; round < filling; ++round) {
            std::ranges::fill(wanted, 0.0);
            std::ranges::fill(room, std::numeric_limits<double>::infinity());
            for (std::size_t s = 0; s < mixes_.size(); ++s) {
                const double at = value(s);
                const double shortage = lower_[s] - at, left = lower_[s] + band - at;
                for (std::size_t n = 0; n < 4; ++n) {
                    const double weight = mixes_[s].weight[n];
                    if (!(weight > 0)) continue;
                    const std::size_t node = mixes_[s].node[n];
                    wanted[node] = std::max(wanted[node], shortage * weight / squares_[s]);
                    // The nodes of a point rise together, and their weights sum to 1.
                    room[node] = std::min(room[node], left);
                }
            }
            bool moved = false;
            for (std::size_t node = 0; node < logs_.size(); ++node) {
                const double rise = std::min(wanted[node], room[node]) / 2;
                if (!(rise > 1e-6)) continue;
                logs_[node] += rise;
                moved = true;
            }
            if (!moved) return;
        }
    }
    /// Least squares to the middle of the band; nodes that no point touches follow the others.
    void start() {
        const auto count = static_cast<Eigen::Index>(logs_.size());
        Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(count, count);
        Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
        double mean = 0;
        for (const double l : lower_) mean += (l + band / 2) / static_cast<double>(lower_.size());
        for (std::size_t s = 0; s < mixes_.size(); ++s) {
            for (std::size_t n = 0; n < 4; ++n) {
                const auto row = static_cast<Eigen::Index>(mixes_[s].node[n]);
                right[row] += mixes_[s].weight[n] * (lower_[s] + band / 2 - mean);
                for (std::size_t m = 0; m < 4; ++m) {
                    gram(row, static_cast<Eigen::Index>(mixes_[s].node[m])) +=
                        mixes_[s].weight[n] * mixes_[s].weight[m];
                }
            }
        }
        gram.diagonal().array() += 1e-4;
        const Eigen::VectorXd solved = gram.ldlt().solve(right);
        for (Eigen::Index n = 0; n < count; ++n)
            logs_[static_cast<std::size_t>(n)] = mean + solved[n];
    }

    const std::vector<HalfwayEnvelope::Mix>& mixes_;
    std::vector<double> lower_, squares_, importance_, logs_;
};

}  // namespace

HalfwayBounds boundsOf(const Brdf& brdf, bool reciprocal, double floor) {
    const std::vector<Elevations> all =
        elevationsOver(!reciprocal, brdf.laws().isotropic ? 1 : anisotropicDivisor);
    HalfwayBounds bounds{
        .points = {}, .logs = {}, .channels = brdf.channels().count(), .reciprocal = reciprocal};
    for (const Elevations& each : all) bounds.points.push_back(each.point);
    bounds.logs.assign(all.size() * bounds.channels, std::max(floor, leastFloor));
    tbb::parallel_for(std::size_t{0}, all.size(), [&](std::size_t s) {
        double* greatest = bounds.logs.data() + s * bounds.channels;
        raise(brdf, all[s].thetaIncoming, all[s].thetaOutgoing, greatest);
        if (reciprocal) raise(brdf, all[s].thetaOutgoing, all[s].thetaIncoming, greatest);
    });
    for (double& value : bounds.logs) value = std::log(value);
    return bounds;
}

StoredArray fitEnvelope(const HalfwayBounds& bounds, std::size_t alongA, std::size_t alongB,
                        double ridge) {
    const std::size_t nodes = alongA * alongB;
    StoredArray array{.shape = {alongB, alongA, bounds.channels},
                      .values = std::vector<double>(nodes * bounds.channels)};
    const HalfwayEnvelope grid({array, ridge}, bounds.channels, bounds.reciprocal, "");
    std::vector<HalfwayEnvelope::Mix> mixes;
    for (const EnvelopePoint& point : bounds.points) mixes.push_back(grid.mixAt(point));
    tbb::parallel_for(std::size_t{0}, bounds.channels, [&](std::size_t c) {
        const std::vector<double> logs = ChannelFit(bounds, c, mixes, nodes).run();
        for (std::size_t n = 0; n < nodes; ++n) array.values[n * bounds.channels + c] = logs[n];
    });
    quantise(array, Precision::unorm8, "envelope");
    return array;
}

}  // namespace hshfit::inline representation::inline halfway
