#pragma once

#include <jobs/common/listener.h>

#include <hshfit/scene/scene.h>
#include <hshfit/transport/surface_scene.h>

#include <cstddef>
#include <string>
#include <vector>

namespace hshfit::jobs {

/// Materials and meshes of a scene file, ready for a SurfaceScene.
struct SceneSurfaces {
    std::vector<SurfaceMaterial> materials = {};
    std::vector<SurfaceObject> objects = {};  ///< in the order of the file, in the world
    std::size_t degenerate = 0;               ///< triangles without area, left out
};

/// Opens materials and their samplers, and places meshes. Throws InputError that names the file.
SceneSurfaces surfacesOf(const scene::Scene& read, const Listener& listener);

/// The objects alone, with the number of triangles left out.
std::vector<SurfaceObject> objectsOf(const scene::Scene& read, std::size_t& degenerate);

/// The key (Checkpoint) of work on a scene: the version of the program, the bytes of the scene file
/// and of the files that its materials name, every mesh, 1,024 values of each material, and 4,096
/// samples of the light, which follow all of its radiance.
std::string inputsKey(const scene::Scene& read, const SceneSurfaces& surfaces);

/// The key of light on surfaces, which depends neither on cameras nor on names: the version,
/// materials by their values, meshes, emission and light.
std::string lightKey(const scene::Scene& read, const SceneSurfaces& surfaces);

/// The camera of a name, or all of them where the name is empty. Throws UsageError that lists
/// the names. They point into `read`.
std::vector<const Camera*> camerasOf(const scene::Scene& read, const std::string& wanted);

}  // namespace hshfit::jobs
