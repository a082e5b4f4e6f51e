#pragma once

// Radiosity of an empty box whose light is part of its ceiling, by exact form factors, and the same
// box for rays.

#include <hshfit/brdf/vectors.h>
#include <hshfit/light/lights.h>
#include <hshfit/quadrature/quadrature.h>
#include <hshfit/transport/path_tracer.h>

#include <lib/transport/law_scenes.h>

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace hshfit::test {

/// Walls of the unit box without its front (y = 0); the last is the light, the middle quarter of
/// the ceiling's plane, which reflects too.
enum Wall : std::size_t { floor, ceiling, back, left, right, light };
constexpr std::size_t walls = 6;

inline Rgb reflectanceOf(std::size_t wall) {
    if (wall == left) return {0.6, 0.1, 0.05};
    if (wall == right) return {0.15, 0.5, 0.1};
    return {0.75, 0.7, 0.6};
}
constexpr Rgb lampRadiance{3, 2, 1};

struct Rectangle {
    Direction corner, u, v;  ///< the front is on the side of u x v
    std::size_t wall = 0;
    Direction normal() const { return normalised(cross(u, v)); }
    double area() const {
        const Direction n = cross(u, v);
        return std::sqrt(dot(n, n));
    }
    Direction at(double a, double b) const {
        return {corner.x + a * u.x + b * v.x, corner.y + a * u.y + b * v.y,
                corner.z + a * u.z + b * v.z};
    }
};

/// Squares of side 1 / n, n a multiple of 4; their fronts face inwards.
inline std::vector<Rectangle> patchesOf(int n) {
    const double h = 1.0 / n;
    const Rectangle whole[] = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, floor},
                               {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}, ceiling},
                               {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}, back},
                               {{0, 0, 0}, {0, 1, 0}, {0, 0, 1}, left},
                               {{1, 0, 0}, {0, 0, 1}, {0, 1, 0}, right}};
    std::vector<Rectangle> patches;
    for (const Rectangle& wall : whole) {
        for (int i = 0; i < n; ++i) {
            for (int j = 0; j < n; ++j) {
                const auto within = [&](int k) { return 4 * k >= n && 4 * k < 3 * n; };
                const bool lamp = wall.wall == ceiling && within(i) && within(j);
                patches.push_back({wall.at(i * h, j * h),
                                   {h * wall.u.x, h * wall.u.y, h * wall.u.z},
                                   {h * wall.v.x, h * wall.v.y, h * wall.v.z},
                                   lamp ? light : wall.wall});
            }
        }
    }
    return patches;
}

/// The form factor of a point with a normal to what a flat quadrilateral has above its horizon
/// (Lambert 1760): half the sum over edges of their angle times the cosine of the normal to the
/// edge's plane, over pi.
inline double factorTo(const Direction& point, const Direction& normal,
                       const std::array<Direction, 4>& corners) {
    std::array<Direction, 6> above{};
    std::size_t count = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        const Direction a = corners[k] - point, b = corners[(k + 1) % 4] - point;
        const double heightA = dot(a, normal), heightB = dot(b, normal);
        if (heightA >= 0) above[count++] = a;
        if (heightA * heightB < 0) above[count++] = a + heightA / (heightA - heightB) * (b - a);
    }
    double sum = 0;
    for (std::size_t k = 0; k < count; ++k) {
        const Direction &a = above[k], &b = above[(k + 1) % count];
        const Direction across = cross(a, b);
        const double sine = std::sqrt(dot(across, across));
        if (sine > 0) sum += std::atan2(sine, dot(a, b)) * dot(across, normal) / sine;
    }
    return std::abs(sum) / (2 * pi);
}
inline double pointFactor(const Direction& point, const Direction& normal, const Rectangle& to) {
    return factorTo(point, normal, {to.at(0, 0), to.at(1, 0), to.at(1, 1), to.at(0, 1)});
}

/// A place just off a surface, from which a line of sight meets it along its normal.
struct Place {
    Direction eye, normal;
};

/// The mean radiance that leaves a surface after exactly `bounce` reflections, by a path from each
/// of its places; the error follows from the scatter between them.
template <class PlaceOf>
PathEstimate meanOverPlaces(const SurfaceScene& scene, int bounce, int paths, PlaceOf&& placeOf) {
    PathEstimate result;
    Rgb squares{};
    for (int k = 0; k < paths; ++k) {
        const Place place = placeOf(k);
        const Rgb one = tracePaths(scene, {place.eye.x, place.eye.y, place.eye.z}, -place.normal,
                                   {.samples = 1,
                                    .mostBounces = bounce,
                                    .fewestBounces = bounce,
                                    .seed = static_cast<std::uint64_t>(k) + 1})
                            .radiance;
        for (std::size_t c = 0; c < 3; ++c) {
            result.radiance[c] += one[c] / paths;
            squares[c] += one[c] * one[c] / paths;
        }
    }
    for (std::size_t c = 0; c < 3; ++c)
        result.error[c] =
            std::sqrt(std::max(0.0, squares[c] - result.radiance[c] * result.radiance[c]) / paths);
    return result;
}

/// The k-th of a sequence of fractions that are even in [0, 1).
inline double fractionOf(int k, double step) {
    return std::fmod(0.5 + k * step, 1);
}

/// [bounce][wall]: the mean radiance that leaves a wall after that many reflections.
inline std::vector<std::array<Rgb, walls>> radianceByBounce(int n, int bounces) {
    const std::vector<Rectangle> patches = patchesOf(n);
    const GaussRule& gauss = gaussLegendre(3);
    const std::size_t count = patches.size();
    std::vector<double> factors(count * count);
    for (std::size_t i = 0; i < count; ++i) {
        const Direction normal = patches[i].normal();
        for (std::size_t j = 0; j < count; ++j) {
            // Patches of one plane do not see each other.
            if (std::abs(dot(patches[j].corner - patches[i].corner, normal)) < 1e-9 &&
                std::abs(dot(patches[j].normal(), normal)) > 0.5)
                continue;
            for (std::size_t a = 0; a < 3; ++a)
                for (std::size_t b = 0; b < 3; ++b)
                    factors[i * count + j] += gauss.weights[a] * gauss.weights[b] / 4 *
                                              pointFactor(patches[i].at((1 + gauss.nodes[a]) / 2,
                                                                        (1 + gauss.nodes[b]) / 2),
                                                          normal, patches[j]);
        }
    }
    std::vector<Rgb> radiance(count);
    for (std::size_t i = 0; i < count; ++i)
        if (patches[i].wall == light) radiance[i] = lampRadiance;
    std::vector<std::array<Rgb, walls>> result;
    for (int bounce = 0; bounce <= bounces; ++bounce) {
        std::array<Rgb, walls> means{};
        std::array<double, walls> areas{};
        for (std::size_t i = 0; i < count; ++i) {
            areas[patches[i].wall] += patches[i].area();
            for (std::size_t c = 0; c < 3; ++c)
                means[patches[i].wall][c] += patches[i].area() * radiance[i][c];
        }
        for (std::size_t w = 0; w < walls; ++w)
            for (double& value : means[w]) value /= areas[w];
        result.push_back(means);
        std::vector<Rgb> next(count);
        for (std::size_t i = 0; i < count; ++i) {
            const Rgb reflectance = reflectanceOf(patches[i].wall);
            for (std::size_t j = 0; j < count; ++j)
                for (std::size_t c = 0; c < 3; ++c)
                    next[i][c] += reflectance[c] * factors[i * count + j] * radiance[j][c];
        }
        radiance = std::move(next);
    }
    return result;
}

/// The box for rays: its patches at n = 4, so that the lamp is part of the ceiling.
inline SurfaceScene boxScene() {
    std::vector<SurfaceMaterial> materials;
    std::vector<SurfaceObject> objects;
    for (std::size_t wall = 0; wall < walls; ++wall) {
        const Rgb r = reflectanceOf(wall);
        const std::string spec = fmt::format("lambert:kd={}/{}/{}", r[0], r[1], r[2]);
        materials.push_back(materialOf(spec));
        objects.push_back({spec, {}, wall, wall == light ? lampRadiance : Rgb{}});
    }
    for (const Rectangle& patch : patchesOf(4)) {
        Mesh& mesh = objects[patch.wall].mesh;
        const auto first = static_cast<std::uint32_t>(mesh.positions.size());
        for (const auto& [a, b] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
            const Direction p = patch.at(a, b);
            mesh.positions.push_back(
                {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
        }
        mesh.triangles.push_back({first, first + 1, first + 2});
        mesh.triangles.push_back({first, first + 2, first + 3});
    }
    return {std::move(materials), std::move(objects), {}};
}

inline PathEstimate tracedRadiance(const SurfaceScene& scene, std::size_t wall, int bounce,
                                   int paths) {
    std::vector<Rectangle> own;
    for (const Rectangle& patch : patchesOf(4))
        if (patch.wall == wall) own.push_back(patch);
    return meanOverPlaces(scene, bounce, paths, [&](int k) {
        const Rectangle& patch = own[static_cast<std::size_t>(k) % own.size()];
        const Direction n = patch.normal();
        return Place{
            patch.at(fractionOf(k, 0.7548776662466927), fractionOf(k, 0.5698402909980532)) +
                0.1 * n,
            n};
    });
}

}  // namespace hshfit::test
