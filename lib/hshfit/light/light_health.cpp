#include <hshfit/light/light_health.h>

#include <hshfit/light/light_samples.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hshfit::inline light {
namespace {

constexpr double largestHalf = 65504;
constexpr double brightestPart = 1e-3 * 4 * pi;
constexpr double smallDisc = 2 * (pi / 180);
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

class Examination {
public:
    /// Whether the pixel is the brightest so far.
    bool add(const Rgb& rgb, double solidAngle) {
        if (!(solidAngle > 0)) return false;
        const double sum = sumOf(rgb);
        for (std::size_t c = 0; c < 3; ++c) {
            flux_[c] += rgb[c] * solidAngle;
            largest_ = std::max(largest_, rgb[c]);
        }
        solidAngle_ += solidAngle;
        classes_.add(sum, solidAngle);
        if (sum > 0) {
            least_ = std::min(least_, sum);
        } else {
            black_ += solidAngle;
        }
        if (!(sum > sumOf(health_.peak))) return false;
        health_.peak = rgb;
        return true;
    }
    void setPeakDirection(const Direction& direction) { health_.peakDirection = direction; }

    /// A disc in front of the rest, whose radiance at its middle is `behind`.
    void addDisc(const DiscLight& disc, const Rgb& behind) {
        Rgb seen = disc.radiance;
        for (std::size_t c = 0; c < 3; ++c) seen[c] += behind[c];
        const double solidAngle = 4 * pi * std::pow(std::sin(disc.radius / 2), 2);
        for (std::size_t c = 0; c < 3; ++c) {
            flux_[c] += disc.radiance[c] * solidAngle;
            largest_ = std::max(largest_, seen[c]);
        }
        if (sumOf(disc.radiance) <= 0) return;
        classes_.add(sumOf(seen), solidAngle);
        least_ = std::min(least_, sumOf(seen));
        if (sumOf(seen) > sumOf(health_.peak)) {
            health_.peak = seen;
            health_.peakDirection = disc.towards;
        }
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
        health_.dynamicRange = total > 0 ? sumOf(health_.peak) / least_ : 0;
        health_.blackShare = solidAngle_ > 0 ? black_ / solidAngle_ : 0;
        health_.aboveHalf = largest_ / largestHalf;
        health_.clippedByHalf = largest_ > largestHalf;
        return health_;
    }

private:
    LightHealth health_;
    Classes classes_;
    Rgb flux_{};
    double solidAngle_ = 0, black_ = 0, least_ = infinity, largest_ = 0;
};

bool besideTheGrid(const Light& light) {
    const auto* disc = std::get_if<DiscLight>(&light);
    return (disc && disc->radius < smallDisc) || std::holds_alternative<DirectionalLight>(light);
}

/// The pixels of a picture, or of a grid, with what `others` add.
void addPixels(Examination& examination, const PictureLight* picture,
               const std::vector<Light>& others) {
    const PictureGeometry g =
        picture ? fileGeometryOf(*picture) : PictureGeometry{PictureLayout::latlong, 1024, 512};
    const double turn = picture ? picture->turn : 0;
    const auto addRow = [&](std::size_t row, std::span<const float> rgb) {
        const bool latlong = g.layout == PictureLayout::latlong;
        const double ofRow = latlong ? g.solidAngle(0, row) : 0;
        const auto direction = [&](std::size_t column) {
            return rotateAboutZ(
                g.direction(static_cast<double>(column) + 0.5, static_cast<double>(row) + 0.5),
                turn);
        };
        for (std::size_t column = 0; column < g.width; ++column) {
            Rgb seen = others.empty() ? Rgb{} : radianceFrom(others, direction(column));
            for (std::size_t c = 0; c < 3 && !rgb.empty(); ++c) seen[c] += rgb[3 * column + c];
            if (examination.add(seen, latlong ? ofRow : g.solidAngle(column, row))) {
                examination.setPeakDirection(direction(column));
            }
        }
    };
    if (picture) {
        forEachRow(*picture, addRow);
    } else {
        for (std::size_t row = 0; row < g.height; ++row) addRow(row, {});
    }
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
        if (const auto* disc = std::get_if<DiscLight>(&light)) {
            Rgb behind = radianceFrom(others, disc->towards);
            if (picture) {
                const Rgb more = radianceOf(*picture, disc->towards);
                for (std::size_t c = 0; c < 3; ++c) behind[c] += more[c];
            }
            examination.addDisc(*disc, behind);
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
    };
    return std::visit(Names{}, light);
}

}  // namespace hshfit::inline light
