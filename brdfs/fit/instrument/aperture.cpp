#include <brdfs/fit/instrument/aperture.h>

#include <hshfit/error.h>
#include <hshfit/quadrature/quadrature.h>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace hshfit::brdfs {
namespace {

UsageError noAperture(std::string_view text) {
    return UsageError(fmt::format(
        "'{}' is no aperture; valid: cone:HALF or rectangle:HALFxHALF, half angles in degrees "
        "above 0 and below 90",
        text));
}

/// Takes a half angle from the front of the text, radians.
double takeHalfAngle(std::string_view& rest, std::string_view text) {
    double value = 0;
    const auto parsed = std::from_chars(rest.data(), rest.data() + rest.size(), value);
    if (parsed.ec != std::errc() || !(value > 0) || !(value < 90)) throw noAperture(text);
    rest.remove_prefix(static_cast<std::size_t>(parsed.ptr - rest.data()));
    return radians(value);
}

/// The plane across a nominal direction: along the polar angle, and across.
class Frame {
public:
    explicit Frame(const Direction& nominal)
        : nominal_(nominal), sine_(std::hypot(nominal.x, nominal.y)) {
        const bool pole = sine_ == 0;
        cosine_ = pole ? 1 : nominal.x / sine_;
        along_ = pole ? 0 : nominal.y / sine_;
    }
    double sine() const { return sine_; }
    /// The unit vector along nominal + u e_theta + v e_phi, or w nominal + …
    Direction at(double w, double u, double v) const {
        const double x = w * nominal_.x + u * nominal_.z * cosine_ - v * along_,
                     y = w * nominal_.y + u * nominal_.z * along_ + v * cosine_,
                     z = w * nominal_.z - u * sine_;
        const double length = std::sqrt(x * x + y * y + z * z);
        return {x / length, y / length, z / length};
    }

private:
    Direction nominal_;
    double sine_, cosine_, along_;
};

void add(PatchNodes& nodes, const Direction& direction, double solidAngle) {
    if (!(direction.z > 0)) return;
    nodes.directions.push_back(direction);
    nodes.weights.push_back(solidAngle * direction.z);
}

PatchNodes wholeCone(double half, const Frame& frame, std::size_t level) {
    PatchNodes nodes;
    const GaussRule& rule = gaussLegendre(static_cast<int>(level));
    // 1 - cos(half) without cancellation.
    const double span = 2 * std::pow(std::sin(half / 2), 2);
    const std::size_t azimuths = 4 * level;
    for (std::size_t i = 0; i < level; ++i) {
        const double less = span * (1 + rule.nodes[i]) / 2, height = 1 - less;
        const double radius = std::sqrt(less * (2 - less));
        const double weight = pi * span * rule.weights[i] / static_cast<double>(azimuths);
        for (std::size_t j = 0; j < azimuths; ++j) {
            const double turn =
                2 * pi * (static_cast<double>(j) + 0.5) / static_cast<double>(azimuths);
            add(nodes, frame.at(height, radius * std::cos(turn), radius * std::sin(turn)), weight);
        }
    }
    return nodes;
}

/// d(omega) of d(u) d(v) on the plane at distance 1.
double solidAngleOf(double u, double v) {
    const double square = 1 + u * u + v * v;
    return 1 / (square * std::sqrt(square));
}

/// The horizon lies at u = `horizon` on the plane at distance 1.
PatchNodes cutCone(double half, double horizon, const Frame& frame, std::size_t level) {
    PatchNodes nodes;
    const GaussRule& rule = gaussLegendre(static_cast<int>(2 * level));
    const double radius = std::tan(half), last = std::acos(-std::min(horizon / radius, 1.0));
    for (std::size_t i = 0; i < 2 * level; ++i) {
        const double turn = last * (1 + rule.nodes[i]) / 2, width = radius * std::sin(turn);
        const double u = -radius * std::cos(turn);
        for (std::size_t j = 0; j < 2 * level; ++j) {
            const double v = width * rule.nodes[j];
            const double area = width * width * rule.weights[j] * rule.weights[i] * last / 2;
            add(nodes, frame.at(1, u, v), area * solidAngleOf(u, v));
        }
    }
    return nodes;
}

PatchNodes rectangle(const Aperture& aperture, double horizon, const Frame& frame,
                     std::size_t level) {
    PatchNodes nodes;
    const GaussRule& rule = gaussLegendre(static_cast<int>(2 * level));
    const double low = -std::tan(aperture.half), high = std::min(-low, horizon);
    const double wide = std::tan(aperture.across);
    for (std::size_t i = 0; i < 2 * level; ++i) {
        const double u = low + (high - low) * (1 + rule.nodes[i]) / 2;
        for (std::size_t j = 0; j < 2 * level; ++j) {
            const double v = wide * rule.nodes[j];
            const double area = wide * rule.weights[j] * rule.weights[i] * (high - low) / 2;
            add(nodes, frame.at(1, u, v), area * solidAngleOf(u, v));
        }
    }
    return nodes;
}

}  // namespace

Aperture parseAperture(std::string_view text) {
    Aperture result;
    result.text = text;
    if (text.empty()) return result;
    const std::size_t colon = text.find(':');
    if (colon == text.npos) throw noAperture(text);
    const std::string_view shape = text.substr(0, colon);
    std::string_view rest = text.substr(colon + 1);
    if (shape != "cone" && shape != "rectangle") throw noAperture(text);
    result.half = takeHalfAngle(rest, text);
    result.shape = shape == "cone" ? Aperture::Shape::cone : Aperture::Shape::rectangle;
    if (result.shape == Aperture::Shape::rectangle) {
        if (!rest.starts_with('x')) throw noAperture(text);
        rest.remove_prefix(1);
        result.across = takeHalfAngle(rest, text);
    }
    if (!rest.empty()) throw noAperture(text);
    return result;
}

PatchNodes patchNodes(const Aperture& aperture, const Direction& nominal, std::size_t level) {
    if (!aperture.finite()) return {{nominal}, {1}};
    const Frame frame(nominal);
    constexpr double never = 1e300;
    const double horizon = frame.sine() > 0 ? nominal.z / frame.sine() : never;
    if (aperture.shape == Aperture::Shape::rectangle)
        return rectangle(aperture, horizon, frame, level);
    if (horizon >= std::tan(aperture.half)) return wholeCone(aperture.half, frame, level);
    return cutCone(aperture.half, horizon, frame, level);
}

}  // namespace hshfit::brdfs
