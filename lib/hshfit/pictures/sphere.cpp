#include <hshfit/pictures/internal/channel_colours.h>
#include <hshfit/pictures/sphere.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <utility>

namespace hshfit::inline pictures {
namespace {

using Rgb = std::array<double, 3>;

/// The local frame at a point of the sphere, in the frame of the picture.
struct Frame {
    Direction tangent, bitangent, normal;
    Direction local(const Direction& d) const {
        return {dot(d, tangent), dot(d, bitangent), dot(d, normal)};
    }
};

/// A point of the unit disc.
struct Place {
    double x, y;
};

/// The frame at a point, with the tangent along the parallel.
Frame frameAlongParallel(const Place& at) {
    const double z = std::sqrt(1 - at.x * at.x - at.y * at.y);
    const Direction n{at.x, at.y, z};
    const double length = std::hypot(z, at.x);
    const Direction t = length > 0 ? Direction{z / length, 0, -at.x / length} : Direction{1, 0, 0};
    return {t, {n.y * t.z - n.z * t.y, n.z * t.x - n.x * t.z, n.x * t.y - n.y * t.x}, n};
}

/// The frame at a point, with the viewer in the plane of tangent and normal: points at one distance
/// from the middle see the viewer in one direction.
Frame frameTowardsViewer(const Place& at) {
    const double square = at.x * at.x + at.y * at.y, r = std::sqrt(square);
    if (r == 0) return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const double x = at.x / r, y = at.y / r, z = std::sqrt(std::max(0.0, 1 - square));
    return {{-z * x, -z * y, r}, {y, -x, 0}, {at.x, at.y, z}};
}

/// Points that see the viewer in one direction, each with the sum of its pixel.
struct Points {
    std::vector<Place> places = {};
    std::vector<Rgb> sums = {};
    std::size_t notFinite = 0;
};

class Shader {
public:
    /// `albedo` is needed under a dome only.
    Shader(const Brdf& brdf, const AlbedoTable* albedo, const SphereRig& rig)
        : brdf_(brdf),
          albedo_(albedo),
          rig_(rig),
          colour_(brdf.channels()),
          channels_(brdf.channels().count()) {}

    const std::string& colours() const { return colour_.what(); }
    bool isotropic() const { return brdf_.laws().isotropic; }

    /// The width, in radians of the normal, of the highlight of a light in the mirror direction.
    double highlightWidth(const Direction& wo) const {
        double width = 1;
        for (const Lobe& lobe : brdf_.lobes(wo)) {
            if (lobe.about == Lobe::About::halfway)
                width = std::min(width, lobe.width);
            else if (dot(lobe.axis, mirrored(wo)) > 0.999)
                width = std::min(width, lobe.width / 2);  // a normal turns by half of the angle
        }
        return width;
    }

    /// Directions to the lights that are above points.
    struct Lit {
        std::vector<double> x = {}, y = {}, z = {}, weight = {}, f = {};
        std::vector<std::size_t> point = {};
    };

    /// Adds the radiance that each point sends to the viewer. `lit` is memory to work in.
    void add(Points& points, Lit& lit) const {
        const Direction wo = frameAt(points.places[0]).local({0, 0, 1});
        findLights(points, lit);
        const std::size_t count = lit.x.size();
        lit.f.resize(std::max<std::size_t>(1, count) * channels_);
        if (count > 0)
            brdf_.eval(wo, {lit.x.data(), lit.y.data(), lit.z.data(), count}, lit.f.data());
        for (std::size_t k = 0; k < count; ++k)
            addFinite(colour_(lit.f.data() + k, count), lit.weight[k], lit.point[k], points);
        if (rig_.dome == 0) return;
        lit.f.resize(channels_);
        albedo_->at(wo, lit.f);
        const Rgb dome = colour_(lit.f.data(), 1);
        for (std::size_t p = 0; p < points.places.size(); ++p)
            addFinite(dome, rig_.dome, p, points);
    }

private:
    Frame frameAt(const Place& at) const {
        return isotropic() ? frameTowardsViewer(at) : frameAlongParallel(at);
    }
    void findLights(const Points& points, Lit& lit) const {
        for (auto* values : {&lit.x, &lit.y, &lit.z, &lit.weight}) values->clear();
        lit.point.clear();
        for (std::size_t p = 0; p < points.places.size(); ++p) {
            const Frame frame = frameAt(points.places[p]);
            for (const SphereLight& light : rig_.lights) {
                const Direction wi = frame.local(light.towards);
                if (wi.z <= 0) continue;
                lit.x.push_back(wi.x);
                lit.y.push_back(wi.y);
                lit.z.push_back(wi.z);
                lit.weight.push_back(pi * light.strength * wi.z);
                lit.point.push_back(p);
            }
        }
    }
    static void addFinite(const Rgb& value, double weight, std::size_t point, Points& points) {
        for (std::size_t c = 0; c < 3; ++c) {
            if (std::isfinite(value[c])) {
                points.sums[point][c] += weight * value[c];
            } else {
                ++points.notFinite;
            }
        }
    }

    const Brdf& brdf_;
    const AlbedoTable* albedo_;
    const SphereRig& rig_;
    const ChannelColours colour_;
    std::size_t channels_;
};

struct Cell {
    std::size_t row, column;
    bool operator==(const Cell&) const = default;
};

/// A cell of a square of `size` cells along an edge, mirrored across and down, and with its axes
/// exchanged, by the bits of `symmetry`.
Cell moved(Cell cell, std::size_t symmetry, std::size_t size) {
    if (symmetry & 4) std::swap(cell.row, cell.column);
    if (symmetry & 2) cell.row = size - 1 - cell.row;
    if (symmetry & 1) cell.column = size - 1 - cell.column;
    return cell;
}

/// Draws pixels of a picture together with the pixels onto which symmetries of the sphere take
/// them.
class Painter {
public:
    Painter(const Shader& shader, const SphereOptions& options, SpherePicture& picture)
        : shader_(shader),
          size_(static_cast<std::size_t>(options.size)),
          samples_(static_cast<std::size_t>(options.samples)),
          symmetries_(shader.isotropic() ? 8 : 1),
          picture_(picture) {}

    /// Draws a pixel with so many times as many samples along an edge.
    std::size_t drawAgain(const Cell& pixel, std::size_t times) {
        samples_ *= times;
        symmetries_ = 1;
        drawAlike(pixel);
        return points_.notFinite;
    }

    /// Rows of pixels that stand for all.
    std::size_t rows() const { return symmetries_ > 1 ? (size_ + 1) / 2 : size_; }

    /// Draws what one of these rows stands for; values of f that were left out.
    std::size_t draw(std::size_t row) {
        const std::size_t columns = symmetries_ > 1 ? row + 1 : size_;
        for (std::size_t column = 0; column < columns; ++column) drawAlike({row, column});
        return points_.notFinite;
    }

private:
    void drawAlike(Cell first) {
        std::vector<Cell>& pixels = pixels_;
        pixels.clear();
        symmetriesOfPixels_.clear();
        for (std::size_t symmetry = 0; symmetry < symmetries_; ++symmetry) {
            const Cell pixel = moved(first, symmetry, size_);
            if (std::ranges::find(pixels, pixel) != pixels.end()) continue;
            pixels.push_back(pixel);
            symmetriesOfPixels_.push_back(symmetry);
        }
        points_.sums.assign(pixels.size(), Rgb{});
        points_.places.resize(pixels.size());
        double covered = 0;
        for (std::size_t i = 0; i < samples_ * samples_; ++i) {
            const Cell sample{first.row * samples_ + i / samples_,
                              first.column * samples_ + i % samples_};
            for (std::size_t p = 0; p < pixels.size(); ++p)
                points_.places[p] =
                    placeOf(moved(sample, symmetriesOfPixels_[p], size_ * samples_));
            const auto [x, y] = points_.places[0];
            if (x * x + y * y >= 1) continue;
            shader_.add(points_, lit_);
            ++covered;
        }
        for (std::size_t p = 0; p < pixels.size(); ++p) put(pixels[p], points_.sums[p], covered);
    }
    /// Exactly symmetric about the middle.
    Place placeOf(const Cell& sample) const {
        const auto count = static_cast<double>(size_ * samples_);
        const double scale = 2 / (count * sphereRadius);
        return {scale * (static_cast<double>(sample.column) + 0.5 - count / 2),
                scale * (count / 2 - static_cast<double>(sample.row) - 0.5)};
    }
    void put(const Cell& cell, const Rgb& sum, double covered) {
        const std::size_t pixel = cell.row * size_ + cell.column;
        picture_.coverage[pixel] =
            static_cast<float>(covered / static_cast<double>(samples_ * samples_));
        for (std::size_t c = 0; c < 3 && covered > 0; ++c)
            picture_.radiance[3 * pixel + c] = static_cast<float>(sum[c] / covered);
    }

    const Shader& shader_;
    std::size_t size_, samples_, symmetries_;
    SpherePicture& picture_;
    Points points_ = {};
    Shader::Lit lit_ = {};
    std::vector<Cell> pixels_ = {};
    std::vector<std::size_t> symmetriesOfPixels_ = {};
};

/// The samples of a pixel along an edge, at most, where a highlight is narrow.
constexpr double mostSamples = 128;

/// Draws the pixels about the mirror image of each light again, where an isotropic highlight is
/// narrower than twice the distance of samples and would be hit or missed by chance.
void sharpenHighlights(const Shader& shader, const SphereOptions& options, SpherePicture& picture) {
    if (!options.sharpened || !shader.isotropic()) return;
    const double half = options.size / 2.0;
    for (const SphereLight& light : options.rig.lights) {
        const Direction& l = light.towards;
        const double length = std::sqrt(l.x * l.x + l.y * l.y + (l.z + 1) * (l.z + 1));
        const double z = length / 2;  // of the normal, in the middle of light and viewer
        if (z < 0.01) continue;
        const double distance = 1 / (half * options.samples * sphereRadius * z);
        const double width = shader.highlightWidth({std::sqrt(std::max(0.0, 1 - z * z)), 0, z}) / 2;
        if (distance <= width) continue;
        const auto times = static_cast<std::size_t>(
            std::min(std::ceil(distance / width), std::ceil(mostSamples / options.samples)));
        const int column = static_cast<int>(half * (1 + sphereRadius * l.x / length));
        const int row = static_cast<int>(half * (1 - sphereRadius * l.y / length));
        for (int k = 0; k < 9; ++k) {
            const int y = row + k / 3 - 1, x = column + k % 3 - 1;
            if (std::min(x, y) < 0 || std::max(x, y) >= options.size) continue;
            picture.notFinite +=
                Painter(shader, options, picture)
                    .drawAgain({static_cast<std::size_t>(y), static_cast<std::size_t>(x)}, times);
        }
    }
}

SpherePicture render(const Brdf& brdf, const AlbedoTable* albedo, const SphereOptions& options) {
    const Shader shader(brdf, albedo, options.rig);
    const auto size = static_cast<std::size_t>(options.size);
    SpherePicture picture{.size = options.size,
                          .radiance = std::vector<float>(size * size * 3),
                          .coverage = std::vector<float>(size * size),
                          .colours = shader.colours(),
                          .notFinite = albedo ? albedo->notFinite() : 0};
    const std::size_t rows = Painter(shader, options, picture).rows();
    std::vector<std::size_t> notFinite(rows);
    std::atomic<std::size_t> done = 0;
    tbb::parallel_for(std::size_t{0}, rows, [&](std::size_t row) {
        notFinite[row] = Painter(shader, options, picture).draw(row);
        if (options.progress) options.progress(++done, rows);
    });
    for (const std::size_t count : notFinite) picture.notFinite += count;
    sharpenHighlights(shader, options, picture);
    return picture;
}

}  // namespace

SpherePicture renderSphere(const Brdf& brdf, const AlbedoTable& albedo,
                           const SphereOptions& options) {
    return render(brdf, &albedo, options);
}

SpherePicture renderSphere(const Brdf& brdf, const SphereOptions& options) {
    if (options.rig.dome == 0) return render(brdf, nullptr, options);
    return renderSphere(brdf, AlbedoTable(brdf), options);
}

}  // namespace hshfit::inline pictures
