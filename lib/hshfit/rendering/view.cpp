#include <hshfit/rendering/view.h>

#include <hshfit/brdf/vectors.h>
#include <hshfit/rays/ray_scene.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

namespace hshfit::inline rendering {
namespace {

/// The least cosine of a mesh's normal to the line of sight.
constexpr double leastCosine = 0.01;

/// The normal that a line of sight meets, and the direction back to the viewer.
struct Seen {
    Direction normal, viewer;
};
/// At (x, y) of the picture in units of the sphere's radius, up and to the right of its middle;
/// none beside the surface.
using SeenAt = std::function<std::optional<Seen>(double x, double y)>;

SurfacePoints pointsBy(const SeenAt& seenAt, const View& view, int size, int samples) {
    const auto edge = static_cast<std::size_t>(size);
    const double n = samples, scale = 2 / (size * sphereRadius);
    std::vector<std::vector<Seen>> rows(edge);
    std::vector<std::size_t> counts(edge * edge);
    tbb::parallel_for(std::size_t{0}, edge, [&](std::size_t row) {
        for (std::size_t column = 0; column < edge; ++column) {
            for (int i = 0; i < samples * samples; ++i) {
                const double across = (i % samples + 0.5) / n, down = (i / samples + 0.5) / n;
                const auto seen =
                    seenAt(scale * (static_cast<double>(column) + across) - 1 / sphereRadius,
                           1 / sphereRadius - scale * (static_cast<double>(row) + down));
                if (!seen) continue;
                rows[row].push_back(*seen);
                ++counts[row * edge + column];
            }
        }
    });
    SurfacePoints points{.size = size, .coverage = {}, .first = {0}, .normals = {}, .viewers = {}};
    for (const std::size_t count : counts) {
        points.coverage.push_back(static_cast<float>(static_cast<double>(count) / (n * n)));
        points.first.push_back(points.first.back() + count);
    }
    for (const auto& row : rows) {
        for (const Seen& seen : row) {
            points.normals.push_back(seen.normal);
            if (view.fieldOfView > 0) points.viewers.push_back(seen.viewer);
        }
    }
    return points;
}

/// Lines of sight in the picture's axes, about the middle of a surface of extent 1 that reaches
/// `front` towards the viewer: parallel, or from an eye whose distance frames the surface.
class Sight {
public:
    Sight(const View& view, double front) : front_(front) {
        if (view.fieldOfView > 0) {
            slope_ = sphereRadius * std::tan(view.fieldOfView / 2);
            eye_ = front + 1 / slope_;
        }
    }
    /// The eye of a sphere, whose outline is seen under the slope.
    static Sight ofSphere(const View& view) {
        Sight sight(view, 1);
        if (view.fieldOfView > 0) sight.eye_ = std::hypot(1.0, 1 / sight.slope_);
        return sight;
    }
    Direction origin(double x, double y) const {
        if (!(slope_ > 0)) return {x, y, front_ + 1};
        // A distant eye costs digits of single precision: from a plane before the surface.
        const double gap = std::max(0.0, eye_ - front_ - 1);
        return {slope_ * x * gap, slope_ * y * gap, eye_ - gap};
    }
    Direction along(double x, double y) const {
        return slope_ > 0 ? normalised({slope_ * x, slope_ * y, -1}) : Direction{0, 0, -1};
    }

private:
    double front_, slope_ = 0, eye_ = 0;
};

/// The place of a mesh in the picture's axes.
struct Extent {
    Extent(const Mesh& mesh, const View& view) {
        std::array<double, 3> low, high;
        low.fill(std::numeric_limits<double>::infinity());
        high.fill(-std::numeric_limits<double>::infinity());
        for (const auto& triangle : mesh.triangles) {
            for (const std::uint32_t v : triangle) {
                const Direction p = directionOf(mesh.positions[v]);
                const double at[] = {dot(p, view.right), dot(p, view.up), dot(p, view.towards)};
                for (std::size_t i = 0; i < 3; ++i) {
                    low[i] = std::min(low[i], at[i]);
                    high[i] = std::max(high[i], at[i]);
                }
            }
        }
        for (std::size_t i = 0; i < 3; ++i) middle[i] = (low[i] + high[i]) / 2;
        half = std::max(high[0] - low[0], high[1] - low[1]) / 2;
        depth = (high[2] - low[2]) / 2;
        // A mesh seen on its edge.
        if (!(half > 0)) half = depth > 0 ? depth : 1;
    }
    std::array<double, 3> middle{};
    double half = 0, depth = 0;
};

/// The normal of the side that is seen, at least a little towards the viewer.
Direction seenNormal(const Mesh& mesh, const RayHit& hit, const Direction& towards) {
    const auto& t = mesh.triangles[hit.triangle];
    const Direction a = directionOf(mesh.positions[t[0]]), b = directionOf(mesh.positions[t[1]]),
                    c = directionOf(mesh.positions[t[2]]);
    const Direction u{b.x - a.x, b.y - a.y, b.z - a.z}, v{c.x - a.x, c.y - a.y, c.z - a.z};
    const Direction flat{u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
    const MeshVector* corners = mesh.normals.data() + 3 * std::size_t{hit.triangle};
    Direction n = (1 - hit.u - hit.v) * directionOf(corners[0]) + hit.u * directionOf(corners[1]) +
                  hit.v * directionOf(corners[2]);
    if (!(dot(n, n) > 0)) n = flat;
    // Normals of the file say which side is the front; without a clear answer the triangle does.
    const bool front = dot(flat, n) >= 0 ? dot(flat, towards) >= 0 : dot(flat, towards) < 0;
    n = normalised(front ? n : Direction{-n.x, -n.y, -n.z});
    const double cosine = dot(n, towards);
    if (cosine >= leastCosine) return n;
    const Direction across = n - cosine * towards;
    if (!(dot(across, across) > 1e-12)) return towards;
    return (std::sqrt(1 - leastCosine * leastCosine)) * normalised(across) + leastCosine * towards;
}

}  // namespace

View::View(double theta, double phi, double angle)
    : right{-std::sin(phi), std::cos(phi), 0},
      up{-std::cos(theta) * std::cos(phi), -std::cos(theta) * std::sin(phi), std::sin(theta)},
      towards(directionFromAngles(theta, phi)),
      fieldOfView(angle) {}

Direction View::toWorld(const Direction& d) const {
    return d.x * right + d.y * up + d.z * towards;
}

SurfacePoints spherePoints(const View& view, int size, int samples) {
    const Sight sight = Sight::ofSphere(view);
    return pointsBy(
        [&](double x, double y) -> std::optional<Seen> {
            const Direction from = sight.origin(x, y), along = sight.along(x, y);
            const double nearest = dot(from, along), squared = dot(from, from);
            const double root = nearest * nearest - squared + 1;
            if (!(root > 0)) return std::nullopt;
            const double far = -nearest - std::sqrt(root);
            const Direction normal = from + far * along;
            return Seen{view.toWorld(normalised(normal)), view.toWorld(-along)};
        },
        view, size, samples);
}

SurfacePoints meshPoints(const Mesh& mesh, const View& view, int size, int samples) {
    const Extent extent(mesh, view);
    // Rays start in front of the mesh, in its own units about its middle: a mesh far from the
    // origin keeps the digits of single precision.
    Mesh centred{.positions = mesh.positions, .triangles = mesh.triangles, .normals = mesh.normals};
    const Direction middle = view.toWorld({extent.middle[0], extent.middle[1], extent.middle[2]});
    for (MeshVector& p : centred.positions) {
        p = {static_cast<float>((p[0] - middle.x) / extent.half),
             static_cast<float>((p[1] - middle.y) / extent.half),
             static_cast<float>((p[2] - middle.z) / extent.half)};
    }
    const RayScene scene(centred);
    const Sight sight(view, extent.depth / extent.half);
    return pointsBy(
        [&](double x, double y) -> std::optional<Seen> {
            const Direction origin = view.toWorld(sight.origin(x, y));
            const Direction along = view.toWorld(sight.along(x, y)), back = -along;
            const auto hit = scene.firstHit({origin.x, origin.y, origin.z}, along);
            if (!hit) return std::nullopt;
            return Seen{seenNormal(centred, *hit, back), back};
        },
        view, size, samples);
}

Frame frameAt(const Direction& normal) {
    Frame frame{Orientation{}};
    const double across = std::hypot(normal.x, normal.y);
    frame.normal = normal;
    frame.tangent =
        across > 1e-9 ? Direction{-normal.y / across, normal.x / across, 0} : Direction{1, 0, 0};
    const Direction &n = normal, &t = frame.tangent;
    frame.bitangent = {n.y * t.z - n.z * t.y, n.z * t.x - n.x * t.z, n.x * t.y - n.y * t.x};
    return frame;
}

SpherePicture pictureOf(const SurfacePoints& points, const Radiance& radiance) {
    assert(radiance.size() == points.count());
    SpherePicture picture{.size = points.size,
                          .radiance = std::vector<float>(3 * points.coverage.size()),
                          .coverage = points.coverage,
                          .colours = {}};
    for (std::size_t pixel = 0; pixel < points.coverage.size(); ++pixel) {
        Rgb total{};
        const std::size_t first = points.first[pixel], last = points.first[pixel + 1];
        for (std::size_t k = first; k < last; ++k) {
            for (std::size_t c = 0; c < 3; ++c) total[c] += radiance[k][c];
        }
        for (std::size_t c = 0; c < 3 && last > first; ++c) {
            picture.radiance[3 * pixel + c] =
                static_cast<float>(total[c] / static_cast<double>(last - first));
        }
    }
    return picture;
}

}  // namespace hshfit::inline rendering
