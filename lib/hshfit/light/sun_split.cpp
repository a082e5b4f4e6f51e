#include <hshfit/light/sun_split.h>

#include <hshfit/brdf/vectors.h>
#include <hshfit/error.h>
#include <hshfit/files/exr_picture.h>
#include <hshfit/light/internal/picture_filling.h>
#include <hshfit/light/picture_light.h>
#include <hshfit/quadrature/quadrature.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <set>
#include <unordered_map>
#include <utility>

namespace hshfit::inline light {
namespace {

constexpr double candidateShare = 0.1;  // of the largest luminance
constexpr double leastContrast = 100;   // of the sun and its surroundings
constexpr double darkShare = 1e-3;      // of the peak, where the surroundings are black
constexpr double widest = 5;            // degrees from the peak to the last of the sun's pixels
constexpr double widestPixels = 3;
constexpr double marginPixels = 4;  // beyond, for the pixels on the rim
constexpr std::size_t mostPixels = 65536;
constexpr int nodesAcross = 6;  // of a pixel, each way: rounding for pixels of a few degrees
constexpr std::pair<int, int> steps[] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};

using Place = std::pair<std::size_t, std::size_t>;  // row, column

double luminanceOf(const float* rgb) {
    return light::luminanceOf({rgb[0], rgb[1], rgb[2]});
}

struct Pixel {
    double luminance = 0;
    bool near = true;  ///< within the largest angle that a sun may have from its peak
};

/// Pixels by place.
class Pixels {
public:
    void add(const Place& place, const Pixel& pixel) { values_.emplace(key(place), pixel); }
    const Pixel* find(const Place& place) const {
        const auto found = values_.find(key(place));
        return found == values_.end() ? nullptr : &found->second;
    }

private:
    static std::uint64_t key(const Place& place) {
        return (static_cast<std::uint64_t>(place.first) << 32) | place.second;
    }
    std::unordered_map<std::uint64_t, Pixel> values_;
};

/// Calls visit(place, rgb) for each pixel of the used area.
void forEachPixel(const PictureLight& picture,
                  const std::function<void(const Place&, const float*)>& visit) {
    const std::size_t width = fileGeometryOf(picture).width;
    forEachRow(picture, [&](std::size_t row, std::span<const float> rgb) {
        for (std::size_t column = 0; column < width; ++column)
            visit({row, column}, rgb.data() + 3 * column);
    });
}

class Search {
public:
    explicit Search(const PictureLight& picture)
        : picture_(picture), geometry_(fileGeometryOf(picture)) {}

    /// The brightest pixel of the part with the largest flux.
    Place peak() {
        double most = 0;
        forEachPixel(picture_, [&](const Place& place, const float* rgb) {
            const double value = luminanceOf(rgb);
            if (value > most && used(place)) most = value;
        });
        Pixels bright;
        std::vector<Place> places;
        forEachPixel(picture_, [&](const Place& place, const float* rgb) {
            if (!(luminanceOf(rgb) >= candidateShare * most && most > 0) || !used(place)) return;
            if (places.size() == mostPixels)
                fail(
                    fmt::format("more than {} pixels have a tenth of its largest luminance or "
                                "more",
                                mostPixels));
            bright.add(place, {luminanceOf(rgb)});
            places.push_back(place);
        });
        if (places.empty()) fail("it is black");
        return brightestOf(largestPart(bright, places), bright);
    }

    /// The sun's pixels about its brightest one.
    std::vector<Place> pixelsAbout(const Place& peak, double& peakValue, double& around) {
        const Direction centre = directionAt(peak);
        const double radius = std::max(radians(widest), widestPixels * geometry_.pixelAngle());
        const double rim = radius + marginPixels * geometry_.pixelAngle();
        Pixels window;
        std::vector<std::pair<double, double>> ring;  // luminance, solid angle
        forEachPixel(picture_, [&](const Place& place, const float* rgb) {
            if (farOff(place.first, centre, std::max(2 * radius, rim))) return;
            const double angle = angleBetween(directionAt(place), centre);
            if (angle > std::max(2 * radius, rim) || !used(place)) return;
            if (angle > radius && angle <= 2 * radius)
                ring.emplace_back(luminanceOf(rgb), solidAngle(place));
            if (angle <= rim) window.add(place, {luminanceOf(rgb), angle <= radius});
        });
        peakValue = window.find(peak)->luminance;
        around = median(std::move(ring));
        if (!(peakValue >= leastContrast * around))
            fail(
                fmt::format("its brightest pixel that could be one, column {}, row {}, has {:.3g} "
                            "times the luminance around it; a sun has {} times or more",
                            peak.second, peak.first, peakValue / around, leastContrast));
        const double threshold = around > 0 ? std::sqrt(peakValue * around) : darkShare * peakValue;
        return withNeighbours(connected(peak, threshold, window, radius), window, radius);
    }

    const PictureGeometry& geometry() const { return geometry_; }

    [[noreturn]] void fail(const std::string& why) const {
        throw InputError(fmt::format("{}: has no sun: {}", picture_.file, why));
    }

private:
    double solidAngle(const Place& place) const {
        return geometry_.solidAngle(place.second, place.first);
    }
    bool used(const Place& place) const { return solidAngle(place) > 0; }
    Direction directionAt(const Place& place) const {
        return geometry_.direction(static_cast<double>(place.second) + 0.5,
                                   static_cast<double>(place.first) + 0.5);
    }
    std::optional<Place> beside(const Place& place, int right, int down) const {
        const auto next = geometry_.neighbour(place.second, place.first, right, down);
        if (!next) return {};
        return Place((*next)[1], (*next)[0]);
    }

    /// Whether no pixel of a row can be that near; rows of other layouts than latlong may.
    bool farOff(std::size_t row, const Direction& centre, double angle) const {
        if (geometry_.layout != PictureLayout::latlong) return false;
        const double height = pi / static_cast<double>(geometry_.height);
        const double theta = (static_cast<double>(row) + 0.5) * height;
        return std::abs(theta - polarAngle(centre)) > angle + height;
    }

    static double median(std::vector<std::pair<double, double>> weighted) {
        std::ranges::sort(weighted);
        double total = 0, below = 0;
        for (const auto& [value, weight] : weighted) total += weight;
        for (const auto& [value, weight] : weighted)
            if ((below += weight) >= total / 2) return value;
        return 0;
    }

    std::vector<Place> largestPart(const Pixels& bright, const std::vector<Place>& places) const {
        std::set<Place> seen;
        std::vector<Place> largest;
        double most = -1;
        for (const Place& start : places) {
            if (!seen.insert(start).second) continue;
            std::vector<Place> part{start};
            double flux = 0;
            for (std::size_t at = 0; at < part.size(); ++at) {
                const Place place = part[at];
                flux += bright.find(place)->luminance * solidAngle(place);
                for (const auto& [right, down] : steps) {
                    const auto next = beside(place, right, down);
                    if (next && bright.find(*next) && seen.insert(*next).second)
                        part.push_back(*next);
                }
            }
            if (flux > most) most = flux, largest = std::move(part);
        }
        return largest;
    }

    static Place brightestOf(const std::vector<Place>& places, const Pixels& pixels) {
        return *std::ranges::max_element(
            places, {}, [&](const Place& place) { return pixels.find(place)->luminance; });
    }

    [[noreturn]] void failWide(double radius) const {
        fail(
            fmt::format("its brightest part goes on beyond {:.3g} degrees from its peak, as a "
                        "lamp or a window does",
                        degrees(radius)));
    }

    std::set<Place> connected(const Place& peak, double threshold, const Pixels& window,
                              double radius) const {
        std::set<Place> sun{peak};
        std::vector<Place> open{peak};
        while (!open.empty()) {
            const Place place = open.back();
            open.pop_back();
            for (const auto& [right, down] : steps) {
                const auto next = beside(place, right, down);
                if (!next || sun.contains(*next)) continue;
                const Pixel* pixel = window.find(*next);
                if (!pixel) failWide(radius);
                if (!(pixel->luminance > threshold)) continue;
                if (!pixel->near) failWide(radius);
                sun.insert(*next);
                open.push_back(*next);
                if (sun.size() > mostPixels)
                    throw InputError(fmt::format("{}: its sun covers more than {} pixels",
                                                 picture_.file, mostPixels));
            }
        }
        return sun;
    }

    /// The pixels and their neighbours across edges, on which the sun's rim may lie.
    std::vector<Place> withNeighbours(const std::set<Place>& sun, const Pixels& window,
                                      double radius) const {
        std::set<Place> all = sun;
        for (const Place& place : sun) {
            for (const auto& [right, down] : steps) {
                const auto next = beside(place, right, down);
                if (next && !window.find(*next)) failWide(radius);
                if (next) all.insert(*next);
            }
        }
        return {all.begin(), all.end()};
    }

    const PictureLight& picture_;
    PictureGeometry geometry_;
};

/// Nodes of a pixel in directions, with solid angles.
template <class Visit>
void forEachNode(const PictureGeometry& geometry, const FilledPixel& pixel, const Visit& visit) {
    const GaussRule& rule = gaussLegendre(nodesAcross);
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
        for (std::size_t j = 0; j < rule.nodes.size(); ++j) {
            const double column = static_cast<double>(pixel.column) + (1 + rule.nodes[i]) / 2;
            const double row = static_cast<double>(pixel.row) + (1 + rule.nodes[j]) / 2;
            visit(geometry.direction(column, row),
                  geometry.density(column, row) * rule.weights[i] * rule.weights[j] / 4);
        }
    }
}

/// The picture less the rest on the sun's pixels, as sums over all of them.
struct Moments {
    Rgb flux{};
    Direction vector{0, 0, 0};  ///< of flux times direction, over all channels
};

Moments momentsOf(const PictureGeometry& geometry, const FilledPixels& pixels,
                  const std::vector<Rgb>& excess) {
    Moments sums;
    for (std::size_t k = 0; k < pixels.size(); ++k) {
        const double all = 3 * meanOf(excess[k]);
        forEachNode(geometry, pixels[k], [&](const Direction& d, double solidAngle) {
            for (std::size_t c = 0; c < 3; ++c) sums.flux[c] += excess[k][c] * solidAngle;
            sums.vector.x += all * solidAngle * d.x;
            sums.vector.y += all * solidAngle * d.y;
            sums.vector.z += all * solidAngle * d.z;
        });
    }
    return sums;
}

/// 1 less the mean cosine about a direction, without cancellation.
double spreadAbout(const Direction& axis, const PictureGeometry& geometry,
                   const FilledPixels& pixels, const std::vector<Rgb>& excess, double flux) {
    double sum = 0;
    for (std::size_t k = 0; k < pixels.size(); ++k) {
        const double all = 3 * meanOf(excess[k]);
        forEachNode(geometry, pixels[k], [&](const Direction& d, double solidAngle) {
            const double x = d.x - axis.x, y = d.y - axis.y, z = d.z - axis.z;
            sum += all * solidAngle * (x * x + y * y + z * z) / 2;
        });
    }
    return sum / flux;
}

std::string plainly(const Rgb& rgb) {
    if (rgb[0] == rgb[1] && rgb[1] == rgb[2]) return fmt::format("{}", rgb[0]);
    return fmt::format("{}/{}/{}", rgb[0], rgb[1], rgb[2]);
}

}  // namespace

SunSplit splitSun(const PictureLight& picture) {
    Search search(picture);
    SunSplit split;
    for (const Place& place : search.pixelsAbout(search.peak(), split.peak, split.surroundings))
        split.rest.push_back({place.first, place.second});
    const auto rows = [&](const RowVisitor& visit) { forEachRow(picture, visit); };
    fillFromAround(split.rest, search.geometry(), rows,
                   picture.file + ": has no pixel beside its sun");
    std::vector<Rgb> excess(split.rest.size());
    std::size_t next = 0;
    forEachPixel(picture, [&](const Place& place, const float* rgb) {
        if (next == split.rest.size()) return;
        FilledPixel& pixel = split.rest[next];
        if (Place(pixel.row, pixel.column) != place) return;
        for (std::size_t c = 0; c < 3; ++c) {
            pixel.rgb[c] = std::min(pixel.rgb[c], rgb[c]);
            excess[next][c] = static_cast<double>(rgb[c]) - static_cast<double>(pixel.rgb[c]);
        }
        ++next;
    });
    const Moments sums = momentsOf(search.geometry(), split.rest, excess);
    const double length = std::hypot(sums.vector.x, sums.vector.y, sums.vector.z);
    const Direction axis{sums.vector.x / length, sums.vector.y / length, sums.vector.z / length};
    const double spread = spreadAbout(axis, search.geometry(), split.rest, excess,
                                      sums.flux[0] + sums.flux[1] + sums.flux[2]);
    split.sun.towards = toWorld(picture, axis);
    split.sun.radius = 2 * std::asin(std::sqrt(std::min(spread, 0.5)));
    for (std::size_t c = 0; c < 3; ++c) {
        split.sun.radiance[c] = sums.flux[c] / (4 * pi * std::min(spread, 0.5));
        split.irradiance[c] = split.sun.radiance[c] * pi * std::pow(std::sin(split.sun.radius), 2);
    }
    return split;
}

void writeRest(const PictureLight& picture, const SunSplit& split, AtomicFile& file) {
    const PictureGeometry geometry = fileGeometryOf(picture);
    ExrPicture out{.width = geometry.width, .height = geometry.height, .channels = {"R", "G", "B"}};
    out.values.resize(3 * geometry.width * geometry.height);
    forEachRow(picture, [&](std::size_t row, std::span<const float> rgb) {
        std::ranges::copy(
            rgb, out.values.begin() + static_cast<std::ptrdiff_t>(3 * geometry.width * row));
    });
    for (const FilledPixel& pixel : split.rest)
        for (std::size_t c = 0; c < 3; ++c) out.at(pixel.row, pixel.column, c) = pixel.rgb[c];
    writeExrPicture(out, ExrPixels::single, file);
}

std::string sunSpecification(const SunSplit& split) {
    return fmt::format("sun:elevation={},azimuth={},angle={},irradiance={}",
                       90 - degrees(polarAngle(split.sun.towards)),
                       degrees(azimuth(split.sun.towards)), degrees(2 * split.sun.radius),
                       plainly(split.irradiance));
}

}  // namespace hshfit::inline light
