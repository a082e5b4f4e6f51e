#include <hshfit/projection/horizon.h>

#include <hshfit/wording.h>

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace hshfit::inline projection {
namespace {

constexpr double exponentTolerance = 0.01;
constexpr int azimuths = 24;
constexpr std::array<double, 3> heights = {1e-10, 1e-12, 1e-14};

}  // namespace

bool HorizonBehaviour::energyExists(Basis::Inner inner) const {
    const double limit = inner == Basis::Inner::solidAngle ? 0.5 : 1.0;
    return exponent < limit - exponentTolerance;
}

bool HorizonBehaviour::coefficientsExist() const {
    return exponent < 1 - exponentTolerance;
}

HorizonBehaviour horizonBehaviour(const Brdf& brdf, const Direction& wo, Quantity quantity) {
    constexpr std::size_t count = azimuths * heights.size();
    std::array<double, count> x, y, z;
    const double woAzimuth = azimuth(wo), cx = std::cos(woAzimuth), cy = std::sin(woAzimuth);
    static const std::array<Direction, azimuths> circle = [] {
        std::array<Direction, azimuths> points;
        for (int j = 0; j < azimuths; ++j)
            points[j] = directionFromAngles(pi / 2, 2 * pi * j / azimuths);
        return points;
    }();
    std::size_t k = 0;
    for (double mu : heights) {
        const double s = std::sqrt((1 - mu) * (1 + mu));
        for (int j = 0; j < azimuths; ++j, ++k) {
            x[k] = s * (cx * circle[j].x - cy * circle[j].y);
            y[k] = s * (cy * circle[j].x + cx * circle[j].y);
            z[k] = mu;
        }
    }
    const std::size_t channels = brdf.channels().count();
    std::vector<double> values(channels * count);
    brdf.eval(wo, {x.data(), y.data(), z.data(), count}, values.data());

    HorizonBehaviour behaviour;
    for (std::size_t c = 0; c < channels; ++c) {
        for (int j = 0; j < azimuths; ++j) {
            const auto at = [&](std::size_t h) {
                const double q = values[c * count + h * azimuths + j];
                return std::abs(quantity == Quantity::brdfCosine ? q * heights[h] : q);
            };
            const double high = at(1), low = at(2), higher = at(0);
            if (!(high > 0) || !(low > 0) || !(higher > 0)) continue;
            // Both steps have to agree, so that a mere slope of a smooth function does not count.
            const double a = std::min(std::log(low / high) / std::log(heights[1] / heights[2]),
                                      std::log(high / higher) / std::log(heights[0] / heights[1]));
            if (a > behaviour.exponent) {
                behaviour.exponent = a;
                behaviour.azimuth = woAzimuth + 2 * pi * j / azimuths;
            }
        }
    }
    return behaviour;
}

std::string divergenceReason(const HorizonBehaviour& behaviour, const Direction& wo,
                             Quantity quantity) {
    const bool cosine = quantity == Quantity::brdfCosine;
    return fmt::format(
        "{} grows like cos(theta_i)^-{:.2f} towards the horizon (theta_o = {:.6g}, phi_i = {:.6g} "
        "degrees), so that the integral of its square diverges{}",
        cosine ? "f cos(theta_i)" : "f", behaviour.exponent, degrees(polarAngle(wo)),
        degrees(std::remainder(behaviour.azimuth, 2 * pi)),
        cosine ? ""
               : fmt::format("; project f cos(theta_i) instead ({})",
                             Setting{"ProjectionOptions::quantity", "brdf_cosine"}));
}

}  // namespace hshfit::inline projection
