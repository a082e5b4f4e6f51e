#include <hshfit/light/internal/cap_nodes.h>

#include <hshfit/brdf/vectors.h>
#include <hshfit/light/internal/node_levels.h>
#include <hshfit/quadrature/quadrature.h>
#include <hshfit/stop_request.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace hshfit::inline light {
namespace {

/// Rings about the axis in panels that end where the plane touches a ring; each ring is whole, or
/// an arc with Gauss nodes.
class CapNodes {
public:
    CapNodes(const Cap& cap, int order, int level, const EmitNode& emit)
        : cap_(cap), order_(order), level_(level), emit_(emit) {
        u_ = std::abs(cap.axis.z) < 0.9 ? Direction{0, 0, 1} : Direction{1, 0, 0};
        if (cap.above) {
            height_ = std::clamp(dot(cap.axis, *cap.above), -1.0, 1.0);
            const Direction across = cross(cap.axis, *cap.above);
            slope_ = std::sqrt(dot(across, across));
            if (slope_ > 1e-9) u_ = *cap.above;
        }
        u_ = u_ + -dot(u_, cap.axis) * cap.axis;
        u_ = 1 / std::sqrt(dot(u_, u_)) * u_;
        v_ = cross(cap.axis, u_);
    }

    void run() const {
        std::vector<double> ends{0, cap_.radius};
        if (cap_.above) {
            const double tilt = std::atan2(slope_, height_), touch = std::abs(pi / 2 - tilt);
            for (const double end : {touch, pi - touch})
                if (end > 1e-12 && end < cap_.radius - 1e-12) ends.push_back(end);
        }
        std::sort(ends.begin(), ends.end());
        for (std::size_t k = 0; k + 1 < ends.size(); ++k) panel(ends[k], ends[k + 1]);
    }

private:
    /// Half of the arc of a ring above the plane, about u.
    double halfArc(double chi) const {
        if (!cap_.above) return pi;
        const double across = std::sin(chi) * slope_, ahead = std::cos(chi) * height_;
        if (std::abs(ahead) >= across) return ahead > 0 ? pi : 0;
        return std::acos(std::clamp(-ahead / across, -1.0, 1.0));
    }

    void panel(double low, double high) const {
        const double middle = (low + high) / 2, half = (high - low) / 2;
        const double arc = halfArc(middle);
        if (arc <= 0) return;
        const bool whole = arc >= pi;
        const GaussRule& rule =
            gaussLegendre(nodesAtLevel(6 + order_ * half * (whole ? 0.8 : 1.2), level_));
        for (std::size_t r = 0; r < rule.nodes.size(); ++r) {
            // Arcs grow like a root from the ends of their panel: clustered there.
            const double t = rule.nodes[r];
            const double at = whole ? t : std::sin(pi / 2 * t);
            const double rate = whole ? 1 : pi / 2 * std::cos(pi / 2 * t);
            const double chi = middle + half * at;
            ring(chi, whole ? pi : halfArc(chi), std::sin(chi) * half * rate * rule.weights[r]);
        }
    }

    void ring(double chi, double arc, double weight) const {
        stopIfRequested();
        const double s = std::sin(chi), c = std::cos(chi);
        const bool whole = arc >= pi;
        const int count = nodesAtLevel(
            (whole ? 2 : 1.2 * arc / pi + 0.4) * order_ * std::min(1.0, s + .1) + (whole ? 8 : 6),
            level_);
        const GaussRule& rule = gaussLegendre(count);
        for (int j = 0; j < count; ++j) {
            const auto k = static_cast<std::size_t>(j);
            const double psi = arc * (whole ? (2 * j + 1.0) / count - 1 : rule.nodes[k]);
            const double share = arc * (whole ? 2.0 / count : rule.weights[k]);
            Direction d = c * cap_.axis + (s * std::cos(psi) * u_ + s * std::sin(psi) * v_);
            // Rings about the pole of the frame have one height, bit by bit.
            if (cap_.axis.z == 1) d.z = c;
            emit_(d, weight * share);
        }
    }

    Cap cap_;
    int order_, level_;
    const EmitNode& emit_;
    Direction u_, v_;
    double height_ = 1, slope_ = 0;  ///< of the axis to the plane: cosine and sine of its tilt
};

}  // namespace

void addCapNodes(const Cap& cap, int order, int level, const EmitNode& emit) {
    CapNodes(cap, order, level, emit).run();
}

}  // namespace hshfit::inline light
