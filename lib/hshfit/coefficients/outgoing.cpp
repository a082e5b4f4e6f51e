#include <hshfit/coefficients/outgoing.h>

#include <hshfit/error.h>
#include <hshfit/quadrature/quadrature.h>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <optional>
#include <tuple>

namespace hshfit::inline coefficients {
namespace {

/// Lowest elevation kept: 1 degree above the horizon. Texels beyond stand for what bilinear lookups
/// blend in from outside the disc; models with 1/cos(theta_o) would make them dominate their
/// neighbours further down (docs/explanation/accuracy.md measures it).
constexpr double horizonRing = 89 * (pi / 180);
/// A function, so that sets made before main() find it ready.
double horizonRadius() {
    return std::tan(horizonRing / 2);
}
constexpr int maxSize = 16384;

/// Inverse of p = (x, y)/(1 + z), with radii beyond the horizon ring clamped to it.
Direction fromParabolic(double px, double py) {
    const double r2 = px * px + py * py;
    if (r2 > horizonRadius() * horizonRadius()) {
        const double scale = std::sin(horizonRing) / std::sqrt(r2);
        return {px * scale, py * scale, std::cos(horizonRing)};
    }
    return {2 * px / (1 + r2), 2 * py / (1 + r2), (1 - r2) / (1 + r2)};
}

/// Integral of 4/(1 + x^2 + y^2)^2, the solid angle per area of the map, over y from 0 to `y`.
double columnSolidAngle(double x, double y) {
    const double a = 1 + x * x, root = std::sqrt(a);
    return 2 * (y / (a * (a + y * y)) + std::atan(y / root) / (a * root));
}

/// Solid angle of the part of [x0, x1] x [y0, y1] inside the unit disc; x0, y0 >= 0.
double clippedSolidAngle(double x0, double x1, double y0, double y1) {
    // The clip y <= sqrt(1 - x^2) has corners where the circle meets the sides.
    std::vector<double> breaks = {x0, x1};
    for (double y : {y0, y1}) {
        if (y < 1) breaks.push_back(std::sqrt((1 - y) * (1 + y)));
    }
    breaks.push_back(1);
    for (double& x : breaks) x = std::clamp(x, x0, x1);
    std::sort(breaks.begin(), breaks.end());
    const GaussRule& rule = gaussLegendre(32);
    double sum = 0;
    for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
        const double half = 0.5 * (breaks[k + 1] - breaks[k]);
        if (half <= 0) continue;
        for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
            const double x = breaks[k] + half * (1 + rule.nodes[i]);
            if (x >= 1) continue;
            const double top = std::min(y1, std::sqrt((1 - x) * (1 + x)));
            if (top <= y0) continue;
            sum += half * rule.weights[i] * (columnSolidAngle(x, top) - columnSolidAngle(x, y0));
        }
    }
    return sum;
}

/// The same for any rectangle: split at the axes, by symmetry.
double discSolidAngle(double x0, double x1, double y0, double y1) {
    if (x0 < 0 && x1 > 0) {
        return discSolidAngle(x0, 0, y0, y1) + discSolidAngle(0, x1, y0, y1);
    }
    if (y0 < 0 && y1 > 0) {
        return discSolidAngle(x0, x1, y0, 0) + discSolidAngle(x0, x1, 0, y1);
    }
    if (x1 <= 0) std::tie(x0, x1) = std::pair(-x1, -x0);
    if (y1 <= 0) std::tie(y0, y1) = std::pair(-y1, -y0);
    return clippedSolidAngle(x0, x1, y0, y1);
}

std::optional<double> parseNumber(std::string_view text) {
    double value = 0;
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (status != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
        return std::nullopt;
    }
    return value;
}

std::optional<int> parseCount(std::string_view text) {
    int value = 0;
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (status != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return value;
}

}  // namespace

OutgoingSet OutgoingSet::parabolic(int width, int height) {
    if (width < 4 || height < 4 || width > maxSize || height > maxSize) {
        throw UsageError(fmt::format("outgoing map of {}x{}; each side has to be 4 to {}", width,
                                     height, maxSize));
    }
    OutgoingSet set;
    set.map = Map::parabolic;
    set.width = width;
    set.height = height;
    const auto centre = [](int i, int n) { return (2.0 * i + 1 - n) / (n - 2); };
    const double dx = 1.0 / (width - 2), dy = 1.0 / (height - 2);
    set.solidAngles.resize(static_cast<std::size_t>(width) * height);
    const auto angleAt = [&](int i, int j) -> double& {
        return set.solidAngles[static_cast<std::size_t>(j) * width + i];
    };
    for (int j = 0; j < height; ++j) {
        for (int i = 0; i < width; ++i) {
            const double px = centre(i, width), py = centre(j, height);
            set.directions.push_back(fromParabolic(px, py));
            const int left = std::min(i, width - 1 - i), low = std::min(j, height - 1 - j);
            if (left != i || low != j) {
                angleAt(i, j) = angleAt(left, low);
            } else if (width == height && i < j) {
                angleAt(i, j) = angleAt(j, i);
            } else if (px * px + py * py < 1) {
                angleAt(i, j) = discSolidAngle(px - dx, px + dx, py - dy, py + dy);
            }
        }
    }
    // Slivers of texels whose centre lies outside go to the others in proportion.
    const double total = std::accumulate(set.solidAngles.begin(), set.solidAngles.end(), 0.0);
    for (double& angle : set.solidAngles) angle *= 2 * pi / total;
    return set;
}

OutgoingSet OutgoingSet::elevations(int count) {
    if (count < 2 || count > maxSize) {
        throw UsageError(
            fmt::format("{} outgoing elevations; the number has to be 2 to {}", count, maxSize));
    }
    OutgoingSet set;
    set.map = Map::elevations;
    set.width = count;
    const auto cosineAt = [&](double k) {
        const double r = k / (count - 0.5);
        return (1 - r * r) / (1 + r * r);
    };
    for (int k = 0; k < count; ++k) {
        set.directions.push_back(fromParabolic(k / (count - 0.5), 0));
        const double inner = k == 0 ? 1.0 : cosineAt(k - 0.5);
        set.solidAngles.push_back(2 * pi * (inner - cosineAt(k + 0.5)));
    }
    return set;
}

OutgoingSet OutgoingSet::direction(double theta, double phi) {
    OutgoingSet set;
    set.directions.push_back(directionFromAngles(theta, phi));
    set.solidAngles.push_back(1);
    return set;
}

OutgoingSet OutgoingSet::parse(std::string_view text) {
    if (const auto x = text.find('x'); x != text.npos) {
        const auto width = parseCount(text.substr(0, x)), height = parseCount(text.substr(x + 1));
        if (width && height) return parabolic(*width, *height);
    } else if (const auto comma = text.find(','); comma != text.npos) {
        const auto theta = parseNumber(text.substr(0, comma));
        const auto phi = parseNumber(text.substr(comma + 1));
        if (theta && phi) {
            if (*theta < 0 || *theta >= 90) {
                throw UsageError(fmt::format(
                    "outgoing direction '{}': theta has to be at least 0 and below 90 degrees",
                    text));
            }
            return direction(radians(*theta), radians(*phi));
        }
    } else if (const auto count = parseCount(text)) {
        return elevations(*count);
    }
    throw UsageError(fmt::format(
        "outgoing directions '{}': give WxH (parabolic map, 32x32), N (elevations, 16) or "
        "THETA,PHI in degrees (52,0)",
        text));
}

std::string OutgoingSet::spec() const {
    switch (map) {
        case Map::parabolic:
            return fmt::format("{}x{}", width, height);
        case Map::elevations:
            return fmt::format("{}", width);
        case Map::direction:
            break;
    }
    if (directions.empty()) return "none";
    // Ten digits: what degrees keep of a direction that came from them.
    return fmt::format("{:.10g},{:.10g}", degrees(polarAngle(directions[0])),
                       degrees(azimuth(directions[0])));
}

namespace {

struct Cell {
    int first;
    double fraction;
};

Cell cellOf(double position, int n) {
    const double clamped = std::clamp(position, 0.0, n - 1.0);
    const int first = std::min(static_cast<int>(clamped), n - 2);
    return {first, clamped - first};
}

void add(OutgoingLookup& to, std::size_t index, double weight) {
    if (weight == 0) return;
    to.index[to.count] = index;
    to.weight[to.count++] = weight;
}

}  // namespace

OutgoingLookup lookUpElevation(const OutgoingSet& set, double tangent) {
    OutgoingLookup result;
    const auto [first, fraction] = cellOf(tangent * (set.width - 0.5), set.width);
    add(result, first, 1 - fraction);
    add(result, first + 1, fraction);
    return result;
}

OutgoingLookup lookUp(const OutgoingSet& set, const Direction& wo) {
    OutgoingLookup result;
    if (set.map == OutgoingSet::Map::direction) {
        add(result, 0, 1);
        return result;
    }
    const double z = std::max(wo.z, 0.0), px = wo.x / (1 + z), py = wo.y / (1 + z);
    if (set.map == OutgoingSet::Map::elevations) {
        result = lookUpElevation(set, std::hypot(px, py));
        result.turn = azimuth(wo);
        return result;
    }
    const auto column = cellOf((px * (set.width - 2) + set.width - 1) / 2, set.width);
    const auto row = cellOf((py * (set.height - 2) + set.height - 1) / 2, set.height);
    for (int j : {0, 1}) {
        for (int i : {0, 1}) {
            add(result, static_cast<std::size_t>(row.first + j) * set.width + column.first + i,
                (j ? row.fraction : 1 - row.fraction) *
                    (i ? column.fraction : 1 - column.fraction));
        }
    }
    return result;
}

}  // namespace hshfit::inline coefficients
