#pragma once

// Scenes and trials that the tests of path tracing share with docs/figures/path_laws.cpp.

#include <hshfit/brdf/vectors.h>
#include <hshfit/light/catalog.h>
#include <hshfit/sampling/make_sampler.h>
#include <hshfit/transport/path_tracer.h>

#include <brdfs/catalog.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <string>

namespace hshfit::test {

inline SurfaceMaterial materialOf(const std::string& spec) {
    SurfaceMaterial material{spec, brdfs::open(spec), nullptr};
    material.sampler = makeSampler(*material.brdf);
    return material;
}

/// Normals of its triangles in place of interpolated ones.
inline void flatten(Mesh& mesh) {
    mesh.normals.clear();
    for (const auto& t : mesh.triangles) {
        const Direction a = directionOf(mesh.positions[t[0]]);
        const Direction n = normalised(
            cross(directionOf(mesh.positions[t[1]]) - a, directionOf(mesh.positions[t[2]]) - a));
        mesh.normals.insert(
            mesh.normals.end(), 3,
            {static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z)});
    }
}

/// A square of side 6 one below the origin.
inline Mesh wideFloor() {
    Mesh floor = squareMesh();
    for (MeshVector& p : floor.positions) p = {3 * p[0], 3 * p[1], -1};
    return floor;
}

/// A white floor and a white ball in an even light of 1.
inline std::unique_ptr<SurfaceScene> whiteFurnace(bool flat, int levels = 3) {
    Mesh ball = sphereMesh(levels);
    if (flat) flatten(ball);
    return std::make_unique<SurfaceScene>(
        std::vector{materialOf("lambert")},
        std::vector<SurfaceObject>{{"floor", wideFloor(), 0, {}}, {"ball", std::move(ball), 0, {}}},
        parseLights("uniform").lights);
}

/// A glossy ball on a floor below a lamp and a sky.
inline std::unique_ptr<SurfaceScene> glossyBall() {
    Mesh lamp = squareMesh();
    for (MeshVector& p : lamp.positions) p = {0.5F * p[0], -0.5F * p[1], 2};
    lamp.normals.clear();
    return std::make_unique<SurfaceScene>(
        std::vector{materialOf("lambert:kd=.7"), materialOf("ggx:alpha=.3")},
        std::vector<SurfaceObject>{{"floor", wideFloor(), 0, {}},
                                   {"ball", sphereMesh(3), 1, {}},
                                   {"lamp", std::move(lamp), 0, {5, 5, 5}}},
        parseLights("uniform:radiance=.2").lights);
}

/// The mean of `runs` runs of `samples` paths less one run of them all, by seeds of their own, in
/// units of the standard error of that difference; 0 where nothing scatters.
inline double biasTrial(const SurfaceScene& scene, const Direction& along, int runs, int samples,
                        int trial) {
    const Point eye{4, 0, 1};
    const auto seed = [&](int run) { return static_cast<std::uint64_t>(run + 2 * runs * trial); };
    double mean = 0, squares = 0;
    for (int run = 1; run <= runs; ++run) {
        const double value =
            tracePaths(scene, eye, along, {.samples = samples, .seed = seed(run)}).radiance[1];
        mean += value / runs;
        squares += value * value / runs;
    }
    const PathEstimate one =
        tracePaths(scene, eye, along, {.samples = samples * runs, .seed = seed(runs + 1)});
    const double error =
        std::hypot(std::sqrt(std::max(0.0, squares - mean * mean) / runs), one.error[1]);
    return error > 1e-12 ? (mean - one.radiance[1]) / error : 0;
}

}  // namespace hshfit::test
