#include <hshfit/transport/scattering.h>

#include <hshfit/brdf/vectors.h>

namespace hshfit::inline transport {
namespace {

Direction mirrored(const SurfaceHit& hit, const Direction& world) {
    return world - 2 * dot(world, hit.flat) * hit.flat;
}

/// The sum of `value` over the directions of the hit's frame for which `world` stands.
template <typename Add>
void overImages(const SurfaceHit& hit, const Direction& world, const Add& add) {
    if (!(dot(world, hit.flat) > 0)) return;
    const Direction itself = normalised(hit.frame.toLocal(world));
    if (itself.z > 0) add(itself);
    const Direction image = normalised(hit.frame.toLocal(mirrored(hit, world)));
    if (image.z > 0) add(image);
}

}  // namespace

Direction aboveTriangle(const SurfaceHit& hit, const Direction& world) {
    return dot(world, hit.flat) < 0 ? mirrored(hit, world) : world;
}

Rgb reflectedShare(const SurfaceScene& scene, const SurfaceHit& hit, const Direction& world) {
    Rgb sum{};
    overImages(hit, world, [&](const Direction& wi) {
        const Rgb f = scene.reflectance(hit, wi);
        for (std::size_t c = 0; c < 3; ++c) sum[c] += f[c] * wi.z;
    });
    return sum;
}

double scatteringPdf(const SurfaceScene& scene, const SurfaceHit& hit, const Direction& world) {
    const Sampler& sampler = *scene.material(hit).sampler;
    double sum = 0;
    overImages(hit, world, [&](const Direction& wi) { sum += sampler.pdf(hit.wo, wi); });
    return sum;
}

std::optional<Scattered> scatter(const SurfaceScene& scene, const SurfaceHit& hit,
                                 const std::array<double, 3>& u) {
    const Sample sample = scene.material(hit).sampler->sample(hit.wo, u);
    if (!(sample.pdf > 0)) return {};
    Scattered found{.world = aboveTriangle(hit, normalised(hit.frame.toWorld(sample.wi)))};
    found.weight = reflectedShare(scene, hit, found.world);
    if (found.weight == Rgb{}) return {};
    found.pdf = scatteringPdf(scene, hit, found.world);
    for (double& value : found.weight) value /= found.pdf;
    return found;
}

}  // namespace hshfit::inline transport
