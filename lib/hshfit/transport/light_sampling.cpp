#include <hshfit/transport/light_sampling.h>

#include <hshfit/brdf/vectors.h>
#include <hshfit/transport/scattering.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline transport {
namespace {

/// The power heuristic with exponent 2.
double shareOf(double mine, double other) {
    return mine * mine / (mine * mine + other * other);
}

Rgb scaled(const Rgb& f, const Rgb& radiance, double factor) {
    return {f[0] * radiance[0] * factor, f[1] * radiance[1] * factor, f[2] * radiance[2] * factor};
}

}  // namespace

LightSampling::LightSampling(const SurfaceScene& scene)
    : scene_(scene),
      emitterShare_(!scene.hasEmitters() ? 0 : (scene.environment().any() ? 0.5 : 1)) {}

Rgb LightSampling::reflected(const SurfaceHit& hit, const std::array<double, 4>& u, Weight weight,
                             std::size_t& rays) const {
    const std::array<double, 3> place{u[0], u[1], u[2]};
    if (u[3] < emitterShare_) return ofEmitter(hit, scene_.sampleEmitters(place), weight, rays);
    return ofEnvironment(hit, scene_.environment().sample(place), weight, rays);
}

double LightSampling::emitterWeight(const SurfaceHit& met, double pdf) const {
    const double cosine = dot(met.flat, met.frame.toWorld(met.wo));
    const double light = emitterShare_ * scene_.emitterPdf(met) * met.distance * met.distance /
                         std::max(cosine, 1e-300);
    return shareOf(pdf, light);
}

double LightSampling::environmentWeight(const Direction& world, double pdf) const {
    return shareOf(pdf, (1 - emitterShare_) * scene_.environment().pdf(world));
}

Rgb LightSampling::ofEnvironment(const SurfaceHit& hit, const EnvironmentSample& light,
                                 Weight weight, std::size_t& rays) const {
    if (!(light.pdf > 0)) return {};
    const Rgb f = reflectedShare(scene_, hit, light.world);
    if (f == Rgb{}) return {};
    ++rays;
    if (!scene_.visible(hit, light.world)) return {};
    const double pdf = (1 - emitterShare_) * light.pdf;
    const bool alone = light.delta || weight == Weight::whole;
    const double share = alone ? 1 : shareOf(pdf, scatteringPdf(scene_, hit, light.world));
    return scaled(f, light.radiance, share / pdf);
}

Rgb LightSampling::ofEmitter(const SurfaceHit& hit, const EmitterSample& light, Weight weight,
                             std::size_t& rays) const {
    const Direction gap{light.position[0] - hit.position[0], light.position[1] - hit.position[1],
                        light.position[2] - hit.position[2]};
    const double squared = dot(gap, gap);
    if (!(squared > 0)) return {};
    const Direction world = normalised(gap);
    const double cosine = -dot(world, light.normal);
    if (!(cosine > 0)) return {};
    const Rgb f = reflectedShare(scene_, hit, world);
    if (f == Rgb{}) return {};
    ++rays;
    if (!scene_.visible(hit, world, light)) return {};
    const double pdf = emitterShare_ * light.pdf * squared / cosine;
    const double share =
        weight == Weight::whole ? 1 : shareOf(pdf, scatteringPdf(scene_, hit, world));
    return scaled(f, light.radiance, share / pdf);
}

}  // namespace hshfit::inline transport
