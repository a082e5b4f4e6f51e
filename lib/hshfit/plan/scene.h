#pragma once

#include <hshfit/light/lights.h>
#include <hshfit/light/views.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::plan {

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
    Budget budget = {};
};

struct Scene {
    std::string file;
    std::vector<Material> materials;
    std::vector<Light> lights;
    ViewRange views;
    Limits limits;
};

/// Reads a scene (docs/plan.md, docs/schemas/scene.schema.json). Paths of pictures are relative to
/// the scene file. Throws InputError that names file and field and, for unknown keys, the valid
/// ones.
Scene readScene(const std::string& path);

}  // namespace hshfit::plan
