#include <hshfit/representation/halfway/internal/halfway_samples.h>

#include <hshfit/error.h>

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hshfit::inline representation::inline halfway {
namespace {

/// The start of the pairs held out in the sequence: no fit gets that far.
constexpr std::size_t heldOutStart = std::size_t{1} << 32;

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
constexpr double horizonDecades = 4, slopeDecades = 5, greatestSlope = 10;

/// wo towards the horizon; wi likewise, or the mirror image of wo at a half vector about the
/// normal.
DirectionPair towardsHorizon(double a, double b, double c, double d, bool mirror) {
    const auto low = [](double x) { return 1 - std::pow(10, -horizonDecades * x); };
    const Direction wo = onHemisphere(low(a), d);
    if (!mirror) return {onHemisphere(low(b), c), wo};
    const double slope = greatestSlope * std::pow(10, -slopeDecades * b);
    const Direction h = directionFromAngles(std::atan(slope), 2 * pi * c);
    const double twice = 2 * dot(wo, h);
    return {{twice * h.x - wo.x, twice * h.y - wo.y, twice * h.z - wo.z}, wo};
}

HalfwaySpread spreadOf(HalfwayPart part, std::size_t n) {
    if (part == HalfwayPart::heldOut) return HalfwaySpread::uniform;
    if (n % 4 == 3) return HalfwaySpread::axes;
    return n % 8 == 2 ? HalfwaySpread::horizon : HalfwaySpread::uniform;
}

DirectionPair pairAt(const Sequence& sequence, std::size_t n, bool isotropic,
                     HalfwaySpread spread) {
    const double a = sequence.at(n, 0), b = sequence.at(n, 1), c = sequence.at(n, 2);
    const double d = isotropic ? 0 : sequence.at(n, 3);
    if (spread == HalfwaySpread::uniform) return {onHemisphere(a, c), onHemisphere(b, d)};
    if (spread == HalfwaySpread::horizon) return towardsHorizon(a, b, c, d, n / 8 % 2 == 1);
    const double u = 1 - std::cos(pi / 2 * a);
    const double thetaHalf = 2 * std::asin(std::min(1.0, u * u / std::sqrt(2.0)));
    return fromHalfDifference(thetaHalf, 2 * pi * d, std::acos(b), 2 * pi * c);
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
    std::vector<DirectionPair> pairs;
    for (std::size_t n = first; n < last; ++n) {
        const HalfwaySpread spread = spreadOf(part, n);
        const std::size_t place = part == HalfwayPart::fitted ? n : heldOutStart + n;
        const DirectionPair pair = pairAt(sequence, place, isotropic, spread);
        if (!(pair.wi.z > 0 && pair.wo.z > 0)) continue;
        pairs.push_back(pair);
        samples.spread.push_back(spread);
        samples.cosines.push_back(pair.wi.z);
        samples.points.push_back(halfwayPoint(pair.wi, pair.wo));
        samples.places.push_back(envelopePoint(pair.wi, pair.wo));
    }
    const std::size_t channels = brdf.channels().count(), start = samples.values.size();
    samples.values.resize(start + pairs.size() * channels);
    double* values = samples.values.data() + start;
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, pairs.size(), 256), [&](const auto& range) {
            for (std::size_t k = range.begin(); k < range.end(); ++k) {
                const Direction& wi = pairs[k].wi;
                brdf.eval(pairs[k].wo, {&wi.x, &wi.y, &wi.z, 1}, values + k * channels);
            }
        });
    for (std::size_t k = 0; k < pairs.size() * channels; ++k) {
        if (!std::isfinite(values[k] * values[k])) refuse(brdf, pairs[k / channels], values[k]);
        values[k] = std::max(values[k], 0.0);
    }
}

}  // namespace hshfit::inline representation::inline halfway
