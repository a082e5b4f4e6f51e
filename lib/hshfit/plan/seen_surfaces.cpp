#include <hshfit/plan/seen_surfaces.h>

#include <hshfit/brdf/vectors.h>
#include <hshfit/light/light_samples.h>
#include <hshfit/plan/plan.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace hshfit::plan {
namespace {

/// The share of hits at either end that does not widen a range of views.
constexpr double trimmed = 0.01;
/// Steeper views are at the limit of what a ViewRange may hold.
constexpr double steepest = 89 * (pi / 180);
constexpr int lloydSteps = 20;

struct Seen {
    Frame frame;   ///< of the surface
    Direction wo;  ///< in it
};

/// The group of each normal: centres from farthest points until all are within `narrow`, then the
/// means of the groups.
struct Groups {
    std::vector<Direction> centres = {};
    std::vector<std::size_t> of = {};

    Groups(const std::vector<Seen>& hits, const SeenOptions& options) : of(hits.size()) {
        Direction sum{0, 0, 0};
        for (const Seen& hit : hits) sum = sum + hit.frame.normal;
        const auto nearestTo = [&](const Direction& wanted) {
            return std::ranges::max_element(
                       hits, {}, [&](const Seen& hit) { return dot(hit.frame.normal, wanted); })
                ->frame.normal;
        };
        centres.push_back(nearestTo(sum));
        std::vector<double> cosines(hits.size(), -2);
        while (true) {
            std::size_t farthest = 0;
            for (std::size_t k = 0; k < hits.size(); ++k) {
                cosines[k] = std::max(cosines[k], dot(hits[k].frame.normal, centres.back()));
                if (cosines[k] < cosines[farthest]) farthest = k;
            }
            if (cosines[farthest] >= std::cos(options.narrow) ||
                centres.size() >= options.mostOrientations)
                break;
            centres.push_back(hits[farthest].frame.normal);
        }
        for (int step = 0; step < lloydSteps && move(hits); ++step) {
        }
    }

    /// One step; false where no normal changes its group.
    bool move(const std::vector<Seen>& hits) {
        bool changed = false;
        std::vector<Direction> sums(centres.size(), Direction{0, 0, 0});
        for (std::size_t k = 0; k < hits.size(); ++k) {
            const Direction& normal = hits[k].frame.normal;
            const auto best = std::ranges::max_element(
                centres, {}, [&](const Direction& centre) { return dot(normal, centre); });
            const auto group = static_cast<std::size_t>(best - centres.begin());
            changed = changed || of[k] != group;
            of[k] = group;
            sums[group] = sums[group] + normal;
        }
        for (std::size_t g = 0; g < centres.size(); ++g)
            if (dot(sums[g], sums[g]) > 1e-12) centres[g] = normalised(sums[g]);
        return changed;
    }
};

/// The orientation whose frame has the normal, and the tangent of that frame at the hit nearest to
/// it.
Orientation orientationOf(const Direction& normal, const std::vector<Seen>& hits,
                          const Groups& groups, std::size_t group) {
    const Seen* nearest = nullptr;
    for (std::size_t k = 0; k < hits.size(); ++k) {
        if (groups.of[k] != group) continue;
        if (!nearest || dot(hits[k].frame.normal, normal) > dot(nearest->frame.normal, normal))
            nearest = &hits[k];
    }
    Orientation orientation{.theta = polarAngle(normal),
                            .phi = normal.x == 0 && normal.y == 0 ? 0 : azimuth(normal)};
    const Frame unturned(orientation);
    orientation.turn = std::atan2(dot(nearest->frame.tangent, unturned.bitangent),
                                  dot(nearest->frame.tangent, unturned.tangent));
    return orientation;
}

/// The middle of sorted values.
std::pair<double, double> middleOf(const std::vector<double>& sorted) {
    const auto cut = static_cast<std::size_t>(trimmed * static_cast<double>(sorted.size()));
    return {sorted[cut], sorted[sorted.size() - 1 - cut]};
}

ViewRange viewsOf(const std::vector<Seen>& hits) {
    std::vector<double> thetas, phis;
    for (const Seen& hit : hits) {
        thetas.push_back(std::min(polarAngle(hit.wo), steepest));
        phis.push_back(azimuth(hit.wo));
    }
    std::ranges::sort(thetas);
    std::ranges::sort(phis);
    ViewRange views;
    std::tie(views.thetaMin, views.thetaMax) = middleOf(thetas);
    // Azimuths from the end of the widest gap between two of them.
    std::size_t first = 0;
    double widest = phis.front() + 2 * pi - phis.back();
    for (std::size_t k = 1; k < phis.size(); ++k) {
        if (phis[k] - phis[k - 1] <= widest) continue;
        widest = phis[k] - phis[k - 1];
        first = k;
    }
    std::rotate(phis.begin(), phis.begin() + static_cast<std::ptrdiff_t>(first), phis.end());
    for (std::size_t k = 1; k < phis.size(); ++k)
        if (phis[k] < phis[0]) phis[k] += 2 * pi;
    std::tie(views.phiMin, views.phiMax) = middleOf(phis);
    // All around, where what is left out is no wider than what the hits tell apart.
    if (views.phiMax - views.phiMin > radians(300)) {
        views.phiMin = 0;
        views.phiMax = 2 * pi;
    }
    return views;
}

/// The hits of one camera's rays, by material: one in each cell of a grid, at the places of a
/// sequence that is even within the cells (Roberts 2018, "The unreasonable effectiveness of
/// quasirandom sequences").
void look(const SurfaceScene& surfaces, const Camera& camera, const SeenOptions& options,
          std::vector<std::vector<Seen>>& hits, std::size_t& rays) {
    const CameraRays lines(camera);
    const auto aspect = static_cast<double>(camera.width) / camera.height;
    const std::size_t columns = std::max<std::size_t>(
        1, static_cast<std::size_t>(std::sqrt(static_cast<double>(options.rays) * aspect)));
    const std::size_t rows = std::max<std::size_t>(1, options.rays / columns);
    // The root of x^3 = x + 1.
    const double plastic =
        std::cbrt((9 + std::sqrt(69.0)) / 18) + std::cbrt((9 - std::sqrt(69.0)) / 18);
    double u = 0.5, v = 0.5;
    for (std::size_t row = 0; row < rows; ++row) {
        for (std::size_t column = 0; column < columns; ++column) {
            u = std::fmod(u + 1 / plastic, 1);
            v = std::fmod(v + 1 / (plastic * plastic), 1);
            const double x = (static_cast<double>(column) + u) / static_cast<double>(columns);
            const double y = (static_cast<double>(row) + v) / static_cast<double>(rows);
            ++rays;
            const auto hit = surfaces.firstHit(
                lines.origin(), lines.direction(x * camera.width, y * camera.height));
            if (!hit) continue;
            hits[surfaces.objects()[hit->object].material].push_back({hit->frame, hit->wo});
        }
    }
}

}  // namespace

std::vector<SeenMaterial> seenMaterials(const SurfaceScene& surfaces,
                                        std::span<const Camera> cameras,
                                        const SeenOptions& options) {
    std::vector<std::vector<Seen>> hits(surfaces.materials().size());
    std::size_t rays = 0;
    for (const Camera& camera : cameras) look(surfaces, camera, options, hits, rays);
    std::vector<SeenMaterial> result;
    for (const std::vector<Seen>& own : hits) {
        SeenMaterial& seen = result.emplace_back();
        seen.rays = rays;
        seen.hits = own.size();
        if (own.empty()) continue;
        seen.views = viewsOf(own);
        const Groups groups(own, options);
        std::vector<std::size_t> sizes(groups.centres.size());
        for (std::size_t k = 0; k < own.size(); ++k) {
            ++sizes[groups.of[k]];
            seen.spread = std::max(seen.spread,
                                   angleBetween(own[k].frame.normal, groups.centres[groups.of[k]]));
        }
        std::vector<std::size_t> order(sizes.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::ranges::stable_sort(order, std::ranges::greater{},
                                 [&](std::size_t g) { return sizes[g]; });
        for (const std::size_t g : order) {
            if (sizes[g] == 0) continue;
            seen.orientations.push_back(orientationOf(groups.centres[g], own, groups, g));
            seen.shares.push_back(static_cast<double>(sizes[g]) / static_cast<double>(own.size()));
        }
    }
    return result;
}

void takeSeen(Scene& scene, std::span<const SeenMaterial> seen) {
    for (std::size_t m = 0; m < scene.materials.size(); ++m) {
        if (seen[m].hits == 0) continue;
        Material& material = scene.materials[m];
        if (!material.orientationsStated) material.orientations = seen[m].orientations;
        if (!scene.viewsStated) material.views = seen[m].views;
    }
}

std::string sentenceOf(const SeenMaterial& seen, std::size_t cameras) {
    const std::string rays =
        fmt::format("{} rays of {} camera{}", seen.rays, cameras, cameras == 1 ? "" : "s");
    if (seen.hits == 0)
        return fmt::format(
            "no camera sees it: none of {} meets it; upright, for all views of the "
            "scene",
            rays);
    return fmt::format(
        "{:.3g} % of the picture ({} of {}): {} orientation{} within {:.3g}°, views from {:.3g}° "
        "to {:.3g}° off the normal",
        100 * seen.share(), seen.hits, rays, seen.orientations.size(),
        seen.orientations.size() == 1 ? "" : "s", degrees(seen.spread),
        degrees(seen.views.thetaMin), degrees(seen.views.thetaMax));
}

}  // namespace hshfit::plan
