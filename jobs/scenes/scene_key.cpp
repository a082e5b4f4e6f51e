#include "scene_surfaces.h"

#include <hshfit/files/checksum.h>
#include <hshfit/files/mapped_file.h>
#include <hshfit/version.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <filesystem>
#include <span>
#include <string_view>

namespace hshfit::jobs {
namespace {

namespace fs = std::filesystem;

template <class Number>
std::string checksumOf(const std::vector<Number>& numbers) {
    return sha256(std::as_bytes(std::span(numbers))) + "\n";
}

/// Path and checksum of each file that a part of a specification names.
std::string filesNamed(std::string_view specification, const fs::path& folder) {
    constexpr std::string_view separators = ":,+=";
    std::vector<std::size_t> cuts{0};
    for (std::size_t k = 0; k < specification.size(); ++k)
        if (separators.find(specification[k]) != std::string_view::npos) cuts.push_back(k + 1);
    cuts.push_back(specification.size() + 1);
    std::string text;
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
        for (std::size_t j = i + 1; j < cuts.size(); ++j) {
            const fs::path name = specification.substr(cuts[i], cuts[j] - 1 - cuts[i]);
            for (const fs::path& place : {name, folder / name}) {
                std::error_code error;
                if (name.empty() || !fs::is_regular_file(place, error) ||
                    fs::file_size(place, error) == 0)
                    continue;
                const MappedFile file(place.string());
                text += place.string() + " " + sha256(std::as_bytes(file.bytes())) + "\n";
                file.checkIntact();
            }
        }
    }
    return text;
}

/// The k-th of n directions, even over the hemisphere.
Direction latticeDirection(std::size_t k, std::size_t n) {
    const double golden = (std::sqrt(5.0) - 1) / 2;
    const double z = (static_cast<double>(k) + 0.5) / static_cast<double>(n);
    const double phi = 2 * pi * std::fmod(golden * static_cast<double>(k), 1.0);
    const double r = std::sqrt(1 - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
}

std::vector<double> valuesOf(const Brdf& brdf) {
    constexpr std::size_t side = 32;
    const std::size_t channels = brdf.channels().count();
    std::vector<double> values(side * side * channels);
    for (std::size_t o = 0; o < side; ++o) {
        const Direction wo = latticeDirection(o, side);
        for (std::size_t i = 0; i < side; ++i) {
            const Direction wi = latticeDirection(i, side);
            brdf.eval(wo, {&wi.x, &wi.y, &wi.z, 1}, values.data() + (o * side + i) * channels);
        }
    }
    return values;
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
        key += filesNamed(read.materials[m].brdf, folder);
        key += checksumOf(valuesOf(*surfaces.materials[m].brdf));
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
    for (const SurfaceMaterial& material : surfaces.materials)
        key += checksumOf(valuesOf(*material.brdf));
    for (const SurfaceObject& object : surfaces.objects) {
        key += checksumOf(object.mesh.positions);
        key += checksumOf(object.mesh.triangles);
        key += checksumOf(object.mesh.normals);
        key += fmt::format("{} {}\n", object.material, fmt::join(object.emission, " "));
    }
    return sha256(key + checksumOf(valuesOf(EnvironmentSampler(read.lights))));
}

}  // namespace hshfit::jobs
