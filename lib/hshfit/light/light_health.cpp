#include <hshfit/light/light_health.h>

#include <hshfit/light/light_samples.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace hshfit::inline light {
namespace {

constexpr double largestHalf = 65504, blackHalf = 0x1p-25;
constexpr double brightestPart = 1e-3 * 4 * pi;
constexpr double narrowShape = 4 * (pi / 180);  ///< from side to side of a shape beside the grid
/// Parts of a pixel on the edge of a shape, in each direction.
constexpr std::size_t edgeParts = 8;
constexpr double infinity = std::numeric_limits<double>::infinity();

double sumOf(const Rgb& rgb) {
    return rgb[0] + rgb[1] + rgb[2];
}

/// Solid angle and flux by radiance, 64 classes to a factor of 2, from which the flux of the
/// brightest part follows.
class Classes {
public:
    void add(double radiance, double solidAngle) {
        Class& one = classes_[indexOf(radiance)];
        one.solidAngle += solidAngle;
        one.flux += radiance * solidAngle;
    }
    void addPoint(double flux) { classes_.back().flux += flux; }

    double fluxOfBrightest(double solidAngle) const {
        double flux = 0;
        for (auto one = classes_.rbegin(); one != classes_.rend() && solidAngle >= 0; ++one) {
            const double share = one->solidAngle > solidAngle ? solidAngle / one->solidAngle : 1;
            flux += share * one->flux;
            solidAngle -= one->solidAngle;
        }
        return flux;
    }

private:
    struct Class {
        double solidAngle = 0, flux = 0;
    };
    static constexpr int perOctave = 64, lowest = -64, highest = 160;

    static std::size_t indexOf(double radiance) {
        if (!(radiance > 0)) return 0;
        // Steps of a factor of 2, each in equal parts: no logarithm for every pixel.
        int octave = 0;
        const double part = 2 * std::frexp(radiance, &octave) - 1;
        const int step = static_cast<int>(part * perOctave);
        return static_cast<std::size_t>(std::clamp((octave - lowest) * perOctave + step + 1, 1,
                                                   (highest - lowest) * perOctave));
    }
    std::vector<Class> classes_ = std::vector<Class>((highest - lowest) * perOctave + 2);
};

/// A disc or a panel: uniform radiance within an edge.
struct Shape {
    Direction towards;
    Rgb radiance{};
    double solidAngle = 0, width = 0;  ///< from side to side where it is narrowest
};

std::optional<Shape> shapeOf(const Light& light) {
    if (const auto* disc = std::get_if<DiscLight>(&light)) {
        return Shape{disc->towards, disc->radiance,
                     4 * pi * std::pow(std::sin(disc->radius / 2), 2), 2 * disc->radius};
    }
    const auto* panel = std::get_if<PanelLight>(&light);
    if (!panel) return {};
    // The solid angle of a rectangle at distance 1, seen from above its middle.
    const double a = std::tan(panel->width / 2), b = std::tan(panel->height / 2);
    return Shape{panel->towards, panel->radiance,
                 4 * std::atan(a * b / std::sqrt(1 + a * a + b * b)),
                 std::min(panel->width, panel->height)};
}

class Examination {
public:
    /// Whether the pixel is the brightest so far.
    bool add(const Rgb& rgb, double solidAngle) {
        if (!(solidAngle > 0)) return false;
        const double sum = sumOf(rgb), least = *std::ranges::min_element(rgb);
        for (std::size_t c = 0; c < 3; ++c) {
            flux_[c] += rgb[c] * solidAngle;
            largest_ = std::max(largest_, rgb[c]);
        }
        if (least < 0) {
            negative_ += solidAngle;
            health_.leastNegative = std::min(health_.leastNegative, least);
        }
        solidAngle_ += solidAngle;
        classes_.add(sum, solidAngle);
        if (sum > 0) {
            least_ = std::min(least_, sum);
        } else if (!(least < 0)) {
            black_ += solidAngle;
        }
        if (!(sum > sumOf(health_.peak))) return false;
        health_.peak = rgb;
        return true;
    }
    void setPeakDirection(const Direction& direction) { health_.peakDirection = direction; }

    /// A shape in front of the rest, whose radiance at its middle is `behind`.
    void addShape(const Shape& shape, const Rgb& behind) {
        Rgb seen = shape.radiance;
        for (std::size_t c = 0; c < 3; ++c) {
            seen[c] += behind[c];
            flux_[c] += shape.radiance[c] * shape.solidAngle;
            largest_ = std::max(largest_, seen[c]);
        }
        if (sumOf(shape.radiance) <= 0) return;
        classes_.add(sumOf(seen), shape.solidAngle);
        least_ = std::min(least_, sumOf(seen));
        if (sumOf(seen) > sumOf(health_.peak)) {
            health_.peak = seen;
            health_.peakDirection = shape.towards;
        }
    }
    /// Flux that the pixels lack.
    void addFlux(const Rgb& flux) {
        for (std::size_t c = 0; c < 3; ++c) flux_[c] += flux[c];
    }

    void addBeam(const DirectionalLight& beam) {
        if (sumOf(beam.irradiance) <= 0) return;
        for (std::size_t c = 0; c < 3; ++c) {
            flux_[c] += beam.irradiance[c];
            if (beam.irradiance[c] > 0) health_.peak[c] = infinity;
        }
        classes_.addPoint(sumOf(beam.irradiance));
        health_.peakDirection = beam.towards;
        largest_ = infinity;
    }

    LightHealth result() {
        const double total = sumOf(flux_);
        // The used area of a disc is cut off at pixels, so that it is the sphere but for a little.
        for (std::size_t c = 0; c < 3; ++c) health_.mean[c] = flux_[c] / (4 * pi);
        health_.brightestShare = total > 0 ? classes_.fluxOfBrightest(brightestPart) / total : 0;
        health_.dynamicRange = total > 0 && negative_ == 0 ? sumOf(health_.peak) / least_ : 0;
        health_.blackShare = solidAngle_ > 0 ? black_ / solidAngle_ : 0;
        health_.negativeShare = solidAngle_ > 0 ? negative_ / solidAngle_ : 0;
        health_.aboveHalf = largest_ / largestHalf;
        health_.clippedByHalf = largest_ > largestHalf;
        health_.blackInHalf = largest_ > 0 && largest_ <= blackHalf;
        return health_;
    }

private:
    LightHealth health_;
    Classes classes_;
    Rgb flux_{};
    double solidAngle_ = 0, black_ = 0, negative_ = 0, least_ = infinity, largest_ = 0;
};

/// A light that the pixels of the grid would miss.
bool besideTheGrid(const Light& light) {
    const auto shape = shapeOf(light);
    return (shape && shape->width < narrowShape) || std::holds_alternative<DirectionalLight>(light);
}

/// Pixels, or their parts, with the shapes in front of them. The edges of shapes cross pixels, so
/// that pixels count the flux of a shape inexactly; its exact flux makes up for that.
class Pixels {
public:
    Pixels(Examination& examination, const PictureGeometry& geometry, const PictureLight* picture,
           const std::vector<Light>& others)
        : examination_(examination), geometry_(geometry), picture_(picture) {
        for (const Light& light : others) (shapeOf(light) ? shapes_ : smooth_).push_back(light);
    }
    ~Pixels() {
        for (const Light& light : shapes_) {
            const Shape shape = *shapeOf(light);
            for (std::size_t c = 0; c < 3; ++c) missing_[c] += shape.radiance[c] * shape.solidAngle;
        }
        examination_.addFlux(missing_);
    }
    Pixels(const Pixels&) = delete;
    Pixels& operator=(const Pixels&) = delete;

    void setGeometry(const PictureGeometry& geometry) { geometry_ = geometry; }

    void add(std::size_t column, std::size_t row, const Rgb& own, double solidAngle) {
        const auto x = static_cast<double>(column), y = static_cast<double>(row);
        if (shapes_.empty() || !onEdge(x, y)) return addPart(x + 0.5, y + 0.5, own, solidAngle);
        constexpr double parts = edgeParts;
        for (std::size_t k = 0; k < edgeParts * edgeParts; ++k)
            addPart(x + (static_cast<double>(k % edgeParts) + 0.5) / parts,
                    y + (static_cast<double>(k / edgeParts) + 0.5) / parts, own,
                    solidAngle / (parts * parts));
    }

private:
    Direction direction(double x, double y) const {
        const Direction d = geometry_.direction(x, y);
        return picture_ ? toWorld(*picture_, d) : d;
    }
    bool onEdge(double x, double y) const {
        const Rgb middle = radianceFrom(shapes_, direction(x + 0.5, y + 0.5));
        for (const double u : {0.0, 1.0})
            for (const double v : {0.0, 1.0})
                if (radianceFrom(shapes_, direction(x + u, y + v)) != middle) return true;
        return false;
    }
    void addPart(double x, double y, const Rgb& own, double solidAngle) {
        Rgb seen = own;
        if (!shapes_.empty() || !smooth_.empty()) {
            const Direction towards = direction(x, y);
            const Rgb smooth = radianceFrom(smooth_, towards),
                      shape = radianceFrom(shapes_, towards);
            for (std::size_t c = 0; c < 3; ++c) {
                seen[c] += smooth[c] + shape[c];
                missing_[c] -= shape[c] * solidAngle;
            }
        }
        if (examination_.add(seen, solidAngle)) examination_.setPeakDirection(direction(x, y));
    }

    Examination& examination_;
    PictureGeometry geometry_;
    const PictureLight* picture_;
    std::vector<Light> smooth_, shapes_;
    Rgb missing_{};
};

/// The pixels of a picture, or of a grid, with what `others` add.
void addPixels(Examination& examination, const PictureLight* picture,
               const std::vector<Light>& others) {
    const PictureGeometry grid{PictureLayout::latlong, 1024, 512};
    const PictureGeometry g = picture ? fileGeometryOf(*picture) : grid;
    Pixels pixels(examination, g, picture, others);
    const auto addRow = [&](std::size_t row, std::span<const float> rgb) {
        const bool latlong = g.layout == PictureLayout::latlong;
        const double ofRow = latlong ? g.solidAngle(0, row) : 0;
        for (std::size_t column = 0; column < g.width; ++column) {
            Rgb own{};
            for (std::size_t c = 0; c < 3; ++c) own[c] = rgb[3 * column + c];
            pixels.add(column, row, own, latlong ? ofRow : g.solidAngle(column, row));
        }
    };
    const auto addDark = [&](std::size_t first) {
        pixels.setGeometry(grid);
        for (std::size_t row = first; row < grid.height; ++row)
            for (std::size_t column = 0; column < grid.width; ++column)
                pixels.add(column, row, {}, grid.solidAngle(0, row));
    };
    if (!picture) return addDark(0);
    forEachRow(*picture, addRow);
    if (g.layout == PictureLayout::dome) addDark(grid.height / 2);
}

}  // namespace

LightHealth examine(const std::vector<Light>& lights) {
    const PictureLight* picture = nullptr;
    PictureCensus invalid;
    std::vector<Light> others, small;
    for (const Light& light : lights) {
        const auto* one = std::get_if<PictureLight>(&light);
        if (one) {
            invalid.negative += one->census.negative;
            invalid.infinite += one->census.infinite;
            invalid.notANumber += one->census.notANumber;
        }
        if (one && !picture) {
            picture = one;
        } else {
            (besideTheGrid(light) ? small : others).push_back(light);
        }
    }
    Examination examination;
    if (picture || !others.empty()) addPixels(examination, picture, others);
    for (const Light& light : small) {
        if (const auto shape = shapeOf(light)) {
            Rgb behind = radianceFrom(others, shape->towards);
            if (picture) {
                const Rgb more = radianceOf(*picture, shape->towards);
                for (std::size_t c = 0; c < 3; ++c) behind[c] += more[c];
            }
            examination.addShape(*shape, behind);
        }
    }
    for (const Light& light : small) {
        if (const auto* beam = std::get_if<DirectionalLight>(&light)) examination.addBeam(*beam);
    }
    LightHealth health = examination.result();
    health.invalid = invalid;
    return health;
}

std::string_view kindOf(const Light& light) {
    struct Names {
        std::string_view operator()(const DiscLight&) const { return "disc"; }
        std::string_view operator()(const PanelLight&) const { return "panel"; }
        std::string_view operator()(const SkyLight&) const { return "sky"; }
        std::string_view operator()(const PictureLight&) const { return "picture"; }
        std::string_view operator()(const DirectionalLight&) const { return "direction"; }
        std::string_view operator()(const CoefficientLight&) const { return "coefficients"; }
    };
    return std::visit(Names{}, light);
}

}  // namespace hshfit::inline light
