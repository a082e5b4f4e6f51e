#include <hshfit/transport/radiance_cache/record.h>

#include <hshfit/brdf/vectors.h>
#include <hshfit/transport/scattering.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hshfit::inline transport::inline radiance_cache {
namespace {

constexpr auto none = static_cast<std::size_t>(-1);

/// The rays of a record, cell by cell.
struct Rays {
    std::vector<double> x, y, z;  ///< directions in the frame
    std::vector<Rgb> radiance;    ///< as found
    std::vector<Rgb> smooth;      ///< for differences (Walk)
    std::vector<float> inverse;   ///< one over the distance, 0 where a ray is lost
    /// One over the distance to what is seen in a surface that is not diffuse, whose number is in
    /// `glossy`.
    std::vector<float> inverseBeyond;
    std::vector<std::size_t> glossy;
    std::size_t stuck = 0;           ///< rays that end where they start, to rounding
    std::vector<Direction> normals;  ///< of what was met, in the frame
    DirectionBatch directions() const { return {x.data(), y.data(), z.data(), x.size()}; }
};

Rays traced(const SurfaceHit& hit, const HemisphereStrata& strata, const GatherScene& scene,
            RandomNumbers& random, std::size_t& rays) {
    const SurfaceScene& surfaces = scene.walk->scene();
    const bool gathered = scene.walk->directLight() == DirectLight::gathered;
    const double rounding = surfaces.rounding();
    const KnownLight known = [&](const SurfaceHit& end, bool last) {
        return scene.surfaces->at(end, last);
    };
    Rays found;
    for (std::size_t cell = 0; cell < strata.cells(); ++cell) {
        const double u = random.next(), v = random.next();
        const Direction local = strata.direction(cell, u, v);
        found.x.push_back(local.x), found.y.push_back(local.y), found.z.push_back(local.z);
        Rgb& radiance = found.radiance.emplace_back();
        Rgb& smooth = found.smooth.emplace_back();
        found.inverse.push_back(0);
        found.inverseBeyond.push_back(0);
        found.glossy.push_back(none);
        found.normals.push_back({0, 0, 1});
        const Direction world = aboveTriangle(hit, hit.frame.toWorld(local));
        ++rays;
        const auto met = surfaces.firstHit(hit, world);
        if (!met) {
            if (gathered && surfaces.environment().any())
                radiance = smooth = surfaces.environment().radiance(world);
            continue;
        }
        if (met->distance < rounding) ++found.stuck;
        found.inverse.back() =
            static_cast<float>(1 / std::max({met->distance, scene.nearest, rounding}));
        found.normals.back() = hit.frame.toLocal(met->flat);
        if (gathered) radiance = smooth = met->emission;
        const Walk walk = scene.walk->from(*met, known, random, rays);
        for (std::size_t c = 0; c < 3; ++c) {
            radiance[c] += walk.radiance[c];
            smooth[c] += walk.smooth[c];
        }
        if (scene.walk->diffuse().at(surfaces.objects()[met->object].material)) continue;
        found.glossy.back() = met->object;
        found.inverseBeyond.back() = static_cast<float>(
            1 / std::max({met->distance + walk.firstLength, scene.nearest, rounding}));
    }
    return found;
}

void addTo(std::span<float> part, const std::array<float, 3>& factors, const float* functions,
           std::size_t size) {
    for (std::size_t c = 0; c < 3; ++c) {
        float* to = part.data() + c * size;
        const float factor = factors[c];
        for (std::size_t i = 0; i < size; ++i) to[i] += factor * functions[i];
    }
}

std::array<float, 3> times(const Rgb& radiance, double factor) {
    return {static_cast<float>(radiance[0] * factor), static_cast<float>(radiance[1] * factor),
            static_cast<float>(radiance[2] * factor)};
}
Rgb minus(const Rgb& a, const Rgb& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

void addCoefficients(const Rays& rays, const Rgb& mean, const IncomingFunctions& functions,
                     const HemisphereStrata& strata, Record& record) {
    const std::size_t size = functions.size();
    std::vector<float> values(strata.cells() * size);
    functions.tabulate(rays.directions(), values.data());
    const std::span<float> part = record.part(0, size);
    for (std::size_t cell = 0; cell < strata.cells(); ++cell) {
        const double density = strata.cosine() ? std::max(rays.z[cell], 1e-9) : 1;
        addTo(part, times(minus(rays.radiance[cell], mean), strata.measure() / density),
              values.data() + cell * size, size);
    }
    addTo(part, times(mean, 1), strata.ofOne().data(), size);
}

/// Calls visit(cell, ring, step, inverse) for each edge between a cell and the one before, in the
/// ring before if `ring`: the step of radiance and one over the nearer of the two distances.
template <class Visit>
void forEachEdge(const Rays& rays, const HemisphereStrata& strata, const Visit& visit) {
    const std::size_t azimuths = strata.azimuths();
    const auto edge = [&](std::size_t cell, std::size_t other, bool ring) {
        // Reflections in one surface move as what they show, not as the surface does.
        const bool reflected = rays.glossy[cell] != none && rays.glossy[cell] == rays.glossy[other];
        const std::vector<float>& inverses = reflected ? rays.inverseBeyond : rays.inverse;
        const double inverse = std::max(inverses[cell], inverses[other]);
        if (inverse == 0) return;
        visit(cell, ring, minus(rays.smooth[cell], rays.smooth[other]), inverse);
    };
    for (std::size_t cell = 0; cell < strata.cells(); ++cell) {
        if (cell >= azimuths) edge(cell, cell - azimuths, true);
        edge(cell, cell % azimuths > 0 ? cell - 1 : cell + azimuths - 1, false);
    }
}

void addStrataGradient(const Rays& rays, const HemisphereStrata& strata, std::size_t size,
                       Record& record) {
    const auto visit = [&](std::size_t cell, bool ring, const Rgb& step, double inverse) {
        const std::size_t k = cell % strata.azimuths();
        const double phi = ring ? strata.azimuthAt(k, 0.5) : strata.azimuthAt(k, 0) + pi / 2;
        const float* edge = ring ? strata.ringEdge(cell) : strata.azimuthEdge(cell);
        addTo(record.part(1, size), times(step, inverse * std::cos(phi)), edge, size);
        addTo(record.part(2, size), times(step, inverse * std::sin(phi)), edge, size);
    };
    forEachEdge(rays, strata, visit);
}

void addBends(const Rays& rays, const HemisphereStrata& strata, std::vector<float>& bends) {
    const auto visit = [&](std::size_t cell, bool ring, const Rgb& step, double inverse) {
        const float* bend = ring ? strata.ringBend(cell) : strata.azimuthBend(cell);
        const auto factor = static_cast<float>((step[0] + step[1] + step[2]) * inverse * inverse);
        for (std::size_t n = 0; n < bends.size(); ++n) bends[n] += factor * bend[n];
    };
    forEachEdge(rays, strata, visit);
}

/// Each ray's direction and solid angle from places beside the record, a hundredth of its length
/// to both sides, in place of derivatives of the functions.
void addHitPointGradient(const Rays& rays, const IncomingFunctions& functions,
                         const HemisphereStrata& strata, Record& record) {
    constexpr double h = 0.01;
    const std::size_t size = functions.size();
    std::vector<double> x, y, z;
    std::vector<double> factors;
    std::vector<std::size_t> cells;
    for (std::size_t cell = 0; cell < strata.cells(); ++cell) {
        if (rays.inverse[cell] == 0) continue;
        const Direction d{rays.x[cell], rays.y[cell], rays.z[cell]};
        const double facing = -dot(d, rays.normals[cell]);
        const double density = strata.cosine() ? std::max(d.z, 1e-9) : 1;
        if (!(facing > 1e-3)) continue;
        cells.push_back(cell);
        for (int side = 0; side < 4; ++side) {
            const double step = side % 2 == 0 ? h : -h;
            Direction moved = d;
            (side < 2 ? moved.x : moved.y) -= step;
            const double square = dot(moved, moved);
            const double turned = -dot(moved, rays.normals[cell]) / std::sqrt(square);
            moved = normalised(moved);
            x.push_back(moved.x), y.push_back(moved.y), z.push_back(std::max(moved.z, 0.0));
            factors.push_back(std::max(turned, 0.0) / (facing * square) * strata.measure() /
                              density / (2 * step) * static_cast<double>(rays.inverse[cell]));
        }
    }
    std::vector<float> values(x.size() * size);
    functions.tabulate({x.data(), y.data(), z.data(), x.size()}, values.data());
    for (std::size_t k = 0; k < x.size(); ++k) {
        addTo(record.part(k % 4 < 2 ? 1 : 2, size), times(rays.radiance[cells[k / 4]], factors[k]),
              values.data() + k * size, size);
    }
}

/// The derivatives of irradiance as the normal turns about the tangent and about the bitangent
/// (Ward & Heckbert 1992).
void addTurns(const Rays& rays, const Rgb& mean, const HemisphereStrata& strata, Record& record) {
    for (std::size_t cell = 0; cell < strata.cells(); ++cell) {
        const double factor = strata.measure() / std::max(rays.z[cell], 1e-9);
        const Rgb radiance = minus(rays.radiance[cell], mean);
        const float one = 1;
        // d cos(theta) = d . (axis x n): axis x gives -y, axis y gives x.
        addTo(record.part(3, 1), times(radiance, -factor * rays.y[cell]), &one, 1);
        addTo(record.part(4, 1), times(radiance, factor * rays.x[cell]), &one, 1);
    }
}

}  // namespace

Gathered gather(const SurfaceHit& hit, std::uint32_t kind, const IncomingFunctions& functions,
                const HemisphereStrata& strata, Gradient gradient, const GatherScene& scene,
                RandomNumbers random, std::size_t& traces) {
    const Rays rays = traced(hit, strata, scene, random, traces);
    Gathered gathered{.record = {.position = hit.position, .frame = hit.frame, .kind = kind}};
    Record& record = gathered.record;
    record.values.resize(Record::valuesOf(functions));
    Rgb mean{};
    double inverse = 0;
    const auto count = static_cast<double>(strata.cells());
    for (std::size_t cell = 0; cell < strata.cells(); ++cell) {
        for (std::size_t c = 0; c < 3; ++c) mean[c] += rays.radiance[cell][c] / count;
        inverse += static_cast<double>(rays.inverse[cell]) / count;
    }
    record.distance = inverse > 0 ? 1 / inverse : std::numeric_limits<double>::infinity();
    const std::size_t size = functions.size();
    addCoefficients(rays, mean, functions, strata, record);
    if (gradient == Gradient::strata) addStrataGradient(rays, strata, size, record);
    if (strata.bends()) {
        gathered.bends.resize(3 * size);
        addBends(rays, strata, gathered.bends);
    }
    if (gradient == Gradient::hitPoints) addHitPointGradient(rays, functions, strata, record);
    if (!functions.basis() && gradient != Gradient::none) addTurns(rays, mean, strata, record);
    const auto finite = [](float value) { return std::isfinite(value); };
    gathered.sound = 10 * rays.stuck < strata.cells() &&
                     std::ranges::all_of(record.values, finite) &&
                     std::ranges::all_of(gathered.bends, finite);
    return gathered;
}

}  // namespace hshfit::inline transport::inline radiance_cache
