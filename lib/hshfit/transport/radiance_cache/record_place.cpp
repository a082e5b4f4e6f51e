#include <hshfit/transport/radiance_cache/internal/record_place.h>

#include <hshfit/brdf/vectors.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline transport::inline radiance_cache {
namespace {

constexpr int directions = 8;

Point moved(const Point& from, const Direction& by) {
    return {from[0] + by.x, from[1] + by.y, from[2] + by.z};
}
Direction between(const Point& from, const Point& to) {
    return {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
}

}  // namespace

std::optional<SurfaceHit> placeOfRecord(const SurfaceScene& scene, const SurfaceHit& hit,
                                        double radius) {
    // On the line of sight nothing stands in the way.
    const Direction back = hit.frame.toWorld(hit.wo);
    const Point eye = moved(hit.position, std::min(radius, hit.distance / 2) * back);
    const auto seenAt = [&](const Direction& offset) -> std::optional<SurfaceHit> {
        const Point wanted = moved(hit.position, offset);
        const Direction gap = between(eye, wanted);
        const auto met = scene.firstHit(eye, normalised(gap));
        if (!met || dot(met->frame.normal, hit.frame.normal) < 0.9) return {};
        if (scene.objects()[met->object].material != scene.objects()[hit.object].material)
            return {};
        const Direction off = between(wanted, met->position);
        if (dot(off, off) > radius * radius / 16) return {};
        return met;
    };
    Direction sum{0, 0, 0};
    int seen = 0;
    for (int k = 0; k < directions; ++k) {
        const double phi = 2 * pi * k / directions;
        Direction offset = hit.frame.toWorld({std::cos(phi), std::sin(phi), 0});
        offset = radius * normalised(offset - dot(offset, hit.flat) * hit.flat);
        if (!seenAt(offset)) continue;
        ++seen;
        sum = sum + offset;
    }
    if (seen == directions) return hit;
    if (seen == 0) return {};
    return seenAt((1.0 / seen) * sum);
}

}  // namespace hshfit::inline transport::inline radiance_cache
