#include <hshfit/pictures/picture_strips.h>

#include <hshfit/pictures/internal/picture_lights.h>
#include <hshfit/pictures/sphere_picture.h>

#include <algorithm>
#include <cmath>
#include <string_view>

namespace hshfit::inline pictures {
namespace {

constexpr std::array<std::string_view, 2> stripLights{"lamp at 30 degrees", "room"};
constexpr int stripPixels = 160, stripSamples = 1;

const SphereRig& rigOf(std::string_view name) {
    return std::ranges::find(pictureLights(), name, &PictureLight::name)->rig;
}

}  // namespace

std::vector<SpherePicture> stripSpheres(const Brdf& brdf) {
    const AlbedoTable albedo(brdf, AlbedoTable::Detail::coarse);
    std::vector<SpherePicture> spheres;
    for (const std::string_view light : stripLights) {
        const SphereOptions how{.rig = rigOf(light), .size = stripPixels, .samples = stripSamples};
        spheres.push_back(renderSphere(brdf, albedo, how));
    }
    return spheres;
}

std::vector<PictureStrip> pictureStrips(std::span<const SpherePicture> source,
                                        std::span<const SpherePicture> other) {
    std::vector<PictureStrip> strips;
    for (std::size_t k = 0; k < source.size(); ++k) {
        PictureStrip strip{.light = std::string(stripLights[k]),
                           .stops = automaticExposure(source.subspan(k, 1)),
                           .spheres = {source[k], other[k], {}}};
        const SpherePicture difference = sphereDifference(source[k], other[k]);
        strip.times = amplificationFor(difference, strip.stops);
        strip.spheres[2] = amplified(difference, strip.times);
        strips.push_back(std::move(strip));
    }
    return strips;
}

std::string pngOf(const PictureStrip& strip) {
    return spheresPng(strip.spheres, strip.stops);
}

std::string pngOf(std::span<const PictureStrip> strips) {
    std::vector<std::array<SpherePicture, 3>> exposed;
    for (const PictureStrip& strip : strips) {
        exposed.push_back(strip.spheres);
        const auto factor = static_cast<float>(std::exp2(strip.stops));
        for (SpherePicture& sphere : exposed.back())
            for (float& value : sphere.radiance) value *= factor;
    }
    Sheet sheet(exposed.begin(), exposed.end());
    return sheetPng(sheet, 0);
}

}  // namespace hshfit::inline pictures
