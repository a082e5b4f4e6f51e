#include <hshfit/transport/radiance_cache/light_walk.h>

#include <hshfit/brdf/vectors.h>
#include <hshfit/transport/scattering.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hshfit::inline transport::inline radiance_cache {
namespace {

constexpr int sureBounces = 4;

void add(Rgb& sum, const Rgb& weight, const Rgb& radiance, double factor) {
    for (std::size_t c = 0; c < 3; ++c) sum[c] += weight[c] * radiance[c] * factor;
}

/// f where it is the same, to rounding, for directions all over both hemispheres.
std::optional<Rgb> constantOf(const Brdf& brdf) {
    RandomNumbers random(1, 0);
    Rgb first{};
    for (int pair = 0; pair < 256; ++pair) {
        const double a = std::sqrt(random.next()), b = 2 * pi * random.next();
        const double c = std::sqrt(random.next()), d = 2 * pi * random.next();
        const Direction wi{a * std::cos(b), a * std::sin(b), std::sqrt(1 - a * a)};
        const Direction wo{c * std::cos(d), c * std::sin(d), std::sqrt(1 - c * c)};
        Rgb f{};
        brdf.eval(wo, {&wi.x, &wi.y, &wi.z, 1}, f.data());
        if (brdf.channels().count() == 1) f[2] = f[1] = f[0];
        if (pair == 0) first = f;
        for (std::size_t k = 0; k < 3; ++k)
            if (!(std::abs(f[k] - first[k]) <= 1e-12 * std::abs(first[k]))) return {};
    }
    return first;
}

}  // namespace

DiffuseMaterials::DiffuseMaterials(const SurfaceScene& scene) {
    for (const SurfaceMaterial& material : scene.materials())
        f_.push_back(constantOf(*material.brdf));
}

LightWalk::LightWalk(const SurfaceScene& scene, DirectLight direct)
    : scene_(scene), lights_(scene), diffuse_(scene), direct_(direct) {}

struct LightWalk::Going {
    SurfaceHit hit;
    RandomNumbers& random;
    std::size_t& rays;
    Rgb weight{1, 1, 1};
    int bounce = 0;
    std::array<double, 3> three() const {
        const double a = random.next(), b = random.next();
        return {a, b, random.next()};
    }
};

/// Adds the light sampled at a hit and, where it is known, all further light, which ends the walk.
/// Light samples alone are a poor way to meet a large lamp that is near: a walk that should have
/// gone on takes one more direction for it.
bool LightWalk::ends(Going& going, const KnownLight& known, Walk& walk) const {
    const std::size_t material = scene_.objects()[going.hit.object].material;
    const std::optional<Rgb>& f = diffuse_.at(material);
    std::optional<Rgb> light = f ? known(going.hit, false) : std::nullopt;
    const bool whole = light.has_value();
    if (f && !whole && going.bounce >= sureBounces) light = known(going.hit, true);
    if (light) {
        for (std::size_t c = 0; c < 3; ++c) walk.endWeight[c] = going.weight[c] * (*f)[c];
        add(walk.radiance, walk.endWeight, *light, 1);
    }
    if (direct_ == DirectLight::sampled && lights_.any()) {
        const auto u = going.three();
        const double choice = going.random.next();
        const auto weight = whole ? LightSampling::Weight::whole : LightSampling::Weight::heuristic;
        add(walk.radiance, going.weight,
            lights_.reflected(going.hit, {u[0], u[1], u[2], choice}, weight, going.rays), 1);
        if (light && !whole) step(going, true, walk);
    }
    return light.has_value();
}

/// Whether the walk has come to a further surface.
bool LightWalk::step(Going& going, bool direct, Walk& walk) const {
    const auto next = scatter(scene_, going.hit, going.three());
    if (!next) return false;
    for (std::size_t c = 0; c < 3; ++c) going.weight[c] *= next->weight[c];
    if (going.bounce++ >= sureBounces) {
        const double survival =
            std::min(0.95, std::max({going.weight[0], going.weight[1], going.weight[2]}));
        if (!(going.random.next() < survival)) return false;
        for (double& value : going.weight) value /= survival;
    }
    ++going.rays;
    const auto hit = scene_.firstHit(going.hit, next->world);
    if (going.bounce == 1)
        walk.firstLength = hit ? hit->distance : std::numeric_limits<double>::infinity();
    const bool gathered = direct_ == DirectLight::gathered;
    if (!hit) {
        if (direct && scene_.environment().any()) {
            add(walk.radiance, going.weight, scene_.environment().radiance(next->world),
                gathered ? 1 : lights_.environmentWeight(next->world, next->pdf));
        }
        return false;
    }
    if (direct && hit->emission != Rgb{}) {
        add(walk.radiance, going.weight, hit->emission,
            gathered ? 1 : lights_.emitterWeight(*hit, next->pdf));
    }
    going.hit = *hit;
    return true;
}

Walk LightWalk::from(const SurfaceHit& start, const KnownLight& known, RandomNumbers& random,
                     std::size_t& rays) const {
    Walk walk;
    Going going{start, random, rays};
    std::optional<Rgb> smooth;
    for (bool more = true; more && !ends(going, known, walk);) {
        const std::optional<Rgb>& f = diffuse_.at(scene_.objects()[going.hit.object].material);
        if (!f || smooth) {
            more = step(going, true, walk);
            continue;
        }
        Rgb weight = going.weight;
        for (std::size_t c = 0; c < 3; ++c) weight[c] *= (*f)[c];
        const Rgb light = known(going.hit, true).value_or(Rgb{});
        smooth = walk.radiance;
        more = step(going, true, walk);
        // Gathered light is among what the points know.
        if (direct_ == DirectLight::sampled) smooth = walk.radiance;
        add(*smooth, weight, light, 1);
    }
    walk.smooth = smooth.value_or(walk.radiance);
    return walk;
}

Rgb LightWalk::direct(const SurfaceHit& hit, RandomNumbers& random, std::size_t& rays) const {
    Walk walk;
    if (!lights_.any()) return {};
    Going going{hit, random, rays};
    const auto u = going.three();
    const double choice = random.next();
    walk.radiance =
        lights_.reflected(hit, {u[0], u[1], u[2], choice}, LightSampling::Weight::heuristic, rays);
    step(going, true, walk);
    return walk.radiance;
}

Walk LightWalk::sampled(const SurfaceHit& start, const KnownLight& known, bool direct,
                        RandomNumbers& random, std::size_t& rays) const {
    Walk walk;
    Going going{start, random, rays};
    while (step(going, direct || going.bounce > 0, walk) && !ends(going, known, walk)) {
    }
    return walk;
}

}  // namespace hshfit::inline transport::inline radiance_cache
