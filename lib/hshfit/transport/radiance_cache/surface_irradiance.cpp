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
/// A walk ends on points whose neighbours are nearer than its last ray is long, by this factor.
constexpr double reachesOfRay = 2;
constexpr int manyBounces = 64;

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

std::uint32_t sideOf(const SurfaceHit& hit) {
    return 2 * static_cast<std::uint32_t>(hit.object) + (hit.front ? 0 : 1);
}

struct Link {
    std::uint32_t point = 0;
    std::array<float, 3> weight{};
};

}  // namespace

struct SurfaceIrradiance::Tree {
    std::vector<std::uint32_t> numbers;  ///< of its points
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

    explicit Tree(double spacing) : normalScale(static_cast<float>(normalSpacings * spacing)) {}
    void add(std::uint32_t number, const IrradiancePoint& p) {
        numbers.push_back(number);
        places.push_back(placeOf(p.position, p.normal));
    }
    void build() {
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
    /// Numbers of the nearest points, the nearest first.
    std::size_t nearest(const std::array<float, 6>& place, std::size_t count, std::uint32_t* found,
                        float* squares) const {
        const std::size_t several = search->knnSearch(place.data(), count, found, squares);
        for (std::size_t k = 0; k < several; ++k) found[k] = numbers[found[k]];
        return several;
    }
};

SurfaceIrradiance::SurfaceIrradiance(std::vector<IrradiancePoint> points, double spacing,
                                     int bounces)
    : points_(std::move(points)), spacing_(spacing), bounces_(bounces) {
    plant();
}
SurfaceIrradiance::~SurfaceIrradiance() = default;
SurfaceIrradiance::SurfaceIrradiance(SurfaceIrradiance&&) noexcept = default;

std::size_t SurfaceIrradiance::bytes() const {
    return points_.size() * (sizeof(IrradiancePoint) + 8 * sizeof(float));
}

SurfaceIrradiance::SurfaceIrradiance(const LightWalk& walk, const SurfaceIrradianceOptions& options)
    : bounces_(options.bounces) {
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
        point.side = sideOf(hit);
    }
    plant();
    solve(walk, options, hits);
}

void SurfaceIrradiance::plant() {
    for (std::size_t p = 0; p < points_.size(); ++p) {
        const std::uint32_t side = points_[p].side;
        if (trees_.size() <= side) trees_.resize(side + 1);
        if (!trees_[side]) trees_[side] = std::make_unique<Tree>(spacing_);
        trees_[side]->add(static_cast<std::uint32_t>(p), points_[p]);
    }
    for (const auto& tree : trees_)
        if (tree) tree->build();
    reach_.resize(points_.size());
    tbb::parallel_for(std::size_t{0}, points_.size(), [&](std::size_t p) {
        const IrradiancePoint& point = points_[p];
        const Tree& tree = *trees_[point.side];
        std::array<std::uint32_t, neighbours> found{};
        std::array<float, neighbours> squares{};
        const std::size_t count = tree.nearest(tree.placeOf(point.position, point.normal),
                                               neighbours, found.data(), squares.data());
        for (std::size_t k = 0; k < count; ++k) {
            const auto& other = points_[found[k]].position;
            reach_[p] = std::max(
                reach_[p], std::hypot(other[0] - point.position[0], other[1] - point.position[1],
                                      other[2] - point.position[2]));
        }
    });
}

const SurfaceIrradiance::Tree* SurfaceIrradiance::treeAt(const SurfaceHit& hit) const {
    const std::uint32_t side = sideOf(hit);
    return side < trees_.size() ? trees_[side].get() : nullptr;
}

/// Whether a ray is too short for the points that it meets. Walks that go on leave no count of
/// bounces, and so they end where these are few.
bool SurfaceIrradiance::isClose(const SurfaceHit& hit, std::uint32_t nearest) const {
    return bounces_ >= manyBounces &&
           hit.distance < reachesOfRay * static_cast<double>(reach_[nearest]);
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
            Link link{};
            const KnownLight linked = [&](const SurfaceHit& end, bool last) -> std::optional<Rgb> {
                const Tree& tree = *treeAt(end);
                float square = 0;
                tree.nearest(tree.placeOf(end), 1, &link.point, &square);
                if (!last && isClose(end, link.point)) return {};
                return Rgb{};
            };
            const Walk found = walk.from(*met, linked, random, rays[p]);
            for (std::size_t c = 0; c < 3; ++c) {
                base[p][c] +=
                    strata.measure() * (found.radiance[c] + (gathered ? met->emission[c] : 0));
            }
            if (found.endWeight == Rgb{}) continue;
            for (std::size_t c = 0; c < 3; ++c)
                link.weight[c] = static_cast<float>(strata.measure() * found.endWeight[c]);
            links[p].push_back(link);
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

std::optional<Rgb> SurfaceIrradiance::at(const SurfaceHit& hit, bool last) const {
    Rgb sum{};
    const Tree* tree = treeAt(hit);
    if (!tree) return sum;
    std::array<std::uint32_t, neighbours> found{};
    std::array<float, neighbours> squares{};
    const std::size_t count =
        tree->nearest(tree->placeOf(hit), neighbours, found.data(), squares.data());
    if (!last && isClose(hit, found[0])) return {};
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
