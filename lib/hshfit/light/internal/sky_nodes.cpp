#include <hshfit/light/internal/sky_nodes.h>

#include <hshfit/light/internal/node_levels.h>
#include <hshfit/light/sky.h>
#include <hshfit/quadrature/quadrature.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline light {
namespace {

constexpr int mostShrinks = 3;
constexpr double narrow = 1e-12;

/// Cuts [low, high] at `kink`, where it lies within, and at `shrinks` distances from it towards
/// each end, each a quarter of the one before.
std::vector<double> gradedCuts(double low, double high, double kink, int shrinks) {
    std::vector<double> cuts{low, high};
    if (kink >= low - narrow && kink <= high + narrow) {
        cuts.push_back(std::clamp(kink, low, high));
        for (int k = 1; k <= shrinks; ++k) {
            const double share = std::pow(0.25, k);
            cuts.push_back(kink + (low - kink) * share);
            cuts.push_back(kink + (high - kink) * share);
        }
    }
    std::ranges::sort(cuts);
    return cuts;
}

class SkyNodes {
public:
    SkyNodes(const SkyLight& light, const Frame& frame, int level, LightSamples& samples)
        : light_(light),
          frame_(frame),
          level_(level),
          samples_(samples),
          up_(frame.toLocal({0, 0, 1})),
          sun_(frame.toLocal(light.sun)),
          middle_(std::atan2(up_.y, up_.x)),
          kinked_(light.peaked()) {}

    void add() {
        const double touch = std::min(std::hypot(up_.x, up_.y), 1.0);
        for (const auto& [low, high] : {std::pair(0.0, touch), std::pair(touch, 1.0)}) {
            const std::vector<double> cuts =
                kinked_ ? gradedCuts(low, high, sun_.z, mostShrinks) : std::vector{low, high};
            for (std::size_t k = 0; k + 1 < cuts.size(); ++k) addPanel(cuts[k], cuts[k + 1]);
        }
    }

private:
    void addPanel(double low, double high) {
        if (high - low < narrow) return;
        const GaussRule& rule = gaussLegendre(nodesAtLevel(kinked_ ? 4 : 8, level_));
        for (std::size_t r = 0; r < rule.nodes.size(); ++r) {
            const double z = low + (high - low) * (1 + rule.nodes[r]) / 2;
            addRing(z, (high - low) * rule.weights[r] / 2);
        }
    }

    void addRing(double z, double weight) {
        const double s = std::sqrt((1 - z) * (1 + z)), across = s * std::hypot(up_.x, up_.y);
        // Sky where up.z z + across cos(phi - middle) > 0.
        const double edge = across > 0 ? std::acos(std::clamp(-up_.z * z / across, -1.0, 1.0))
                                       : (up_.z > 0 ? pi : 0);
        if (kinked_) {
            addSunArcs(z, s, edge, weight);
        } else {
            addArc(z, s, middle_ - edge, middle_ + edge, weight);
        }
        addArc(z, s, middle_ + edge, middle_ + 2 * pi - edge, weight);
    }

    /// The arc of sky in pieces that shrink towards the sun's azimuth, as far as the ring is close.
    void addSunArcs(double z, double s, double edge, double weight) {
        if (edge < narrow) return;
        const bool whole = edge > pi - 1e-9;
        double sunAzimuth = std::atan2(sun_.y, sun_.x);
        const double low = whole ? sunAzimuth : middle_ - edge, high = low + 2 * edge;
        sunAzimuth =
            low + (sunAzimuth - low) - 2 * pi * std::floor((sunAzimuth - low + narrow) / (2 * pi));
        const double distance = std::hypot(z - sun_.z, s - std::hypot(sun_.x, sun_.y));
        const double wide = 2 * edge * std::max(s, narrow);
        const int shrinks = std::clamp(
            static_cast<int>(std::ceil(std::log(wide / std::max(distance, narrow)) / std::log(4.))),
            0, mostShrinks);
        std::vector<double> cuts = gradedCuts(low, high, sunAzimuth, shrinks);
        if (whole) {  // the sun is at both ends
            const std::vector<double> more = gradedCuts(low, high, high, shrinks);
            cuts.insert(cuts.end(), more.begin(), more.end());
            cuts.push_back((low + high) / 2);
            std::ranges::sort(cuts);
        }
        const GaussRule& rule = gaussLegendre(nodesAtLevel(4, level_));
        for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
            const double half = (cuts[k + 1] - cuts[k]) / 2;
            if (half < narrow) continue;
            for (std::size_t j = 0; j < rule.nodes.size(); ++j) {
                addNode(z, s, cuts[k] + half * (1 + rule.nodes[j]),
                        weight * rule.weights[j] * half);
            }
        }
    }

    void addArc(double z, double s, double low, double high, double weight) {
        const double half = (high - low) / 2;
        if (half < narrow) return;
        const bool whole = half > pi - 1e-9;
        const int nodes = nodesAtLevel(16 * half / pi + 4, level_) * (whole ? 2 : 1);
        const GaussRule& rule = gaussLegendre(nodes);
        for (int j = 0; j < nodes; ++j) {
            const auto k = static_cast<std::size_t>(j);
            const double at = whole ? (2 * j + 1.0) / nodes - 1 : rule.nodes[k];
            const double share = whole ? 2.0 / nodes : rule.weights[k];
            addNode(z, s, (low + high) / 2 + half * at, weight * share * half);
        }
    }

    void addNode(double z, double s, double phi, double weight) {
        const Direction local{s * std::cos(phi), s * std::sin(phi), z};
        samples_.add(local, radianceOf(light_, frame_.toWorld(local)), weight);
    }

    const SkyLight& light_;
    const Frame& frame_;
    int level_;
    LightSamples& samples_;
    Direction up_, sun_;
    double middle_;
    bool kinked_;
};

}  // namespace

void addSkyNodes(const SkyLight& light, const Frame& frame, int level, LightSamples& samples) {
    SkyNodes(light, frame, level, samples).add();
}

}  // namespace hshfit::inline light
