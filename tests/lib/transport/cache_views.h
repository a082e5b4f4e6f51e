#pragma once

// Scenes in which the radiance cache has to come to the pictures of path tracing:
// radiance_cache_views_test in short, docs/figures/cache_views.cpp at length.

#include <lib/transport/cache_scenes.h>

#include <string>

namespace hshfit::test {

struct CacheView {
    std::string name;
    std::unique_ptr<SurfaceScene> scene;
    Camera camera;
};

inline std::unique_ptr<SurfaceScene> litBy(const char* light, std::vector<SurfaceObject> objects) {
    return std::make_unique<SurfaceScene>(
        std::vector{materialOf("lambert:kd=.7/.5/.3"),
                    materialOf("phong:kd=.2,ks=.6,exponent=10,normalized=true"),
                    materialOf("lambert:kd=.8")},
        std::move(objects), *light ? parseLights(light).lights : std::vector<Light>{});
}

/// The six sides of a box that stands on z = 0, seen from outside.
inline SurfaceObject block(const Direction& corner, const Direction& size, std::size_t material) {
    const Direction x{size.x, 0, 0}, y{0, size.y, 0}, z{0, 0, size.z};
    Mesh mesh;
    const auto add = [&](const Direction& at, const Direction& a, const Direction& b) {
        const Mesh side = patch(at, a, b);
        const auto first = static_cast<std::uint32_t>(mesh.positions.size());
        mesh.positions.insert(mesh.positions.end(), side.positions.begin(), side.positions.end());
        for (const auto& t : side.triangles)
            mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
        mesh.normals.insert(mesh.normals.end(), side.normals.begin(), side.normals.end());
    };
    add(corner + z, x, y), add(corner, y, x), add(corner, x, z), add(corner + y, z, x);
    add(corner, z, y), add(corner + x, y, z);
    return {"block", std::move(mesh), material, {}};
}

/// Two squares at right angles.
inline std::vector<SurfaceObject> corner() {
    return {{"floor", patch({-1, 0, 0}, {2, 0, 0}, {0, 2, 0}), 2, {}},
            {"wall", patch({-1, 0, 0}, {0, 0, 2}, {2, 0, 0}), 2, {}}};
}

inline std::vector<SurfaceObject> furnished() {
    std::vector<SurfaceObject> objects = lamp(room({}, true));
    objects.push_back(block({-0.7, 0, -1}, {0.5, 0.5, 1.1}, 2));
    objects.push_back(block({0.1, -0.3, -1}, {0.5, 0.5, 0.5}, 0));
    return objects;
}

inline std::vector<SurfaceObject> table() {
    std::vector<SurfaceObject> objects{
        {"ground", patch({-100, -100, 0}, {200, 0, 0}, {0, 200, 0}), 2, {}},
        block({-0.8, -0.5, 0.7}, {1.6, 1, 0.06}, 0)};
    for (const double x : {-0.75, 0.69})
        for (const double y : {-0.45, 0.39})
            objects.push_back(block({x, y, 0}, {0.06, 0.06, 0.7}, 0));
    return objects;
}

/// A camera in the middle of `room` for whose pixels' centres the edges of the far wall lie on a
/// row and a column.
inline Camera onEdges(int size) {
    return lookingFrom({0, 0, 0}, {0, 1, 0}, size / (2.0 * (size * 7 / 8) + 1 - size), size);
}

inline std::vector<CacheView> cacheViews(int size) {
    std::vector<CacheView> views;
    const auto add = [&](const char* name, std::unique_ptr<SurfaceScene> scene, Camera camera) {
        views.push_back({name, std::move(scene), std::move(camera)});
    };
    const int odd = size | 1;
    const char *even = "uniform", *sky = "sky:type=12,elevation=50,azimuth=20,radiance=1";
    add("corner, in its plane of symmetry", litBy(even, corner()),
        lookingFrom({0, 3, 3}, {0, 0, 0}, 0.4, odd));
    add("corner, from aside", litBy(even, corner()),
        lookingFrom({0.8, 3.2, 2.1}, {0.1, 0.3, 0.2}, 0.4, size));
    add("open room, symmetric", litBy(even, room({}, false)),
        lookingFrom({0, -0.98, 0.2}, {0, 1, 0.2}, 0.7, odd));
    Camera above = lookingFrom({0, 0, 3.4}, {0, 0, 0}, 0.35, size);
    above.up = {0, 1, 0};
    add("open room, from above", litBy(sky, room({}, false)), above);
    add("closed room, edges on pixels", litBy("", lamp(room({}, true))), onEdges(size));
    add("closed room, from aside", litBy("", lamp(room({}, true))),
        lookingFrom({0.4, -0.7, -0.1}, {-0.2, 0.9, 0.1}, 0.9, size));
    add("glossy floor, edges on pixels", litBy("", lamp(room({}, true, 1))), onEdges(size));
    add("glossy floor, from aside", litBy("", lamp(room({}, true, 1))),
        lookingFrom({0.5, -0.8, 0.3}, {-0.2, 0.6, -0.8}, 0.8, size));
    add("blocks in a room, symmetric", litBy("", furnished()),
        lookingFrom({0, -0.98, 0}, {0, 1, 0}, 0.8, odd));
    add("blocks in a room, from aside", litBy("", furnished()),
        lookingFrom({-0.6, -0.9, 0.4}, {0.2, 0.4, -0.6}, 0.7, size));
    add("two wide plates", litBy("", plates()),
        lookingFrom({0, 0, 0.5}, {0.36, 0.48, 0}, 0.5, size));
    add("table on a wide ground", litBy(sky, table()),
        lookingFrom({1.2, -2.6, 1.1}, {0, 0, 0.35}, 0.35, size));
    return views;
}

}  // namespace hshfit::test
