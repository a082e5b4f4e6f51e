#include <jobs/source/source.h>
#include "transfer_pictures.h"

#include <hshfit/error.h>
#include <hshfit/gpu/viewer_light.h>
#include <hshfit/light/catalog.h>
#include <hshfit/percent.h>

#include <fmt/format.h>

#include <cmath>

namespace hshfit::jobs {
namespace {

/// The exposure at which the mean radiance of a light is half of white.
double stopsOf(const LightCoefficients& light) {
    double mean = 0;
    for (std::size_t c = 0; c < light.channels.count(); ++c)
        mean += light.at(c)[0] / static_cast<double>(light.channels.count());
    mean /= std::sqrt(4 * pi);
    return mean > 0 ? std::round(10 * std::log2(0.5 / mean)) / 10 : 0;
}

PageLight pageLight(const NamedLight& light, int order) {
    PageLight page{.name = light.name, .coefficients = lightOf(light, order)};
    page.stops = stopsOf(page.coefficients);
    return page;
}

/// Sun and clear sky of a place at midsummer, every hour that the sun is up. In thousands of lux
/// and of cd / m^2: the sun's illuminance is 127.5 exp(-0.21 / sin(elevation)), as the Illuminating
/// Engineering Society gives it for a clear sky.
PageLight dayLight(int order) {
    PageLight day{.name = "a day: 21 June at 50 degrees north"};
    for (int hour = 0; hour < 24; ++hour) {
        const std::string place =
            fmt::format("latitude=50,longitude=15,date=2024-06-21,time={:02d}:00,zone=1", hour);
        NamedLight light{.name = fmt::format("{:02d}:00", hour), .file = {}, .lights = {}};
        try {
            light.lights = parseLights("preetham:turbidity=3," + place).lights;
        } catch (const UsageError&) {
            continue;  // The sun is down.
        }
        const double height = std::get<SkyLight>(light.lights.front()).sun.z;
        const double illuminance = 127.5 * std::exp(-0.21 / std::max(height, 1e-3));
        for (const Light& sun : parseLights(fmt::format("sun:{},irradiance={:.17g}", place,
                                                        std::max(illuminance, 1e-9)))
                                    .lights)
            light.lights.push_back(sun);
        day.times.push_back(pageLight(light, order));
    }
    day.stops = day.times[day.times.size() / 2].stops;
    return day;
}

}  // namespace

std::string pageOf(const PictureScene& scene, const std::vector<PageKind>& kinds,
                   const MatrixClusters* clusters, const std::vector<NamedLight>& lights,
                   const std::vector<const Camera*>& cameras, std::vector<PageReference> references,
                   const Transferred& done, const Listener& listener) {
    TransferPageInput input{.title = gpu::shownName(done.scene),
                            .summary = {},
                            .mesh = scene.mesh,
                            .order = done.options.order,
                            .localOrder = clusters ? done.options.localOrder : 0,
                            .channels = scene.transfer.channels,
                            .kinds = kinds,
                            .materials = scene.materials,
                            .sceneMaterials = scene.materials.size(),
                            .clusters = clusters,
                            .references = std::move(references)};
    for (const std::string& spec : done.options.swaps)
        input.materials.push_back(
            transferMaterial(spec, *openSource(spec, true), input.localOrder));
    const ProgressCall progress = listener.part("lights");
    const std::vector<std::string> examples = lightExamples();
    const std::size_t number = lights.size() + examples.size() + 1;
    for (const NamedLight& light : lights) {
        input.lights.push_back(pageLight(light, input.order));
        input.lights.back().name = gpu::shownName(light.name);
        if (progress) progress(input.lights.size(), number);
    }
    for (PageReference& reference : input.references)
        reference.light = gpu::shownName(reference.light);
    for (const std::string& spec : examples) {
        input.lights.push_back(pageLight({spec, {}, parseLights(spec).lights}, input.order));
        if (progress) progress(input.lights.size(), number);
    }
    input.lights.push_back(dayLight(input.order));
    for (const Camera* camera : cameras) input.cameras.push_back(*camera);
    input.summary = fmt::format("{} vertices, light in {} bands, {} rays a vertex{}", done.vertices,
                                input.order, done.options.rays,
                                clusters ? fmt::format(", {} clusters of {} components",
                                                       clusters->clusters, clusters->components)
                                         : std::string());
    input.notes.push_back(fmt::format("Noise of the rays: {} of the vectors, at most {}.",
                                      percent(done.noise, 2), percent(done.largestNoise, 2)));
    return transferPage(input);
}

}  // namespace hshfit::jobs
