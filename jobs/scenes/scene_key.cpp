#include <jobs/source/content_key.h>
#include "scene_surfaces.h"

#include <hshfit/files/checksum.h>
#include <hshfit/files/mapped_file.h>
#include <hshfit/version.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <span>

namespace hshfit::jobs {
namespace {

namespace fs = std::filesystem;

template <class Number>
std::string checksumOf(const std::vector<Number>& numbers) {
    return sha256(std::as_bytes(std::span(numbers))) + "\n";
}

std::vector<double> valuesOf(const EnvironmentSampler& light) {
    std::vector<double> values;
    if (!light.any()) return values;
    constexpr std::size_t side = 16;
    const auto middle = [](std::size_t k) { return (static_cast<double>(k) + 0.5) / side; };
    for (std::size_t k = 0; k < side * side * side; ++k) {
        const EnvironmentSample sample =
            light.sample({middle(k % side), middle(k / side % side), middle(k / side / side)});
        values.insert(values.end(), {sample.world.x, sample.world.y, sample.world.z, sample.pdf});
        values.insert(values.end(), sample.radiance.begin(), sample.radiance.end());
    }
    return values;
}

}  // namespace

std::string inputsKey(const scene::Scene& read, const SceneSurfaces& surfaces) {
    const fs::path folder = fs::path(read.file).parent_path();
    const MappedFile file(read.file);
    std::string key = fmt::format("hshfit {}\n{}\n", version, sha256(std::as_bytes(file.bytes())));
    file.checkIntact();
    for (std::size_t m = 0; m < read.materials.size(); ++m) {
        key += filesKey(read.materials[m].brdf, folder);
        key += valuesKey(*surfaces.materials[m].brdf);
    }
    for (const SurfaceObject& object : surfaces.objects) {
        key += checksumOf(object.mesh.positions);
        key += checksumOf(object.mesh.triangles);
        key += checksumOf(object.mesh.normals);
    }
    return sha256(key + checksumOf(valuesOf(EnvironmentSampler(read.lights))));
}

std::string lightKey(const scene::Scene& read, const SceneSurfaces& surfaces) {
    std::string key = fmt::format("hshfit {}\n", version);
    for (const SurfaceMaterial& material : surfaces.materials) key += valuesKey(*material.brdf);
    for (const SurfaceObject& object : surfaces.objects) {
        key += checksumOf(object.mesh.positions);
        key += checksumOf(object.mesh.triangles);
        key += checksumOf(object.mesh.normals);
        key += fmt::format("{} {}\n", object.material, fmt::join(object.emission, " "));
    }
    return sha256(key + checksumOf(valuesOf(EnvironmentSampler(read.lights))));
}

}  // namespace hshfit::jobs
