#include "illuminate.h"

#include "source.h"

#include <hshfit/error.h>
#include <hshfit/files/file_set.h>
#include <hshfit/meshes/mesh_file.h>
#include <hshfit/pictures/rgb_picture.h>
#include <hshfit/sampling/make_sampler.h>
#include <hshfit/scene/scene.h>
#include <hshfit/version.h>
#include <hshfit/wording.h>

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <memory>

namespace hshfit::jobs {
namespace {

double secondsSince(const std::chrono::steady_clock::time_point& start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}
double cpuSeconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

Mesh squareMesh() {
    Mesh mesh;
    mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    completeNormals(mesh);
    return mesh;
}

Mesh meshOf(const scene::Object& object, Illuminated& result) {
    Mesh mesh;
    if (object.mesh == "sphere") {
        mesh = sphereMesh(6);
    } else if (object.mesh == "square") {
        mesh = squareMesh();
    } else {
        MeshFile file = readMesh(object.mesh);
        result.degenerate += file.degenerate;
        mesh = std::move(file.mesh);
    }
    if (object.yUp) turnUpright(mesh);
    const Frame frame(object.orientation);
    const Point& scale = object.scale;
    const auto placed = [&](const MeshVector& v, const Point& factors, const Point& at) {
        const Direction d =
            frame.toWorld({factors[0] * v[0], factors[1] * v[1], factors[2] * v[2]});
        return MeshVector{static_cast<float>(d.x + at[0]), static_cast<float>(d.y + at[1]),
                          static_cast<float>(d.z + at[2])};
    };
    for (MeshVector& position : mesh.positions) position = placed(position, scale, object.at);
    // Normals lean the other way than the surface.
    const Point inverse{1 / scale[0], 1 / scale[1], 1 / scale[2]};
    for (MeshVector& normal : mesh.normals) normal = placed(normal, inverse, {});
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

std::unique_ptr<SurfaceScene> surfacesOf(const scene::Scene& read, Illuminated& result,
                                         const Listener& listener) {
    std::vector<SurfaceMaterial> materials;
    const ProgressCall progress = listener.part("materials");
    for (const scene::Material& material : read.materials) {
        SurfaceMaterial& surface = materials.emplace_back();
        surface.name = material.name;
        surface.brdf = brdfOf(material, read.file);
        surface.sampler = makeSampler(*surface.brdf);
        if (progress) progress(materials.size(), read.materials.size());
    }
    std::vector<SurfaceObject> objects;
    for (const scene::Object& object : read.objects)
        objects.push_back({object.name, meshOf(object, result), object.material, object.emission});
    return std::make_unique<SurfaceScene>(std::move(materials), std::move(objects), read.lights);
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

ReferenceError errorAgainst(const RgbPicture& reference, const RgbPicture& picture,
                            const std::string& path) {
    if (reference.width != picture.width || reference.height != picture.height) {
        throw InputError(fmt::format("{}: it has {} x {} pixels, and the camera {} x {}", path,
                                     reference.width, reference.height, picture.width,
                                     picture.height));
    }
    const auto count = static_cast<double>(reference.values.size());
    double mean = 0;
    for (const float value : reference.values) mean += static_cast<double>(value) / count;
    ReferenceError error;
    for (std::size_t i = 0; i < reference.values.size(); ++i) {
        const double r = reference.values[i], off = static_cast<double>(picture.values[i]) - r;
        const double term = off * off / (r * r + mean * mean / 100);
        error.relativeMse += term / count;
        if (term <= error.maximum) continue;
        error.maximum = term;
        const int pixel = static_cast<int>(i / 3);
        error.column = pixel % picture.width;
        error.row = pixel / picture.width;
    }
    return error;
}

/// Takes the picture and adds its files to the set.
IlluminatedCamera pictured(const SurfaceScene& scene, const Camera& camera,
                           const IlluminateOptions& options, const Listener& listener,
                           FileSet& files) {
    IlluminatedCamera result{.name = camera.name, .width = camera.width, .height = camera.height};
    PathOptions path = options.path;
    path.progress = listener.part(camera.name);
    const auto start = std::chrono::steady_clock::now();
    const double cpu = cpuSeconds();
    PathPicture traced = tracePaths(scene, camera, path);
    result.seconds = secondsSince(start);
    result.cpuSeconds = cpuSeconds() - cpu;
    result.rays = traced.rays;
    result.cut = traced.cut;
    const RgbPicture picture{camera.width, camera.height, std::move(traced.radiance)};
    const RgbPicture error{camera.width, camera.height, std::move(traced.error)};
    const auto count = static_cast<double>(picture.values.size());
    double squares = 0;
    for (const float value : picture.values) result.mean += static_cast<double>(value) / count;
    for (const float value : error.values)
        squares += static_cast<double>(value) * static_cast<double>(value) / count;
    if (result.mean > 0) {
        const auto largest = std::ranges::max_element(error.values);
        const auto pixel = static_cast<int>((largest - error.values.begin()) / 3);
        result.standardError = std::sqrt(squares) / result.mean;
        result.largestError = static_cast<double>(*largest) / result.mean;
        result.errorColumn = pixel % camera.width;
        result.errorRow = pixel / camera.width;
    }
    if (!options.reference.empty())
        result.reference = errorAgainst(readRgbExr(options.reference), picture, options.reference);
    result.stops = options.stops.value_or(automaticExposure(picture));
    const std::vector<NamedPicture> more{{"error", &error}};
    files.write(camera.name + ".exr", [&](AtomicFile& file) {
        writeRgbExr(picture, more, file,
                    {{"hshfit:generator", std::string("hshfit ") + version},
                     {"hshfit:method", "path"},
                     {"hshfit:samples", std::to_string(path.samples)}});
    });
    files.write(camera.name + ".png", rgbPng(picture, result.stops));
    for (const char* extension : {".exr", ".png"})
        result.files.push_back((files.folder() / (camera.name + extension)).string());
    return result;
}

}  // namespace

Illuminated illuminate(const std::string& path, const std::string& folder,
                       const IlluminateOptions& options, const Listener& listener) {
    const auto start = std::chrono::steady_clock::now();
    Illuminated result{.scene = path};
    const scene::Scene read = scene::readScene(path, scene::Purpose::transport);
    const std::vector<const Camera*> cameras = camerasOf(read, options.camera);
    if (!options.reference.empty() && cameras.size() > 1) {
        throw UsageError(fmt::format("{} is the picture of one camera: name it with {}",
                                     Setting{"IlluminateOptions::reference"},
                                     Setting{"IlluminateOptions::camera"}));
    }
    for (const Camera* camera : cameras) CameraRays{*camera};
    FileSet files(folder, options.force);
    const auto scene = surfacesOf(read, result, listener);
    result.triangles = scene->triangles();
    result.preparationSeconds = secondsSince(start);
    for (const Camera* camera : cameras)
        result.cameras.push_back(pictured(*scene, *camera, options, listener, files));
    files.commit();
    return result;
}

}  // namespace hshfit::jobs
