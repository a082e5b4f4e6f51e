#pragma once

#include <hshfit/light/lights.h>
#include <hshfit/light/views.h>
#include <hshfit/transport/camera.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::scene {

struct Limits {
    std::size_t bytes = 245760;         ///< a fifth of HSH order 10 on 32 x 32, RGB float32
    std::optional<double> nanoseconds;  ///< per pair, in batches of 4096; with PlanOptions::byTime
};

struct Material {
    std::string name;  ///< its file has this name: letters, digits, '-', '_', '.'
    std::string brdf;  ///< a specification
    std::string lobe =
        {};  ///< a specification of a lobe that may be split off (from `fit`); may be empty
    std::vector<Orientation> orientations = {{}};
    bool orientationsStated = false;      ///< by the file
    std::optional<ViewRange> views = {};  ///< in the place of the scene's
    Budget budget = {};
};

/// A mesh in the world: turned upright if its +y is up, scaled along its axes, turned so that its
/// +z points to the orientation, then moved.
struct Object {
    std::string name;
    std::string mesh;  ///< a path, or "sphere" (unit) or "square" (from -1 to 1, upwards)
    std::size_t material = 0;
    Rgb emission{};  ///< radiance of its front
    /// The file's +y is up; none: where its format says so (MeshFile::yUp).
    std::optional<bool> yUp = {};
    Point scale{1, 1, 1};
    Orientation orientation = {};
    Point at{};
};

struct Scene {
    std::string file;
    std::vector<Material> materials = {};
    std::vector<Light> lights = {};
    std::vector<Object> objects = {};
    std::vector<Camera> cameras = {};
    ViewRange views = {};
    bool viewsStated = false;  ///< by the file
    Limits limits = {};
};

/// The purpose says what a scene has to hold: lights and a budget, or objects, cameras
/// and light.
enum class Purpose { plan, transport };

/// Reads a scene (docs/reference/plan.md, docs/explanation/illuminate.md,
/// docs/schemas/scene.schema.json). Paths of pictures and meshes are relative to the scene file.
/// Throws InputError that names file and field and, for unknown keys, the valid ones.
Scene readScene(const std::string& path, Purpose purpose);

}  // namespace hshfit::scene
