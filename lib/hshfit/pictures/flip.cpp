#include <hshfit/pictures/flip.h>

#include <hshfit/brdf/directions.h>
#include <hshfit/error.h>
#include <hshfit/pictures/lab.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace hshfit::inline pictures {
namespace {

using Triple = std::array<double, 3>;

/// Linear opponent colours.
Triple yCxCz(const Triple& rgb) {
    const auto [x, y, z] = relativeXyz(rgb);
    return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

Triple rgbFromYCxCz(const Triple& c) {
    const double y = (c[0] + 16) / 116;
    return rgbOfRelativeXyz({y + c[1] / 500, y, y - c[2] / 200});
}

/// L*a*b* whose chroma falls with luminance (Hunt 1952).
Triple huntAdjusted(const Triple& rgb) {
    const Lab lab = labOf(rgb);
    return {lab.lightness, 0.01 * lab.lightness * lab.a, 0.01 * lab.lightness * lab.b};
}

double hyab(const Triple& a, const Triple& b) {
    return std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]);
}

/// A picture with one value per pixel.
struct Plane {
    std::size_t width, height;
    std::vector<double> values;
};

Plane convolvedAlong(const Plane& plane, const std::vector<double>& kernel, bool rows) {
    Plane result = plane;
    const auto radius = static_cast<std::ptrdiff_t>(kernel.size() / 2);
    const auto width = static_cast<std::ptrdiff_t>(plane.width);
    const std::ptrdiff_t length = rows ? width : static_cast<std::ptrdiff_t>(plane.height);
    const std::ptrdiff_t step = rows ? 1 : width;
    for (std::ptrdiff_t k = 0; k < static_cast<std::ptrdiff_t>(plane.values.size()); ++k) {
        const std::ptrdiff_t at = rows ? k % width : k / width;
        double sum = 0;
        for (std::ptrdiff_t i = -radius; i <= radius; ++i) {
            const std::ptrdiff_t place = std::clamp<std::ptrdiff_t>(at + i, 0, length - 1);
            sum += kernel[static_cast<std::size_t>(i + radius)] *
                   plane.values[static_cast<std::size_t>(k + (place - at) * step)];
        }
        result.values[static_cast<std::size_t>(k)] = sum;
    }
    return result;
}

/// sum over i, j of across[i] down[j] plane(x + i, y + j).
Plane convolved(const Plane& plane, const std::vector<double>& across,
                const std::vector<double>& down) {
    return convolvedAlong(convolvedAlong(plane, across, true), down, false);
}

/// exp(-x^2 / spread) at the pixels from -radius to radius.
std::vector<double> gaussian(int radius, double spread) {
    std::vector<double> values;
    for (int x = -radius; x <= radius; ++x) values.push_back(std::exp(-x * x / spread));
    return values;
}

double sumOf(const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) sum += value;
    return sum;
}

/// The contrast sensitivity of a channel as a filter, by the paper's sum of two Gaussians
/// a sqrt(pi / b) exp(-pi^2 r^2 / b), r in degrees.
Plane seen(const Plane& plane, const Triple& a, const Triple& b, double perDegree) {
    constexpr double widest = 0.04;
    const int radius =
        static_cast<int>(std::ceil(3 * std::sqrt(widest / (2 * pi * pi)) * perDegree));
    Plane result{plane.width, plane.height, std::vector<double>(plane.values.size(), 0.0)};
    double total = 0;
    for (std::size_t i = 0; i < 2; ++i) {
        if (a[i] == 0) continue;
        const std::vector<double> kernel =
            gaussian(radius, b[i] * perDegree * perDegree / (pi * pi));
        const double factor = a[i] * std::sqrt(pi / b[i]);
        const Plane part = convolved(plane, kernel, kernel);
        for (std::size_t k = 0; k < part.values.size(); ++k)
            result.values[k] += factor * part.values[k];
        total += factor * sumOf(kernel) * sumOf(kernel);
    }
    for (double& value : result.values) value /= total;
    return result;
}

/// A picture as the features and colours that are compared.
struct Seen {
    std::vector<Triple> colours;        ///< Hunt-adjusted
    std::vector<double> edges, points;  ///< magnitudes of first and second derivatives
};

/// `kernel` with positive values that add up to 1, and negative ones to -1.
void balance(std::vector<double>& kernel) {
    double positive = 0, negative = 0;
    for (const double value : kernel) (value > 0 ? positive : negative) += std::abs(value);
    for (double& value : kernel) value /= value > 0 ? positive : negative;
}

std::vector<double> magnitudes(const Plane& luminance, const std::vector<double>& derivative,
                               const std::vector<double>& smooth) {
    const Plane x = convolved(luminance, derivative, smooth);
    const Plane y = convolved(luminance, smooth, derivative);
    std::vector<double> result;
    for (std::size_t k = 0; k < x.values.size(); ++k)
        result.push_back(std::hypot(x.values[k], y.values[k]));
    return result;
}

Seen seenPicture(const RgbPicture& picture, double perDegree) {
    const auto width = static_cast<std::size_t>(picture.width),
               height = static_cast<std::size_t>(picture.height), count = width * height;
    std::array<Plane, 3> opponent;
    opponent.fill({width, height, std::vector<double>(count)});
    for (std::size_t k = 0; k < count; ++k) {
        Triple rgb;
        for (std::size_t c = 0; c < 3; ++c)
            rgb[c] = std::clamp(static_cast<double>(picture.values[3 * k + c]), 0.0, 1.0);
        const Triple colour = yCxCz(rgb);
        for (std::size_t c = 0; c < 3; ++c) opponent[c].values[k] = colour[c];
    }
    Plane luminance = opponent[0];
    for (double& value : luminance.values) value = (value + 16) / 116;
    // Table 1 of the paper: achromatic, red to green, blue to yellow.
    opponent[0] = seen(opponent[0], {1, 0}, {0.0047, 1e-5}, perDegree);
    opponent[1] = seen(opponent[1], {1, 0}, {0.0053, 0.1}, perDegree);
    opponent[2] = seen(opponent[2], {34.1, 13.5}, {0.04, 0.025}, perDegree);
    Seen result;
    for (std::size_t k = 0; k < count; ++k) {
        Triple rgb =
            rgbFromYCxCz({opponent[0].values[k], opponent[1].values[k], opponent[2].values[k]});
        for (double& value : rgb) value = std::clamp(value, 0.0, 1.0);
        result.colours.push_back(huntAdjusted(rgb));
    }
    constexpr double featureWidth = 0.082;  // degrees
    const double deviation = 0.5 * featureWidth * perDegree;
    const int radius = static_cast<int>(std::ceil(3 * deviation));
    std::vector<double> smooth = gaussian(radius, 2 * deviation * deviation);
    std::vector<double> first = smooth, second = smooth;
    for (int x = -radius; x <= radius; ++x) {
        const auto i = static_cast<std::size_t>(x + radius);
        first[i] *= -x;
        second[i] *= x * x / (deviation * deviation) - 1;
    }
    const double sum = sumOf(smooth);
    for (double& value : smooth) value /= sum;
    balance(first);
    balance(second);
    result.edges = magnitudes(luminance, first, smooth);
    result.points = magnitudes(luminance, second, smooth);
    return result;
}

/// The distance of colours, from 0 to 1: the lower 0.4 of the range take 0.95 of it.
double colourError(double distance) {
    constexpr double power = 0.7, knee = 0.4, atKnee = 0.95;
    static const double most =
        std::pow(hyab(huntAdjusted({0, 1, 0}), huntAdjusted({0, 0, 1})), power);
    const double error = std::pow(distance, power), bend = knee * most;
    if (error < bend) return error * atKnee / bend;
    return atKnee + (error - bend) / (most - bend) * (1 - atKnee);
}

}  // namespace

std::vector<float> flip(const RgbPicture& reference, const RgbPicture& test,
                        const FlipOptions& options) {
    if (reference.width != test.width || reference.height != test.height)
        throw UsageError(fmt::format("pictures of {} x {} and {} x {} pixels cannot be compared",
                                     reference.width, reference.height, test.width, test.height));
    const Seen a = seenPicture(reference, options.pixelsPerDegree);
    const Seen b = seenPicture(test, options.pixelsPerDegree);
    std::vector<float> result;
    for (std::size_t k = 0; k < a.colours.size(); ++k) {
        const double colour = colourError(hyab(a.colours[k], b.colours[k]));
        const double feature = std::sqrt(
            std::max(std::abs(a.edges[k] - b.edges[k]), std::abs(a.points[k] - b.points[k])) /
            std::sqrt(2.0));
        result.push_back(static_cast<float>(std::pow(colour, 1 - feature)));
    }
    return result;
}

std::vector<double> flipExposures(std::vector<double> largest) {
    constexpr int most = 4;
    const double brightest =
        largest.empty() ? 0 : *std::max_element(largest.begin(), largest.end());
    std::erase_if(largest, [&](double value) { return !(value > unlitShare * brightest); });
    if (largest.empty()) return {0};
    const auto middle = largest.begin() + static_cast<std::ptrdiff_t>(largest.size() / 2);
    std::nth_element(largest.begin(), middle, largest.end());
    const double first = std::log2(shownAsWhite / *middle),
                 last = std::log2(shownAsWhite / brightest);
    const int count = std::clamp(1 + static_cast<int>(std::ceil((first - last) / 2)), 2, most);
    std::vector<double> stops;
    for (int k = 0; k < count; ++k) stops.push_back(first + (last - first) * k / (count - 1));
    return stops;
}

}  // namespace hshfit::inline pictures
