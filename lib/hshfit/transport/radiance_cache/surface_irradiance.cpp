#include <hshfit/transport/radiance_cache/surface_irradiance.h>

#include <hshfit/brdf/vectors.h>
#include <hshfit/transport/radiance_cache/hemisphere_strata.h>
#include <hshfit/transport/scattering.h>

#include <tbb/parallel_for.h>
#include <nanoflann.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>

namespace hshfit::inline transport::inline radiance_cache {
namespace {

/// A difference of normals by 1 counts as this many spacings.
constexpr double normalSpacings = 4;
constexpr std::size_t neighbours = 5;

double areaOf(const Mesh& mesh, std::size_t triangle) {
    const auto& t = mesh.triangles[triangle];
    const Direction a = directionOf(mesh.positions[t[0]]);
    const Direction n =
        cross(directionOf(mesh.positions[t[1]]) - a, directionOf(mesh.positions[t[2]]) - a);
    return std::sqrt(dot(n, n)) / 2;
}

/// Points of one side of an object, evenly by area: equal shares of it, which within a triangle
/// follow a lattice (Roberts 2018).
void addPoints(const SurfaceScene& scene, const std::vector<std::uint32_t>& triangles,
               std::size_t count, bool front, std::vector<SurfaceHit>& hits) {
    std::vector<double> until;
    double area = 0;
    for (const std::uint32_t t : triangles) until.push_back(area += areaOf(scene.mesh(), t));
    for (std::size_t i = 0; i < count; ++i) {
        const double wanted = (static_cast<double>(i) + 0.5) / static_cast<double>(count) * area;
        const auto found = std::upper_bound(until.begin(), until.end() - 1, wanted);
        const double n = static_cast<double>(i) + 0.5;
        const double x = std::fmod(n * 0.7548776662466927, 1);
        const double y = std::fmod(n * 0.5698402909980532, 1);
        const double root = std::sqrt(x);
        hits.push_back(scene.pointOf(triangles[static_cast<std::size_t>(found - until.begin())],
                                     root * (1 - y), root * y, front));
    }
}

struct Link {
    std::uint32_t point;
    std::array<float, 3> weight;
};

}  // namespace

struct SurfaceIrradiance::Tree {
    std::vector<std::array<float, 6>> places;
    float normalScale = 0;

    using Metric = nanoflann::L2_Simple_Adaptor<float, Tree>;
    using Search = nanoflann::KDTreeSingleIndexAdaptor<Metric, Tree, 6>;
    std::unique_ptr<Search> search;

    std::size_t kdtree_get_point_count() const { return places.size(); }
    float kdtree_get_pt(std::size_t k, std::size_t d) const { return places[k][d]; }
    template <class Box>
    bool kdtree_get_bbox(Box&) const {
        return false;
    }

    Tree(const std::vector<IrradiancePoint>& points, double spacing)
        : normalScale(static_cast<float>(normalSpacings * spacing)) {
        for (const IrradiancePoint& p : points) places.push_back(placeOf(p.position, p.normal));
        search = std::make_unique<Search>(6, *this, nanoflann::KDTreeSingleIndexAdaptorParams(8));
        search->buildIndex();
    }
    std::array<float, 6> placeOf(const std::array<float, 3>& p,
                                 const std::array<float, 3>& n) const {
        return {p[0], p[1], p[2], normalScale * n[0], normalScale * n[1], normalScale * n[2]};
    }
    std::array<float, 6> placeOf(const SurfaceHit& hit) const {
        std::array<float, 3> p{}, n{};
        for (std::size_t k = 0; k < 3; ++k) p[k] = static_cast<float>(hit.position[k]);
        const Direction& normal = hit.frame.normal;
        n = {static_cast<float>(normal.x), static_cast<float>(normal.y),
             static_cast<float>(normal.z)};
        return placeOf(p, n);
    }
    std::size_t nearest(const std::array<float, 6>& place, std::size_t count, std::uint32_t* found,
                        float* squares) const {
        return search->knnSearch(place.data(), count, found, squares);
    }
};

SurfaceIrradiance::SurfaceIrradiance(std::vector<IrradiancePoint> points, double spacing)
    : points_(std::move(points)), spacing_(spacing) {
    if (!points_.empty()) tree_ = std::make_unique<Tree>(points_, spacing_);
}
SurfaceIrradiance::~SurfaceIrradiance() = default;
SurfaceIrradiance::SurfaceIrradiance(SurfaceIrradiance&&) noexcept = default;

std::size_t SurfaceIrradiance::bytes() const {
    return points_.size() * (sizeof(IrradiancePoint) + 6 * sizeof(float));
}

SurfaceIrradiance::SurfaceIrradiance(const LightWalk& walk,
                                     const SurfaceIrradianceOptions& options) {
    const SurfaceScene& scene = walk.scene();
    std::vector<std::vector<std::uint32_t>> triangles(scene.objects().size());
    std::vector<double> areas(scene.objects().size());
    double area = 0;
    std::size_t diffuse = 0;
    for (std::uint32_t t = 0; t < scene.triangles(); ++t) {
        const std::size_t object = scene.objectOf(t);
        if (!walk.diffuse().at(scene.objects()[object].material)) continue;
        if (triangles[object].empty()) ++diffuse;
        triangles[object].push_back(t);
        const double one = areaOf(scene.mesh(), t);
        areas[object] += one;
        area += one;
    }
    if (diffuse == 0 || !(area > 0)) return;
    std::vector<SurfaceHit> hits;
    for (std::size_t object = 0; object < triangles.size(); ++object) {
        if (triangles[object].empty()) continue;
        const double share = areas[object] / area / 2 + 0.5 / static_cast<double>(diffuse);
        const auto count = static_cast<std::size_t>(
            std::max(4.0, share * static_cast<double>(options.points) / 2));
        for (const bool front : {true, false})
            addPoints(scene, triangles[object], count, front, hits);
    }
    spacing_ = std::sqrt(2 * area / static_cast<double>(hits.size()));
    for (const SurfaceHit& hit : hits) {
        IrradiancePoint& point = points_.emplace_back();
        for (std::size_t k = 0; k < 3; ++k) point.position[k] = static_cast<float>(hit.position[k]);
        const Direction& n = hit.frame.normal;
        point.normal = {static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z)};
        point.irradiance = {};
    }
    tree_ = std::make_unique<Tree>(points_, spacing_);
    solve(walk, options, hits);
}

void SurfaceIrradiance::solve(const LightWalk& walk, const SurfaceIrradianceOptions& options,
                              const std::vector<SurfaceHit>& hits) {
    const IncomingFunctions irradiance;
    const HemisphereStrata strata(irradiance, options.rays);
    const SurfaceScene& scene = walk.scene();
    const bool gathered = walk.directLight() == DirectLight::gathered;
    std::vector<Rgb> base(hits.size());
    std::vector<std::vector<Link>> links(hits.size());
    std::vector<std::size_t> rays(hits.size());
    std::atomic<std::size_t> done = 0;
    tbb::parallel_for(std::size_t{0}, hits.size(), [&](std::size_t p) {
        RandomNumbers random(options.seed, p);
        for (std::size_t cell = 0; cell < strata.cells(); ++cell) {
            const double x = random.next(), y = random.next();
            const Direction world =
                aboveTriangle(hits[p], hits[p].frame.toWorld(strata.direction(cell, x, y)));
            ++rays[p];
            const auto met = scene.firstHit(hits[p], world);
            if (!met) {
                if (!gathered) continue;
                const Rgb sky = scene.environment().radiance(world);
                for (std::size_t c = 0; c < 3; ++c) base[p][c] += strata.measure() * sky[c];
                continue;
            }
            const Walk found = walk.from(*met, random, rays[p]);
            for (std::size_t c = 0; c < 3; ++c) {
                base[p][c] +=
                    strata.measure() * (found.radiance[c] + (gathered ? met->emission[c] : 0));
            }
            if (!found.end) continue;
            Link& link = links[p].emplace_back();
            float square = 0;
            tree_->nearest(tree_->placeOf(found.end->hit), 1, &link.point, &square);
            for (std::size_t c = 0; c < 3; ++c)
                link.weight[c] = static_cast<float>(strata.measure() * found.end->weight[c]);
        }
        if (options.progress) options.progress(++done, hits.size());
    });
    for (const std::size_t count : rays) rays_ += count;
    std::vector<Rgb> now = base, next(hits.size());
    for (int bounce = 0; bounce < options.bounces; ++bounce) {
        tbb::parallel_for(std::size_t{0}, hits.size(), [&](std::size_t p) {
            next[p] = base[p];
            for (const Link& link : links[p]) {
                for (std::size_t c = 0; c < 3; ++c)
                    next[p][c] += static_cast<double>(link.weight[c]) * now[link.point][c];
            }
        });
        double change = 0, whole = 0;
        for (std::size_t p = 0; p < hits.size(); ++p) {
            for (std::size_t c = 0; c < 3; ++c) {
                change = std::max(change, std::abs(next[p][c] - now[p][c]));
                whole = std::max(whole, std::abs(next[p][c]));
            }
        }
        std::swap(now, next);
        if (!(change > 1e-6 * whole)) break;
    }
    for (std::size_t p = 0; p < hits.size(); ++p) {
        for (std::size_t c = 0; c < 3; ++c)
            points_[p].irradiance[c] = static_cast<float>(now[p][c]);
    }
}

Rgb SurfaceIrradiance::at(const SurfaceHit& hit) const {
    Rgb sum{};
    if (!tree_) return sum;
    std::array<std::uint32_t, neighbours> found{};
    std::array<float, neighbours> squares{};
    const std::size_t count =
        tree_->nearest(tree_->placeOf(hit), neighbours, found.data(), squares.data());
    // The last has the weight 0, so that it can change without a step.
    const double reach = static_cast<double>(squares[count - 1]) * (1 + 1e-6) + 1e-300;
    double weights = 0;
    for (std::size_t k = 0; k < count; ++k) {
        const double weight = 1 - static_cast<double>(squares[k]) / reach;
        weights += weight;
        for (std::size_t c = 0; c < 3; ++c)
            sum[c] += weight * static_cast<double>(points_[found[k]].irradiance[c]);
    }
    for (double& value : sum) value /= weights;
    return sum;
}

}  // namespace hshfit::inline transport::inline radiance_cache
