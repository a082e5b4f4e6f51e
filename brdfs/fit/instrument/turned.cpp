#include <brdfs/fit/instrument/turned.h>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {
namespace {

/// The axis along which angles in the plane of incidence grow from the normal.
struct Plane {
    double x = 1, y = 0;

    Plane(double wiX, double wiY) {
        const double size = std::hypot(wiX, wiY);
        constexpr double normal = 1e-12;
        if (size > normal) x = wiX / size, y = wiY / size;
    }
    /// A direction, turned by an angle from the normal towards the axis.
    Direction turn(const Direction& from, double angle) const {
        constexpr double horizon = 1e-9;
        const double along = from.x * x + from.y * y;
        const double change = along * (std::cos(angle) - 1) + from.z * std::sin(angle);
        return {from.x + change * x, from.y + change * y,
                std::max(horizon, from.z * std::cos(angle) - along * std::sin(angle))};
    }
};

void turnWi(const Plane& plane, double angle, double& x, double& y, double& z) {
    const Direction to = plane.turn({x, y, z}, angle);
    x = to.x, y = to.y, z = to.z;
}

}  // namespace

FitSamples turned(const FitSamples& samples, std::span<const AngleZeros> zeros) {
    FitSamples result = samples;
    const auto sums = samples.sums ? std::make_shared<NodeSums>(*samples.sums) : nullptr;
    for (std::size_t k = 0; k < samples.size(); ++k) {
        const AngleZeros& own = zeros[zeros.size() == 1 ? 0 : k];
        const Plane plane(samples.wiX[k], samples.wiY[k]);
        turnWi(plane, own.incidence, result.wiX[k], result.wiY[k], result.wiZ[k]);
        result.wo[k] = plane.turn(samples.wo[k], -own.detector);
        if (!sums) continue;
        const NodeSums::Row& row = sums->rows[samples.sumRows[k]];
        for (std::size_t j = row.firstNode; j < row.firstNode + row.nodes; ++j) {
            turnWi(plane, own.incidence, sums->wiX[j], sums->wiY[j], sums->wiZ[j]);
            sums->wo[j] = plane.turn(sums->wo[j], -own.detector);
        }
    }
    if (sums) result.sums = sums;
    return result;
}

std::vector<double> cosineRatios(const FitSamples& turned, const FitSamples& stated,
                                 Cosines cosines) {
    std::vector<double> ratios;
    for (std::size_t k = 0; k < stated.size(); ++k)
        ratios.push_back(overCosines(cosines, stated.wiZ[k], stated.wo[k].z) /
                         overCosines(cosines, turned.wiZ[k], turned.wo[k].z));
    return ratios;
}

}  // namespace hshfit::brdfs
