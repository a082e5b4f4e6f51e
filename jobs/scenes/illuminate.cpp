#include "illuminate.h"

#include <jobs/common/clock.h>

#include "illuminate_options.h"
#include "kept_rows.h"
#include "record_picture.h"
#include "scene_surfaces.h"

#include <hshfit/error.h>
#include <hshfit/files/file_set.h>
#include <hshfit/pictures/rgb_picture.h>
#include <hshfit/transport/possible_radiance.h>
#include <hshfit/transport/radiance_cache/cached_picture.h>
#include <hshfit/version.h>
#include <hshfit/wording.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <memory>

namespace hshfit::jobs {
namespace {

double cpuSeconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
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

/// A picture by either method, with its time.
PathPicture taken(const SurfaceScene& scene, RadianceCache* cache, const Camera& camera,
                  const IlluminateOptions& options, const Listener& listener, KeptRows* kept,
                  const TimeLimit& limit, IlluminatedCamera& result) {
    const auto start = Clock::now();
    const double cpu = cpuSeconds();
    PathPicture picture;
    if (cache) {
        CachedPicture cached =
            takePicture(*cache, camera,
                        {.samples = options.path.samples, .progress = listener.part(camera.name)});
        picture = std::move(cached.picture);
        result.records = cache->records().size();
        result.made = cached.made;
        result.bytes = cache->bytes();
        result.uncovered = cached.uncovered;
    } else {
        PathOptions path = options.path;
        path.progress = listener.part(camera.name);
        path.samples = samplesWithin(scene, camera, path, limit);
        if (path.samples < options.path.samples)
            listener.say(fmt::format("{}: {} of {} paths a pixel fit into the time", camera.name,
                                     path.samples, options.path.samples));
        result.samples = path.samples;
        picture = tracePaths(scene, camera, path, kept ? kept->rows() : PathRows{});
        if (kept) result.resumedRows = kept->taken();
    }
    result.seconds = secondsSince(start);
    result.cpuSeconds = cpuSeconds() - cpu;
    result.rays = picture.rays;
    result.cut = picture.cut;
    return picture;
}

/// Takes the picture and adds its files to the set.
IlluminatedCamera pictured(const SurfaceScene& scene, std::span<const Light> lights,
                           RadianceCache* cache, const Camera& camera,
                           const IlluminateOptions& options, const Listener& listener,
                           KeptRows* kept, const TimeLimit& limit, FileSet& files) {
    IlluminatedCamera result{.name = camera.name,
                             .width = camera.width,
                             .height = camera.height,
                             .samples = options.path.samples};
    PathPicture traced = taken(scene, cache, camera, options, listener, kept, limit, result);
    requirePossible({.name = (files.folder() / (camera.name + ".exr")).string(),
                     .width = camera.width,
                     .radiance = traced.radiance,
                     .error = traced.error,
                     .samples = result.samples},
                    scene, lights);
    const RgbPicture picture{camera.width, camera.height, std::move(traced.radiance)};
    const RgbPicture error{camera.width, camera.height, std::move(traced.error)};
    const auto count = static_cast<double>(picture.values.size());
    double squares = 0;
    for (const float value : picture.values) result.mean += static_cast<double>(value) / count;
    for (const float value : error.values)
        squares += static_cast<double>(value) * static_cast<double>(value) / count;
    if (result.mean > 0 && result.samples > 1) {
        const auto largest = std::ranges::max_element(error.values);
        const auto pixel = static_cast<int>((largest - error.values.begin()) / 3);
        result.standardError = std::sqrt(squares) / result.mean;
        result.largestError = static_cast<double>(*largest) / result.mean;
        result.errorColumn = pixel % camera.width;
        result.errorRow = pixel / camera.width;
    }
    if (!(result.mean > 0)) {
        listener.say(fmt::format("camera '{}' sees no light: it may stand inside of an object",
                                 camera.name));
    }
    if (!options.reference.empty())
        result.reference = errorAgainst(readRgbExr(options.reference), picture, options.reference);
    result.stops = options.exposure.value_or(automaticExposure(picture));
    const std::vector<NamedPicture> more{{"error", &error}};
    files.write(camera.name + ".exr", [&](AtomicFile& file) {
        writeRgbExr(picture, more, file,
                    {{"hshfit:generator", std::string("hshfit ") + version},
                     {"hshfit:method", std::string(nameOf(options.method))},
                     {"hshfit:samples", std::to_string(result.samples)}});
    });
    files.write(camera.name + ".png", rgbPng(picture, result.stops));
    std::vector<const char*> extensions{".exr", ".png"};
    if (cache) {
        files.write(camera.name + ".records.png",
                    rgbPng(withRecords(picture, *cache, camera, *result.records - *result.made,
                                       result.stops),
                           result.stops));
        extensions.push_back(".records.png");
    }
    for (const char* extension : extensions)
        result.files.push_back((files.folder() / (camera.name + extension)).string());
    return result;
}

/// Replaces the file if there is one: what it held is among the records.
void writeKept(const RadianceCache& cache, const std::string& path, const std::string& key) {
    AtomicFile file(path, AtomicFile::Existing::always);
    writeRecords(cache.stored(key), file);
    file.commit();
}

/// The light on surfaces, and the settings on which records depend.
std::string keyOfRecords(const scene::Scene& read, const SceneSurfaces& surfaces,
                         const IlluminateOptions& options) {
    const CacheOptions& cache = options.cache;
    return fmt::format("{} {} {} {} {} {}", lightKey(read, surfaces), cache.choice.basis,
                       cache.choice.order, cache.choice.loss,
                       cache.direct == DirectLight::gathered ? "gathered" : "sampled",
                       options.path.mostBounces);
}

std::unique_ptr<RadianceCache> cacheOf(const SurfaceScene& scene, const CacheOptions& options,
                                       const std::string& records, const std::string& key) {
    if (records.empty() || !std::filesystem::exists(records))
        return std::make_unique<RadianceCache>(scene, options);
    return std::make_unique<RadianceCache>(scene, options, readRecords(records, key));
}

}  // namespace

Illuminated illuminate(const std::string& path, const std::string& folder,
                       const IlluminateOptions& asked, const Listener& listener) {
    const auto start = Clock::now();
    const IlluminateOptions options = settled(asked);
    Illuminated result{.scene = path, .method = options.method};
    const scene::Scene read = scene::readScene(path, scene::Purpose::transport);
    const std::vector<const Camera*> cameras = camerasOf(read, options.camera);
    if (!options.reference.empty() && cameras.size() > 1) {
        throw UsageError(fmt::format("{} is the picture of one camera: name it with {}",
                                     Setting{"IlluminateOptions::reference"},
                                     Setting{"IlluminateOptions::camera"}));
    }
    for (const Camera* camera : cameras) CameraRays{*camera};
    FileSet files(folder, options.force);
    for (const Camera* camera : cameras)
        for (const char* extension : {".exr", ".png"}) files.requireFree(camera->name + extension);
    SceneSurfaces surfaces = surfacesOf(read, listener);
    result.degenerate = surfaces.degenerate;
    std::vector<std::unique_ptr<KeptRows>> kept;
    const std::string inputs = options.resume ? inputsKey(read, surfaces) : std::string();
    const std::string recordsKey =
        options.caches() && !options.records.empty() ? keyOfRecords(read, surfaces, options) : "";
    const SurfaceScene scene(std::move(surfaces.materials), std::move(surfaces.objects),
                             read.lights);
    result.triangles = scene.triangles();
    std::unique_ptr<RadianceCache> cache;
    if (options.caches()) {
        const double cpu = cpuSeconds();
        CacheOptions settings = options.cache;
        settings.progress = listener.part("light on diffuse surfaces");
        cache = cacheOf(scene, settings, options.records, recordsKey);
        // All cameras count, so that runs with one camera after the other choose as one run with
        // all.
        const std::vector<MaterialCost> costs =
            predictCosts(*cache, camerasOf(read, ""), options.path.samples);
        for (std::size_t k = 0; k < read.materials.size(); ++k) {
            if (options.chooseBy == RecordsBy::cost && costs[k].samplingIsCheaper())
                cache->sample(k, costs[k].walks);
            const MaterialLight& light = cache->materials().materials[k];
            LitMaterial& lit = result.materials.emplace_back(
                LitMaterial{read.materials[k].name, light.way, light.order, light.loss,
                            light.reason, light.walks});
            if (costs[k].pixels > 0) lit.cost = costs[k];
        }
        result.cacheCpuSeconds = cpuSeconds() - cpu;
    }
    result.preparationSeconds = secondsSince(start);
    const TimeLimit limit(options.seconds);
    for (const Camera* camera : cameras) {
        if (options.resume) {
            const auto place = files.folder() / (".hshfit-" + camera->name + ".partial");
            kept.push_back(
                std::make_unique<KeptRows>(place.string(), inputs, *camera, options.path));
        }
        const auto left = static_cast<double>(cameras.size() - result.cameras.size());
        result.cameras.push_back(pictured(scene, read.lights, cache.get(), *camera, options,
                                          listener, kept.empty() ? nullptr : kept.back().get(),
                                          limit.share(left), files));
    }
    if (cache && !options.records.empty()) writeKept(*cache, options.records, recordsKey);
    files.commit();
    for (const auto& one : kept) one->remove();
    return result;
}

}  // namespace hshfit::jobs
