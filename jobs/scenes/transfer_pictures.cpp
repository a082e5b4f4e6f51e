#include "transfer_pictures.h"

#include <hshfit/bases/catalog.h>
#include <hshfit/light/catalog.h>
#include <hshfit/light/light_projection.h>
#include <hshfit/percent.h>
#include <hshfit/pictures/rgb_picture.h>
#include <hshfit/transport/path_tracer.h>
#include <hshfit/transport/possible_radiance.h>

#include <fmt/format.h>

#include <cctype>
#include <cmath>

namespace hshfit::jobs {
namespace {

/// A picture of radiance by its first bands.
std::vector<float> pictureOf(const PictureScene& scene, const Camera& camera,
                             const LightCoefficients& light, int bands) {
    const LitTransfer lit(scene.mesh, scene.materials, scene.transfer, light, bands);
    return transferPicture(scene.mesh, scene.rays, lit, camera);
}

TransferPictureError errorOf(const std::vector<float>& reference, const std::vector<float>& found,
                             int width) {
    TransferPictureError error;
    double squares = 0, whole = 0, sum = 0;
    for (std::size_t k = 0; k < reference.size(); ++k) {
        const double r = reference[k], off = std::abs(static_cast<double>(found[k]) - r);
        squares += off * off;
        whole += r * r;
        sum += r;
        if (off <= error.maximum) continue;
        error.maximum = off;
        const int pixel = static_cast<int>(k / 3);
        error.column = pixel % width;
        error.row = pixel / width;
    }
    if (!(whole > 0)) return error;
    error.relativeL2 = std::sqrt(squares / whole);
    error.maximum /= sum / static_cast<double>(reference.size());
    return error;
}

/// Reflections in light of the kind.
int reflectionsOf(const TransferOptions& options) {
    return options.kind == TransferKind::interreflected ? options.passes + 1 : 1;
}

PathOptions pathsOf(const TransferOptions& options) {
    return {.samples = options.referenceSamples,
            .mostBounces = reflectionsOf(options),
            .fewestBounces = 1,
            .seed = options.seed};
}

double relativeNoise(const PathPicture& picture) {
    double squares = 0, whole = 0;
    for (std::size_t k = 0; k < picture.radiance.size(); ++k) {
        squares += std::pow(static_cast<double>(picture.error[k]), 2);
        whole += std::pow(static_cast<double>(picture.radiance[k]), 2);
    }
    return whole > 0 ? std::sqrt(squares / whole) : 0;
}

TransferPicture takePicture(const PictureScene& scene, const Camera& camera,
                            const NamedLight& light, const TransferOptions& options, KeptRows* kept,
                            const TimeLimit& limit, const Listener& listener, FileSet& files,
                            std::vector<PageReference>& references) {
    TransferPicture picture{.camera = camera.name, .light = light.name};
    const LightCoefficients coefficients = lightOf(light, options.order);
    if (!coefficients.curves.empty() && !coefficients.curves.front().points.empty())
        picture.captured = coefficients.curves.front().points.back().accuracy;
    std::vector<SurfaceObject> objects = scene.surfaces.objects;
    const SurfaceScene surfaces(scene.surfaces.materials, std::move(objects), light.lights);
    PathOptions paths = pathsOf(options);
    paths.samples = samplesWithin(surfaces, camera, paths, limit);
    if (paths.samples < options.referenceSamples)
        listener.say(fmt::format("{} under {}: {} of {} paths a pixel fit into the time",
                                 camera.name, light.name, paths.samples, options.referenceSamples));
    paths.progress = listener.part(camera.name);
    const PathPicture path = tracePaths(surfaces, camera, paths, kept ? kept->rows() : PathRows{});
    picture.noise = relativeNoise(path);
    std::vector<float> found;
    for (int bands = 1; bands <= options.order; ++bands) {
        found = pictureOf(scene, camera, coefficients, bands);
        TransferPictureError error = errorOf(path.radiance, found, camera.width);
        error.order = bands;
        picture.errors.push_back(error);
    }
    const RgbPicture reference{camera.width, camera.height, path.radiance};
    const RgbPicture own{camera.width, camera.height, std::move(found)};
    const double stops = automaticExposure(reference);
    const std::string stem = camera.name + "_" + light.file;
    requirePossible({.name = (files.folder() / (stem + "_path.png")).string(),
                     .width = camera.width,
                     .radiance = reference.values,
                     .error = path.error,
                     .samples = paths.samples},
                    surfaces, light.lights);
    // Coefficients of light are beyond its radiance at places.
    requirePossible({.name = (files.folder() / (stem + "_transfer.png")).string(),
                     .width = camera.width,
                     .radiance = own.values,
                     .samples = 1},
                    surfaces, light.lights);
    files.write(stem + "_transfer.png", rgbPng(own, stops));
    const std::string png = rgbPng(reference, stops);
    files.write(stem + "_path.png", png);
    references.push_back(
        {camera.name, light.name,
         fmt::format("{} paths a pixel, noise {}; transfer differs by {}, at most by {} of "
                     "the mean.",
                     paths.samples, percent(picture.noise, 2),
                     percent(picture.errors.back().relativeL2, 2),
                     percent(picture.errors.back().maximum, 2)),
         stops, png});
    for (const char* end : {"_transfer.png", "_path.png"})
        picture.files.push_back((files.folder() / (stem + end)).string());
    return picture;
}

}  // namespace

std::vector<NamedLight> namedLights(const scene::Scene& read,
                                    const std::vector<std::string>& specifications) {
    std::vector<NamedLight> named;
    if (!read.lights.empty()) named.push_back({"scene", "scene", read.lights});
    for (const std::string& text : specifications) {
        std::string file = fmt::format("light{}_", named.size() + 1);
        for (const char c : text.substr(0, text.find_first_of(":+")))
            if (std::isalnum(static_cast<unsigned char>(c))) file += c;
        named.push_back({text, file, parseLights(text).lights});
    }
    return named;
}

LightCoefficients lightOf(const NamedLight& light, int order) {
    return projectLight(light.lights, *bases::make("sh", order));
}

ReferencePictures takePictures(const PictureScene& scene, const scene::Scene& read,
                               const std::vector<const Camera*>& cameras,
                               const std::vector<NamedLight>& lights, const TimeLimit& limit,
                               const Listener& listener, FileSet& files, Transferred& done) {
    ReferencePictures result;
    for (const NamedLight& light : lights) {
        scene::Scene lit = read;
        lit.lights = light.lights;
        for (const Camera* camera : cameras) {
            KeptRows* rows = nullptr;
            if (done.options.resume) {
                const auto place =
                    files.folder() / fmt::format(".hshfit-{}_{}.partial", camera->name, light.file);
                rows = result.kept
                           .emplace_back(std::make_unique<KeptRows>(place.string(),
                                                                    inputsKey(lit, scene.surfaces),
                                                                    *camera, pathsOf(done.options)))
                           .get();
            }
            const std::size_t left = lights.size() * cameras.size() - done.pictures.size();
            done.pictures.push_back(takePicture(scene, *camera, light, done.options, rows,
                                                limit.share(static_cast<double>(left)), listener,
                                                files, result.references));
        }
    }
    return result;
}

}  // namespace hshfit::jobs
