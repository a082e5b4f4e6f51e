#include <brdfs/fit/picture_samples.h>

#include <hshfit/error.h>
#include <hshfit/light/catalog.h>
#include <hshfit/light/light_samples.h>
#include <hshfit/pictures/rgb_picture.h>
#include <hshfit/quadrature/quadrature.h>
#include <hshfit/quadrature/ring_points.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <string>
#include <utility>

namespace hshfit::brdfs {
namespace {

constexpr std::array rows{
    PictureLightRow{"key", "directional:elevation=45,azimuth=40"},
    PictureLightRow{"rim", "directional:elevation=25,azimuth=130"},
    PictureLightRow{"clear",
                    "sky:type=12,elevation=40,azimuth=-60,ground=0.3+"
                    "directional:elevation=40,azimuth=-60,irradiance=3"},
    PictureLightRow{"overcast", "sky:type=1,elevation=40,ground=0.2"},
    PictureLightRow{"panel",
                    "panel:elevation=35,azimuth=-30,width=50,height=30,radiance=5+"
                    "uniform:radiance=0.2"},
};

Direction cross(const Direction& a, const Direction& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Direction combined(double a, const Direction& u, double b, const Direction& v, double c,
                   const Direction& w) {
    return {a * u.x + b * v.x + c * w.x, a * u.y + b * v.y + c * w.y, a * u.z + b * v.z + c * w.z};
}
Direction normalized(const Direction& v) {
    const double length = std::sqrt(dot(v, v));
    return {v.x / length, v.y / length, v.z / length};
}

const Direction viewer = directionFromAngles(radians(75), 0);
const Direction right = normalized(cross({0, 0, 1}, viewer)), up = cross(viewer, right);

/// A surface of the sphere: its axes in the world.
struct Surface {
    Direction tangent, bitangent, normal;

    /// With the tangent towards the viewer, or horizontal: materials are brushed along parallels.
    Surface(const Direction& n, bool isotropic) : normal(n) {
        Direction along =
            isotropic ? combined(1, viewer, -dot(viewer, n), n, 0, n) : cross({0, 0, 1}, n);
        if (dot(along, along) < 1e-12) along = right;
        tangent = normalized(along);
        bitangent = cross(normal, tangent);
    }
    Direction toLocal(const Direction& world) const {
        return {dot(world, tangent), dot(world, bitangent), dot(world, normal)};
    }
    Direction toWorld(const Direction& local) const {
        return combined(local.x, tangent, local.y, bitangent, local.z, normal);
    }
};

struct OneLight {
    std::vector<Light> extended;
    std::vector<DirectionalLight> parallel;
};

std::vector<OneLight> lights() {
    std::vector<OneLight> result;
    for (const PictureLightRow& row : rows) {
        OneLight own;
        for (const Light& light : parseLights(std::string(row.spec)).lights) {
            if (const auto* parallel = std::get_if<DirectionalLight>(&light))
                own.parallel.push_back(*parallel);
            else
                own.extended.push_back(light);
        }
        result.push_back(std::move(own));
    }
    return result;
}

/// Normal of the place (x, y) of the unit disc that the sphere is in the picture.
Direction normalAt(double x, double y) {
    return combined(x, right, y, up, std::sqrt(std::max(0.0, 1 - x * x - y * y)), viewer);
}

struct Pixel {
    Direction normal;
    double area;        ///< of the disc's, in units of pi
    double weight = 0;  ///< beyond its area
};

constexpr double goldenAngle = 2.399963229728653;  // pi (3 - sqrt(5))

/// Pixels of a sphere under parallel light from `towards`. The pixel that mirrors the light weighs
/// as much as a fiftieth of the disc: lobes narrower than all pixels, which no picture of the data
/// shows, are seen there alone.
std::vector<Pixel> pixelsUnder(const Direction& towards, int points) {
    // Half vectors spread over the logarithm of their angle from the normal that mirrors the light.
    constexpr double nearest = 1e-3, farthest = 0.7;
    const double logarithm = std::log(farthest / nearest);
    const Direction mirror = normalized(combined(1, viewer, 1, towards, 0, towards));
    const Surface about(mirror, true);
    const auto weighted = [&](const Direction& n) {
        const double angle =
            std::atan2(std::sqrt(dot(cross(n, mirror), cross(n, mirror))), dot(n, mirror));
        double density = 1 / pi;  // per area of the disc
        if (angle > nearest && angle < farthest)
            density += 1 / (angle * logarithm) / (2 * pi * std::sin(angle)) / dot(n, viewer);
        return Pixel{n, 1 / (points * density * pi)};
    };
    constexpr double weightOfMirror = 0.02;
    std::vector<Pixel> pixels{{mirror, 0, weightOfMirror}};
    for (int k = 0; k < points; ++k) {
        const double share = (k + 0.5) / points, radius = std::sqrt(share);
        pixels.push_back(weighted(
            normalAt(radius * std::cos(k * goldenAngle), radius * std::sin(k * goldenAngle))));
        const Direction n = about.toWorld(
            directionFromAngles(nearest * std::exp(share * logarithm), k * goldenAngle));
        if (dot(n, viewer) > 1e-3) pixels.push_back(weighted(n));
    }
    return pixels;
}

/// Collects pixels; lights are told apart to expose each of them.
class Collector {
public:
    Collector(const Brdf& data, const PictureSampleOptions& options)
        : isotropic_(data.laws().isotropic),
          order_(options.order),
          level_(options.level),
          lowest_(std::max(options.grazingCut < 90 ? std::cos(radians(options.grazingCut)) : 0,
                           1e-6)) {}

    void addParallel(std::size_t light, const DirectionalLight& from, int points) {
        for (const Pixel& pixel : pixelsUnder(from.towards, points)) {
            const Surface surface(pixel.normal, isotropic_);
            const Direction wo = surface.toLocal(viewer), wi = surface.toLocal(from.towards);
            if (wo.z < lowest_) continue;
            const std::size_t first = sums_.size();
            const bool lit = wi.z >= lowest_;
            addNode(lit ? wi : Direction{0, 0, 1}, wo);
            addRow(light, wo, pixel, first, {lit ? from.irradiance[0] * wi.z : 0.0});
        }
    }

    /// Pixels at one elevation of the viewer, which share their nodes.
    void addRing(const Brdf& data, const std::vector<std::pair<std::size_t, OneLight>>& from,
                 const std::vector<Pixel>& pixels) {
        std::vector<Surface> surfaces;
        for (const Pixel& pixel : pixels) surfaces.emplace_back(pixel.normal, isotropic_);
        Direction wo = surfaces.front().toLocal(viewer);
        if (isotropic_) wo = {std::hypot(wo.x, wo.y), 0, wo.z};
        if (wo.z < lowest_) return;
        const std::size_t first = sums_.size();
        std::vector<double> weights;
        const HemisphereGrid grid =
            gridFor(data.lobes(wo), wo,
                    {.order = order_, .level = level_, .squeezed = true, .even = isotropic_});
        RingPoints points(grid);
        while (points.next()) {
            if (points.direction(0).z < lowest_) continue;
            // The other half of the ring are mirror images in the plane of incidence.
            for (std::size_t j = 0; j < points.count() / (isotropic_ ? 2 : 1); ++j) {
                addNode(points.direction(j), wo, isotropic_);
                weights.push_back(points.weight(j) * points.direction(j).z);
            }
        }
        // A node of its own for each pixel and parallel light.
        const std::size_t spread = weights.size();
        for (const Surface& surface : surfaces)
            for (const auto& [light, own] : from)
                for (const DirectionalLight& parallel : own.parallel) {
                    const Direction wi = surface.toLocal(parallel.towards);
                    const bool lit = wi.z >= lowest_;
                    addNode(lit ? wi : Direction{0, 0, 1}, wo);
                    weights.push_back(lit ? parallel.irradiance[0] * wi.z : 0);
                }
        std::size_t next = spread;
        for (std::size_t p = 0; p < pixels.size(); ++p)
            for (const auto& each : from) {
                const auto& own = each.second;
                std::vector<double> factors(weights.size(), 0);
                const auto radianceOf = [&](const Direction& wi) {
                    return radianceFrom(own.extended, surfaces[p].toWorld(wi))[0];
                };
                for (std::size_t k = 0; k < spread; ++k) {
                    const Direction wi{sums_.wiX[first + k], sums_.wiY[first + k],
                                       sums_.wiZ[first + k]};
                    const double mirrored = isotropic_ ? radianceOf({wi.x, -wi.y, wi.z}) : 0;
                    factors[k] = weights[k] * (radianceOf(wi) + mirrored);
                }
                for (std::size_t i = 0; i < own.parallel.size(); ++i, ++next)
                    factors[next] = weights[next];
                addRow(each.first, wo, pixels[p], first, factors);
            }
    }

    FitSamples finish(const Brdf& data, std::size_t lightCount);

private:
    void addNode(const Direction& wi, const Direction& wo, bool mirrored = false) {
        sums_.wiX.push_back(wi.x);
        sums_.wiY.push_back(wi.y);
        sums_.wiZ.push_back(wi.z);
        sums_.wo.push_back(wo);
        sums_.mirrored.push_back(mirrored);
    }
    void addRow(std::size_t light, const Direction& wo, const Pixel& pixel, std::size_t firstNode,
                const std::vector<double>& factors) {
        sums_.rows.push_back({firstNode, factors.size(), sums_.factors.size()});
        sums_.factors.insert(sums_.factors.end(), factors.begin(), factors.end());
        lights_.push_back(light);
        areas_.push_back(pixel.area);
        weights_.push_back(pixel.area + pixel.weight);
        outgoing_.push_back(wo);
    }

    bool isotropic_;
    int order_, level_;
    double lowest_;
    NodeSums sums_;
    std::vector<std::size_t> lights_;
    std::vector<double> areas_, weights_;
    std::vector<Direction> outgoing_;
};

/// The value below which `share` of the areas lie.
double quantile(std::vector<std::pair<double, double>> valuesAndAreas, double share) {
    std::ranges::sort(valuesAndAreas);
    double total = 0, sum = 0;
    for (const auto& [value, area] : valuesAndAreas) total += area;
    for (const auto& [value, area] : valuesAndAreas)
        if ((sum += area) >= share * total) return value;
    return valuesAndAreas.back().first;
}

FitSamples Collector::finish(const Brdf& data, std::size_t lightCount) {
    if (sums_.rows.empty())
        throw NumericError(
            fmt::format("{}: no pixel is left to fit within the grazing cut", data.name()));
    const std::vector<double> f = valuesAt(data, sums_);
    for (const double value : f)
        if (!std::isfinite(value))
            throw NumericError(
                fmt::format("{}: is not finite at a place of a lit sphere", data.name()));
    FitSamples samples;
    samples.channels = data.channels();
    samples.isotropic = isotropic_;
    samples.origin = SampleOrigin::pixels;
    const std::size_t count = sums_.rows.size(), channels = samples.channels.count();
    samples.sumRows.resize(count);
    std::iota(samples.sumRows.begin(), samples.sumRows.end(), std::size_t{0});
    samples.values = summed(sums_, samples.sumRows, f);
    std::vector<double> exposures;
    for (std::size_t light = 0; light < lightCount; ++light) {
        std::vector<std::pair<double, double>> pixels;
        for (std::size_t k = 0; k < count; ++k) {
            if (lights_[k] != light) continue;
            double most = 0;
            for (std::size_t c = 0; c < channels; ++c)
                most = std::max(most, samples.values[c * count + k]);
            pixels.emplace_back(most, areas_[k]);
        }
        // A sphere that is dark but for its highlight shows that in the picture.
        constexpr double shown = 0.95, mostStops = 12;
        double bright = 0;
        for (const auto& pixel : pixels)
            bright = std::max(bright, pixel.first / std::exp2(mostStops));
        if (!pixels.empty()) bright = std::max(bright, quantile(std::move(pixels), shown));
        exposures.push_back(bright > 0 ? shownAsWhite / bright : 1);
    }
    if (std::ranges::all_of(samples.values, [](double v) { return v <= 0; }))
        throw NumericError(fmt::format("{}: a lit sphere is black", data.name()));
    std::vector<double> weightOf(lightCount, 0);
    for (std::size_t k = 0; k < count; ++k) weightOf[lights_[k]] += weights_[k];
    for (std::size_t k = 0; k < count; ++k) {
        const NodeSums::Row& row = sums_.rows[k];
        const double exposure = exposures[lights_[k]];
        for (std::size_t j = 0; j < row.nodes; ++j) sums_.factors[row.firstFactor + j] *= exposure;
        for (std::size_t c = 0; c < channels; ++c) samples.values[c * count + k] *= exposure;
        samples.weights.push_back(weights_[k] / weightOf[lights_[k]] * static_cast<double>(count) /
                                  static_cast<double>(lightCount));
    }
    samples.wiX.assign(count, 0);
    samples.wiY.assign(count, 0);
    samples.wiZ.assign(count, 1);
    samples.wo = outgoing_;
    samples.sums = std::make_shared<const NodeSums>(std::move(sums_));
    return samples;
}

}  // namespace

std::span<const PictureLightRow> pictureLights() {
    return rows;
}

FitSamples pictureSamples(const Brdf& data, const PictureSampleOptions& options) {
    const std::vector<OneLight> all = lights();
    Collector collector(data, options);
    std::vector<std::pair<std::size_t, OneLight>> extended;
    for (std::size_t light = 0; light < all.size(); ++light) {
        if (!all[light].extended.empty())
            extended.emplace_back(light, all[light]);
        else
            for (const DirectionalLight& parallel : all[light].parallel)
                collector.addParallel(light, parallel, options.points);
    }
    const double area = 1.0 / (options.rings * options.around);
    for (int ring = 0; ring < options.rings; ++ring) {
        const double radius = std::sqrt((ring + 0.5) / options.rings);
        std::vector<Pixel> pixels;
        for (int k = 0; k < options.around; ++k) {
            const double angle = 2 * pi * (k + 0.5) / options.around + ring * goldenAngle;
            pixels.push_back({normalAt(radius * std::cos(angle), radius * std::sin(angle)), area});
        }
        if (data.laws().isotropic)
            collector.addRing(data, extended, pixels);
        else
            for (const Pixel& pixel : pixels) collector.addRing(data, extended, {pixel});
    }
    FitSamples samples = collector.finish(data, all.size());
    if (options.fewer)
        samples.fewer = std::make_shared<const FitSamples>(
            pictureSamples(data, {.rings = std::max(options.rings / 3, 3),
                                  .around = std::max(options.around / 3, 3),
                                  .points = std::max(options.points / 4, 32),
                                  .order = std::max(options.order / 2, 4),
                                  .level = options.level - 1,
                                  .grazingCut = options.grazingCut,
                                  .fewer = false}));
    return samples;
}

}  // namespace hshfit::brdfs
