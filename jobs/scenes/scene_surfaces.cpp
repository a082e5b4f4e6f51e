#include "scene_surfaces.h"

#include <jobs/source/source.h>

#include <hshfit/error.h>
#include <hshfit/meshes/mesh_file.h>
#include <hshfit/sampling/make_sampler.h>

#include <fmt/format.h>

#include <cmath>

namespace hshfit::jobs {
namespace {

/// Squares of larger coordinates come near the end of single precision's range.
constexpr float largestCoordinate = 1e15F;

Mesh meshOf(const scene::Object& object, const std::string& file, std::size_t& degenerate) {
    Mesh mesh;
    bool yUp = object.yUp.value_or(false);
    if (object.mesh == "sphere") {
        mesh = sphereMesh(6);
    } else if (object.mesh == "square") {
        mesh = squareMesh();
    } else {
        MeshFile read = readMesh(object.mesh);
        degenerate += read.degenerate;
        yUp = object.yUp.value_or(read.yUp);
        mesh = std::move(read.mesh);
    }
    if (yUp) turnUpright(mesh);
    const Frame frame(object.orientation);
    const Point& scale = object.scale;
    const auto placed = [&](const MeshVector& v, const Point& factors, const Point& at) {
        const Direction d =
            frame.toWorld({factors[0] * v[0], factors[1] * v[1], factors[2] * v[2]});
        return MeshVector{static_cast<float>(d.x + at[0]), static_cast<float>(d.y + at[1]),
                          static_cast<float>(d.z + at[2])};
    };
    for (MeshVector& position : mesh.positions) position = placed(position, scale, object.at);
    for (const MeshVector& position : mesh.positions) {
        for (const float x : position) {
            if (std::abs(x) <= largestCoordinate) continue;
            throw InputError(fmt::format(
                "{}: object '{}' has the coordinate {:g} in the world; at most {:g} is told apart",
                file, object.name.empty() ? object.mesh : object.name, x, largestCoordinate));
        }
    }
    // Normals lean the other way than the surface.
    const Point inverse{1 / scale[0], 1 / scale[1], 1 / scale[2]};
    for (MeshVector& normal : mesh.normals) normal = placed(normal, inverse, {});
    // A scale may leave less than single precision tells apart.
    degenerate += dropDegenerate(mesh);
    if (mesh.triangles.empty()) {
        throw InputError(fmt::format("{}: object '{}': none of its triangles has an area", file,
                                     object.name.empty() ? object.mesh : object.name));
    }
    completeNormals(mesh);
    return mesh;
}

/// A wrong specification in a file is invalid input.
std::unique_ptr<Brdf> brdfOf(const scene::Material& material, const std::string& file) {
    try {
        return openSource(material.brdf, true);
    } catch (const UsageError& error) {
        throw InputError(fmt::format("{}: material '{}': {}", file, material.name, error.what()));
    }
}

}  // namespace

SceneSurfaces surfacesOf(const scene::Scene& read, const Listener& listener) {
    SceneSurfaces surfaces;
    const ProgressCall progress = listener.part("materials");
    for (const scene::Material& material : read.materials) {
        SurfaceMaterial& surface = surfaces.materials.emplace_back();
        surface.name = material.name;
        surface.brdf = brdfOf(material, read.file);
        surface.sampler = makeSampler(*surface.brdf);
        if (progress) progress(surfaces.materials.size(), read.materials.size());
    }
    surfaces.objects = objectsOf(read, surfaces.degenerate);
    return surfaces;
}

std::vector<SurfaceObject> objectsOf(const scene::Scene& read, std::size_t& degenerate) {
    std::vector<SurfaceObject> objects;
    for (const scene::Object& object : read.objects) {
        objects.push_back(
            {object.name, meshOf(object, read.file, degenerate), object.material, object.emission});
    }
    return objects;
}

std::vector<const Camera*> camerasOf(const scene::Scene& read, const std::string& wanted) {
    std::vector<const Camera*> cameras;
    std::string names;
    for (const Camera& camera : read.cameras) {
        if (wanted.empty() || camera.name == wanted) cameras.push_back(&camera);
        names += (names.empty() ? "" : ", ") + camera.name;
    }
    if (cameras.empty()) {
        throw UsageError(
            fmt::format("{}: it has no camera '{}'; it has: {}", read.file, wanted, names));
    }
    return cameras;
}

}  // namespace hshfit::jobs
