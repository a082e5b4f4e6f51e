// ray_leaks RAYS [MESH]: rays in closed meshes that meet nothing, as a table of
// docs/results/illumination.md: even rays from places inside, rays at edges and at vertices, and
// paths that are scattered by the inside, each with Embree's test alone and as RayScene traces
// them. Of paths, `again` counts rays that meet their own plane or a neighbour's at once. Rays at
// edges and vertices are a tenth of RAYS. MESH is a number from 1; default: all.

#include <hshfit/brdf/vectors.h>
#include <hshfit/rays/ray_scene.h>
#include <hshfit/transport/surface_scene.h>

#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <random>
#include <string>

namespace {

using namespace hshfit;

/// Uniform numbers in [0, 1).
class RandomNumbers {
public:
    explicit RandomNumbers(unsigned seed) : engine_(seed) {}
    double next() { return std::ldexp(static_cast<double>(engine_() >> 11), -53); }

private:
    std::mt19937_64 engine_;
};

struct Closed {
    std::string name;
    Mesh mesh;
    Point middle{};  ///< inside, with a sphere of `radius` about it
    double radius = 0.3;
};

/// A box of side 2 whose faces are squares of n x n, with vertices of their own.
Mesh boxMesh(std::uint32_t n) {
    Mesh mesh;
    for (std::size_t face = 0; face < 6; ++face) {
        const auto first = static_cast<std::uint32_t>(mesh.positions.size());
        const std::size_t axis = face / 2;
        for (std::uint32_t i = 0; i <= n; ++i) {
            for (std::uint32_t j = 0; j <= n; ++j) {
                MeshVector p{};
                p[axis] = face % 2 == 1 ? 1 : -1;
                p[(axis + 1) % 3] = 2 * static_cast<float>(i) / static_cast<float>(n) - 1;
                p[(axis + 2) % 3] = 2 * static_cast<float>(j) / static_cast<float>(n) - 1;
                mesh.positions.push_back(p);
            }
        }
        for (std::uint32_t i = 0; i < n; ++i) {
            for (std::uint32_t j = 0; j < n; ++j) {
                const std::uint32_t a = first + i * (n + 1) + j, b = a + n + 1;
                mesh.triangles.push_back({a, b, b + 1});
                mesh.triangles.push_back({a, b + 1, a + 1});
            }
        }
    }
    return mesh;
}

/// Stretched along its axes, turned out of them, and moved along all three.
Mesh placed(Mesh mesh, const Point& scale, double move) {
    const Frame frame({.theta = 0.7, .phi = 0.4, .turn = 0.3});
    for (MeshVector& p : mesh.positions) {
        const Direction d = frame.toWorld({scale[0] * p[0], scale[1] * p[1], scale[2] * p[2]});
        p = {static_cast<float>(d.x + move), static_cast<float>(d.y + move),
             static_cast<float>(d.z + move)};
    }
    mesh.normals.clear();
    return mesh;
}

/// A tetrahedron with an edge along x at which two faces meet at 5 degrees.
Mesh wedgeMesh() {
    const auto high = static_cast<float>(2 * std::tan(radians(2.5)));
    return {.positions = {{-1, 0, 0}, {1, 0, 0}, {0, 2, high}, {0, 2, -high}},
            .triangles = {{0, 1, 2}, {1, 0, 3}, {0, 2, 3}, {1, 3, 2}},
            .normals = {}};
}

Direction even(RandomNumbers& random) {
    const double z = 2 * random.next() - 1, phi = 2 * pi * random.next();
    const double r = std::sqrt(1 - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
}

enum class Aim { even, edges, vertices };

Direction aimed(const Closed& closed, const Point& origin, Aim aim, RandomNumbers& random) {
    if (aim == Aim::even) return even(random);
    const auto& triangles = closed.mesh.triangles;
    const auto& t =
        triangles[static_cast<std::size_t>(random.next() * static_cast<double>(triangles.size()))];
    const Direction a = directionOf(closed.mesh.positions[t[0]]);
    const Direction b = directionOf(closed.mesh.positions[t[1]]);
    const double w = aim == Aim::edges ? random.next() : 0;
    return {a.x + w * (b.x - a.x) - origin[0], a.y + w * (b.y - a.y) - origin[1],
            a.z + w * (b.z - a.z) - origin[2]};
}

/// Runs `work` with a sequence of its own for each of 1,000 blocks, and gives the sum.
template <class Work>
std::size_t summed(const Work& work) {
    std::atomic<std::size_t> sum = 0;
    tbb::parallel_for(0, 1000, [&](int block) {
        RandomNumbers random(static_cast<unsigned>(block));
        sum += work(random);
    });
    return sum;
}

void printRays(const Closed& closed, Aim aim, const char* name, std::size_t count) {
    const RayScene scene(closed.mesh);
    std::atomic<std::size_t> once = 0;
    const std::size_t missed = summed([&](RandomNumbers& random) {
        std::size_t lost = 0;
        for (std::size_t k = 0; k < count / 1000; ++k) {
            const Direction d = even(random);
            const double r = closed.radius * random.next();
            const Point origin{closed.middle[0] + r * d.x, closed.middle[1] + r * d.y,
                               closed.middle[2] + r * d.z};
            const Direction along = aimed(closed, origin, aim, random);
            if (scene.firstHitOnce(origin, along)) continue;
            ++once;
            lost += scene.firstHit(origin, along) ? 0 : 1;
        }
        return lost;
    });
    fmt::print("| {} | {} | {:.0e} | {} | {} | |\n", closed.name, name, static_cast<double>(count),
               once.load(), missed);
}

void printPaths(const Closed& closed, std::size_t count) {
    const SurfaceScene scene({{"grey", nullptr, nullptr}}, {{"closed", closed.mesh, 0, {}}}, {});
    std::atomic<std::size_t> again = 0;
    const std::size_t missed = summed([&](RandomNumbers& random) {
        std::size_t lost = 0;
        auto hit = scene.firstHit(closed.middle, even(random));
        for (std::size_t k = 0; k < count / 1000; ++k) {
            if (!hit) {
                ++lost;
                hit = scene.firstHit(closed.middle, even(random));
                continue;
            }
            // The density is in proportion to the cosine about the triangle's own normal.
            const Direction unit = even(random);
            const Direction along =
                normalised({hit->flat.x + unit.x, hit->flat.y + unit.y, hit->flat.z + unit.z});
            const auto next = scene.firstHit(*hit, along);
            if (next && next->triangle == hit->triangle) ++again;
            // A plane that the ray leaves, met again within rounding.
            if (next && std::abs(dot(next->flat, hit->flat)) > 1 - 1e-9 && next->distance < 1e-4)
                ++again;
            hit = next;
        }
        return lost;
    });
    fmt::print("| {} | paths | {:.0e} | | {} | {} |\n", closed.name, static_cast<double>(count),
               missed, again.load());
}

}  // namespace

int main(int count, char** words) {
    const auto rays = static_cast<std::size_t>(count > 1 ? std::atof(words[1]) : 1e6);
    const Closed all[] = {
        {"sphere, 512 triangles", sphereMesh(3)},
        {"sphere, 32,768 triangles", sphereMesh(6)},
        {"sphere, 32,768 triangles, 100 away",
         placed(sphereMesh(6), {1, 1, 1}, 100),
         {100, 100, 100}},
        {"box, 12 triangles, turned", placed(boxMesh(1), {1, 1, 1}, 0)},
        {"box, 49,152 triangles, turned", placed(boxMesh(64), {1, 1, 1}, 0)},
        {"box, 49,152 triangles, turned, 1000 away",
         placed(boxMesh(64), {1, 1, 1}, 1000),
         {1000, 1000, 1000}},
        {"needle, 1 : 100 : 1000", placed(sphereMesh(5), {1, 0.01, 0.001}, 0), {}, 5e-4},
        {"wedge of 5 degrees", wedgeMesh(), {0, 1.5, 0}, 0.03},
    };
    fmt::print(
        "| mesh | rays | number | missed by Embree | missed by RayScene | again |\n"
        "|---|---|---|---|---|---|\n");
    const int only = count > 2 ? std::atoi(words[2]) : 0;
    for (const Closed& closed : all) {
        if (only > 0 && &closed != all + only - 1) continue;
        printRays(closed, Aim::even, "even", rays);
        printRays(closed, Aim::edges, "at edges", rays / 10);
        printRays(closed, Aim::vertices, "at vertices", rays / 10);
        printPaths(closed, rays);
        std::fflush(stdout);
    }
}
