#pragma once

#include <hshfit/brdf/vectors.h>
#include <hshfit/rendering/view.h>
#include <hshfit/transport/surface_scene.h>

#include <lib/transport/law_scenes.h>

#include <cmath>
#include <memory>
#include <vector>

namespace hshfit::test {

/// A parallelogram, its front along a x b.
inline Mesh patch(const Direction& corner, const Direction& a, const Direction& b) {
    Mesh mesh;
    for (const Direction& p : {corner, corner + a, corner + a + b, corner + b}) {
        mesh.positions.push_back(
            {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
    }
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    completeNormals(mesh);
    return mesh;
}

/// The inside of a cube from -1 to 1, without its ceiling unless `closed`.
inline std::vector<SurfaceObject> room(const Rgb& emission, bool closed, std::size_t floor = 0) {
    std::vector<SurfaceObject> objects{
        {"floor", patch({-1, -1, -1}, {2, 0, 0}, {0, 2, 0}), floor, emission},
        {"left", patch({-1, -1, -1}, {0, 2, 0}, {0, 0, 2}), 0, emission},
        {"right", patch({1, -1, -1}, {0, 0, 2}, {0, 2, 0}), 0, emission},
        {"near", patch({-1, -1, -1}, {0, 0, 2}, {2, 0, 0}), 0, emission},
        {"far", patch({-1, 1, -1}, {2, 0, 0}, {0, 0, 2}), 0, emission}};
    if (closed)
        objects.push_back({"ceiling", patch({-1, -1, 1}, {0, 2, 0}, {2, 0, 0}), 0, emission});
    return objects;
}

/// With a lamp below the ceiling of a room.
inline std::vector<SurfaceObject> lamp(std::vector<SurfaceObject> objects) {
    objects.push_back({"lamp", patch({-0.3, -0.3, 0.95}, {0, 0.6, 0}, {0.6, 0, 0}), 0, {9, 8, 7}});
    return objects;
}

/// Two plates that reach a hundred times their distance.
inline std::vector<SurfaceObject> plates() {
    return {{"lower", patch({-100, -100, 0}, {200, 0, 0}, {0, 200, 0}), 0, {0.2, 0.2, 0.2}},
            {"upper", patch({-100, -100, 1}, {0, 200, 0}, {200, 0, 0}), 0, {0.2, 0.2, 0.2}}};
}

/// A square picture whose half is `slope` high at distance 1.
inline Camera lookingFrom(const Point& position, const Point& target, double slope, int size) {
    return {.name = "eye",
            .position = position,
            .target = target,
            .fieldOfView = 2 * std::atan(slope),
            .width = size,
            .height = size};
}

/// A room with a lamp, a glossy floor and a curved glossy thing.
inline std::unique_ptr<SurfaceScene> litRoom() {
    std::vector<SurfaceObject> objects = lamp(room({}, true, 1));
    Mesh ball = sphereMesh(3);
    for (MeshVector& p : ball.positions) p = {0.3F * p[0], 0.3F * p[1] + 0.3F, 0.3F * p[2] - 0.7F};
    objects.push_back({"ball", std::move(ball), 1, {}});
    return std::make_unique<SurfaceScene>(
        std::vector{materialOf("lambert:kd=.7/.5/.3"),
                    materialOf("phong:kd=.2,ks=.6,exponent=10,normalized=true")},
        std::move(objects), std::vector<Light>{});
}

}  // namespace hshfit::test
