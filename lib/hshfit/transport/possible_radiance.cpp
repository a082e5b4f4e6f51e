#include <hshfit/transport/possible_radiance.h>

#include <hshfit/error.h>
#include <hshfit/light/light_samples.h>
#include <hshfit/pictures/rgb_picture.h>
#include <hshfit/pictures/sphere_albedo.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace hshfit::inline transport {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr int enoughSamples = 16;
constexpr double standardErrors = 6, unlikely = 1000;
constexpr double quadrature = 1.02;  // more than the error of integrals

double largestOf(const Rgb& rgb) {
    return *std::ranges::max_element(rgb);
}

/// The greatest radiance of a light without sharp features but at `sun`.
double brightestOnGrid(const Light& light, const Direction& sun) {
    double brightest = largestOf(radianceFrom({&light, 1}, sun));
    for (int theta = 0; theta <= 180; ++theta) {
        for (int phi = 0; phi < 360; ++phi) {
            const Direction world = directionFromAngles(radians(theta), radians(phi));
            brightest = std::max(brightest, largestOf(radianceFrom({&light, 1}, world)));
        }
    }
    return 1.05 * brightest;
}

double brightestOf(const Light& light) {
    if (const auto* disc = std::get_if<DiscLight>(&light)) return largestOf(disc->radiance);
    if (const auto* panel = std::get_if<PanelLight>(&light)) return largestOf(panel->radiance);
    if (const auto* sky = std::get_if<SkyLight>(&light)) return brightestOnGrid(light, sky->sun);
    if (const auto* picture = std::get_if<PictureLight>(&light)) {
        float brightest = 0;
        for (const float value : picture->rgb) brightest = std::max(brightest, value);
        return static_cast<double>(brightest);
    }
    if (std::holds_alternative<CoefficientLight>(light)) return brightestOnGrid(light, {0, 0, 1});
    return infinite;
}

/// The bound of a picture, and the words for it.
struct Bound {
    double most = infinite;
    std::string because = {};
};

[[noreturn]] void refuse(const CheckedPicture& picture, std::size_t at, const std::string& why) {
    const auto width = static_cast<std::size_t>(picture.width);
    throw NumericError(fmt::format("{}: the radiance {:g} of the pixel in column {}, row {} {}",
                                   picture.name, picture.radiance[at], at / 3 % width,
                                   at / 3 / width, why));
}

/// `bound` is asked for only where a value is above `brightest`.
void require(const CheckedPicture& picture, double brightest, const std::function<Bound()>& bound) {
    const std::span<const float> values = picture.radiance;
    const auto magnitude = [&](std::size_t k) { return std::abs(static_cast<double>(values[k])); };
    requireFinite(picture.name, static_cast<std::size_t>(picture.width), values);
    double sum = 0;
    std::size_t largest = 0;
    for (std::size_t k = 0; k < values.size(); ++k) {
        sum += magnitude(k);
        if (magnitude(k) > magnitude(largest)) largest = k;
    }
    if (values.empty() || !(magnitude(largest) > brightest)) return;
    const Bound found = bound();
    if (sum / static_cast<double>(values.size()) > unlikely * found.most)
        refuse(picture, largest, found.because);
    if (picture.samples > 0 && picture.samples < enoughSamples) return;
    for (std::size_t k = 0; k < values.size(); ++k) {
        const double error = picture.error.empty() ? 0 : static_cast<double>(picture.error[k]);
        if (magnitude(k) - standardErrors * error > quadrature * found.most)
            refuse(picture, k, found.because);
    }
}

Bound boundOf(double brightest, double albedo, bool once) {
    const double most = once         ? std::max(albedo, 1.0) * brightest
                        : albedo < 1 ? brightest / (1 - albedo)
                                     : infinite;
    return {most, fmt::format("is beyond {:.4g}, the most that a light of radiance {:.4g} makes "
                              "on surfaces that reflect up to {:.4g} of it{}",
                              most, brightest, albedo, once ? " once" : "")};
}

}  // namespace

std::optional<double> brightestOf(std::span<const Light> lights) {
    double sum = 0;
    for (const Light& light : lights) sum += brightestOf(light);
    return std::isfinite(sum) ? std::optional(sum) : std::nullopt;
}

double largestAlbedo(const Brdf& brdf) {
    const AlbedoTable table(brdf);
    return table.largest() + 2 * table.error();
}

void requirePossible(const CheckedPicture& picture, const SurfaceScene& scene,
                     std::span<const Light> lights) {
    double brightest = brightestOf(lights).value_or(infinite);
    for (const SurfaceObject& object : scene.objects())
        brightest = std::max(brightest, largestOf(object.emission));
    require(picture, brightest, [&] {
        double albedo = 0;
        for (const SurfaceObject& object : scene.objects())
            albedo = std::max(albedo, largestAlbedo(*scene.materials()[object.material].brdf));
        return boundOf(brightest, albedo, false);
    });
}

void requirePossible(const CheckedPicture& picture, const Brdf& brdf,
                     std::span<const Light> lights) {
    const double brightest = brightestOf(lights).value_or(infinite);
    require(picture, brightest, [&] { return boundOf(brightest, largestAlbedo(brdf), true); });
}

}  // namespace hshfit::inline transport
