#include <hshfit/representation/halfway/internal/halfway_samples.h>

#include <hshfit/brdf/vectors.h>
#include <hshfit/error.h>

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hshfit::inline representation::inline halfway {
namespace {

/// The distance of the parts in the sequence: no fit gets that far.
constexpr std::size_t partStart = std::size_t{1} << 32;

/// Coordinate `axis` of point n of the sequence in `dimensions` dimensions.
class Sequence {
public:
    explicit Sequence(int dimensions) {
        double root = 1.5;
        for (int step = 0; step < 64; ++step) root = std::pow(1 + root, 1.0 / (dimensions + 1));
        for (int axis = 0; axis < dimensions; ++axis) {
            // In 64-bit fixed point: exact for every n.
            const double step = std::pow(root, -(axis + 1));
            steps_[axis] = static_cast<std::uint64_t>(std::ldexp(step, 64));
        }
    }
    double at(std::size_t n, int axis) const {
        const std::uint64_t sum = (std::uint64_t{1} << 63) + n * steps_[axis];
        return std::ldexp(static_cast<double>(sum >> 11) + 0.5, -53);
    }

private:
    std::array<std::uint64_t, 4> steps_{};
};

Direction onHemisphere(double height, double turn) {
    const double z = 1 - height, radius = std::sqrt(height * (2 - height));
    return {radius * std::cos(2 * pi * turn), radius * std::sin(2 * pi * turn), z};
}

/// Cosines and slopes from the greatest down by so many powers of ten.
constexpr double horizonDecades = 3, slopeDecades = 5, greatestSlope = 10, mirrorDecades = 4;

/// The mirror image of wo at h.
Direction mirrored(const Direction& wo, const Direction& h) {
    const double twice = 2 * dot(wo, h);
    return {twice * h.x - wo.x, twice * h.y - wo.y, twice * h.z - wo.z};
}

/// wo towards the horizon; wi likewise, or the mirror image of wo at a half vector about the
/// normal.
DirectionPair towardsHorizon(double a, double b, double c, double d, bool mirror) {
    const auto low = [](double x) { return 1 - std::pow(10, -horizonDecades * x); };
    const Direction wo = onHemisphere(low(a), d);
    if (!mirror) return {onHemisphere(low(b), c), wo};
    const double slope = greatestSlope * std::pow(10, -slopeDecades * b);
    return {mirrored(wo, directionFromAngles(std::atan(slope), 2 * pi * c)), wo};
}

/// Half of the lines: h moves from the normal to the horizon, half of the way within a tenth of it,
/// in the plane of incidence or across it. The other half: wi stays, wo moves in their plane.
DirectionPair onLine(double a, double b, double c, double d) {
    if (c >= 0.5) {
        const double side = c >= 0.75 ? pi : 0;
        return {directionFromAngles(pi / 2 * a, 2 * pi * d),
                directionFromAngles(pi / 2 * b, 2 * pi * d + side)};
    }
    const double thetaHalf = pi / 2 * a * a * a;
    const double phiDifference = std::floor(8 * c) * pi / 2;
    return fromHalfDifference(thetaHalf, 2 * pi * d, pi / 2 * b, phiDifference);
}

/// A pixel of the disc as which a sphere is seen, by its distance from the middle and its turn, and
/// a lamp to any side.
DirectionPair onSphere(double distance, double turn, double lamp, double side) {
    const double sine = std::sqrt(distance);
    const Direction wo{sine * std::cos(2 * pi * turn), sine * std::sin(2 * pi * turn),
                       std::sqrt(1 - distance)};
    const Direction u = normalised(cross(wo.z < 0.9 ? Direction{0, 0, 1} : Direction{1, 0, 0}, wo));
    const Direction v = cross(wo, u);
    const double angle = radians(5 + 15 * std::floor(6 * lamp));
    const Direction across = std::cos(2 * pi * side) * u + std::sin(2 * pi * side) * v;
    return {std::cos(angle) * wo + std::sin(angle) * across, wo};
}

/// The spread of a number of a sequence, in turns of 16: five uniform, six about the mirror
/// direction, two on lines, two towards the horizon, one on the ridge; every sixth of the ridge is
/// at normal incidence.
HalfwaySpread spreadOf(std::size_t n) {
    using enum HalfwaySpread;
    constexpr std::array turns{uniform, mirror, uniform, mirror, line,    mirror,  uniform, mirror,
                               ridge,   mirror, uniform, line,   grazing, grazing, uniform, mirror};
    const HalfwaySpread spread = turns[n % turns.size()];
    return spread == ridge && n / turns.size() % 6 == 5 ? normal : spread;
}

DirectionPair pairAt(const Sequence& sequence, std::size_t n, bool isotropic,
                     HalfwaySpread spread) {
    const double a = sequence.at(n, 0), b = sequence.at(n, 1), c = sequence.at(n, 2);
    const double d = isotropic ? 0 : sequence.at(n, 3);
    switch (spread) {
        case HalfwaySpread::uniform:
            break;
        case HalfwaySpread::mirror: {
            const Direction wo = onHemisphere(a, d);
            const double sine = std::pow(10, -mirrorDecades * b);
            return {mirrored(wo, directionFromAngles(std::asin(sine), 2 * pi * c)), wo};
        }
        case HalfwaySpread::line:
            return onLine(a, b, c, d);
        case HalfwaySpread::ridge: {
            const Direction wo = directionFromAngles(pi / 2 * a, 2 * pi * d);
            return {{-wo.x, -wo.y, wo.z}, wo};
        }
        case HalfwaySpread::grazing:
            return towardsHorizon(a, b, c, d, n / 16 % 2 == 1);
        case HalfwaySpread::normal: {
            const Direction other = directionFromAngles(pi / 2 * a, 2 * pi * c), top{0, 0, 1};
            return n / 96 % 2 == 0 ? DirectionPair{other, top} : DirectionPair{top, other};
        }
        case HalfwaySpread::seen:
            return onSphere(a, d, b, c);
    }
    return {onHemisphere(a, c), onHemisphere(b, d)};
}

[[noreturn]] void refuse(const Brdf& brdf, const DirectionPair& pair, double value) {
    throw NumericError(fmt::format(
        "{}: f is {} at theta_i {:.6g}, phi_i {:.6g}, theta_o {:.6g}, phi_o {:.6g} degrees; the "
        "halfway form needs finite values with finite squares",
        brdf.name(), value, degrees(polarAngle(pair.wi)), degrees(azimuth(pair.wi)),
        degrees(polarAngle(pair.wo)), degrees(azimuth(pair.wo))));
}

}  // namespace

void appendSamples(const Brdf& brdf, HalfwayPart part, std::size_t first, std::size_t last,
                   HalfwaySamples& samples) {
    const bool isotropic = brdf.laws().isotropic;
    const Sequence sequence(isotropic ? 3 : 4);
    const std::size_t before = samples.size(), start = static_cast<std::size_t>(part) * partStart;
    for (std::size_t k = first; k < last; ++k) {
        // Every fourth is seen; both kinds have numbers of their own.
        const bool seen = k % 4 == 3 && part != HalfwayPart::heldOutUniform;
        std::size_t n = k;
        HalfwaySpread spread = HalfwaySpread::uniform;
        if (seen) {
            n = partStart / 2 + k / 4;
            spread = HalfwaySpread::seen;
        } else if (part != HalfwayPart::heldOutUniform) {
            n = k - k / 4;
            spread = spreadOf(n);
        }
        const DirectionPair pair = pairAt(sequence, start + n, isotropic, spread);
        if (!(pair.wi.z > 0 && pair.wo.z > 0)) continue;
        samples.pairs.push_back(pair);
        samples.spread.push_back(spread);
    }
    const std::size_t channels = brdf.channels().count();
    samples.values.resize(samples.size() * channels);
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(before, samples.size(), 256), [&](const auto& range) {
            for (std::size_t k = range.begin(); k < range.end(); ++k) {
                const auto& [wi, wo] = samples.pairs[k];
                brdf.eval(wo, {&wi.x, &wi.y, &wi.z, 1}, samples.values.data() + k * channels);
            }
        });
    for (std::size_t k = before * channels; k < samples.values.size(); ++k) {
        double& value = samples.values[k];
        if (!std::isfinite(value * value)) refuse(brdf, samples.pairs[k / channels], value);
        value = std::max(value, 0.0);
    }
}

}  // namespace hshfit::inline representation::inline halfway
