#include <hshfit/transport/radiance_cache/cost_prediction.h>

#include <hshfit/brdf/vectors.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline transport::inline radiance_cache {
namespace {

/// Seconds, measured on one machine as docs/explanation/illuminate.md says.
constexpr double raySeconds = 0.9e-6;       ///< of a ray of a walk with what it meets
constexpr double tabulationSeconds = 4e-9;  ///< of a function in a cell of a record
constexpr double reachSeconds = 3e-7;       ///< of a record that a look-up uses
constexpr double productSeconds = 1e-9;     ///< of a function and channel
constexpr double turnSeconds = 7.3e-9;      ///< of a function, channel and band
/// Discs of half the reach about records laid one by one where none reaches cover 0.547 of a plane
/// (random sequential adsorption, Feder 1980), so that four times as many reach a point.
constexpr double recordsInReach = 4 * 0.547;

constexpr int linesOfSight = 64;  ///< along both edges of a picture
constexpr std::size_t walkHits = 64, gatherHits = 8;
constexpr int walksOfHit = 16;

struct Seen {
    SurfaceHit hit;
    double height = 0;  ///< of the picture there
    double area = 0;    ///< of the surface that the line of sight stands for
};

/// The places where cameras see a material.
struct Sight {
    double pixels = 0;
    std::vector<Seen> seen;
};

std::vector<Sight> sightsOf(const RadianceCache& cache, std::span<const Camera* const> cameras) {
    const SurfaceScene& scene = cache.scene();
    std::vector<Sight> sights(scene.materials().size());
    for (const Camera* camera : cameras) {
        const CameraRays rays(*camera);
        const int columns = std::min(linesOfSight, camera->width);
        const int rows = std::min(linesOfSight, camera->height);
        const double slope = 2 * std::tan(camera->fieldOfView / 2);
        const double stands = static_cast<double>(camera->pixels()) / (columns * rows);
        for (int place = 0; place < columns * rows; ++place) {
            const double column = (place % columns + 0.5) * camera->width / columns;
            const double row = (place / columns + 0.5) * camera->height / rows;
            const auto hit = scene.firstHit(rays.origin(), rays.direction(column, row));
            if (!hit || !cache.takesRecords(*hit)) continue;
            Sight& sight = sights[scene.objects()[hit->object].material];
            const double edge = hit->distance * slope;
            const double cosine = std::max(0.05, std::abs(hit->wo.z));
            sight.pixels += stands;
            sight.seen.push_back({*hit, edge, edge * edge / (rows * rows) / cosine});
        }
    }
    return sights;
}

/// The n-th of `count` hits that lie evenly among the hits seen.
const Seen& evenly(const Sight& sight, std::size_t n, std::size_t count) {
    return sight.seen[(2 * n + 1) * sight.seen.size() / (2 * count)];
}

/// Sums over hits of squares of means and of the variance about them.
struct Spread {
    double variance = 0, squares = 0, mean = 0;
    /// Relative to the mean's square with a tenth of it over all hits.
    double relative(double hits) const {
        const double offset = mean / hits / 3;
        const double whole = squares + 3 * hits * offset * offset / 100;
        return whole > 0 ? variance / whole : 0;
    }
    void add(const Rgb& sum, const Rgb& sumOfSquares, double count) {
        for (std::size_t c = 0; c < 3; ++c) {
            const double average = sum[c] / count;
            const double within =
                std::max(0.0, (sumOfSquares[c] - count * average * average) / (count - 1));
            variance += within;
            squares += std::max(0.0, average * average - within / count);
            mean += average;
        }
    }
};

class Predicting {
public:
    Predicting(const RadianceCache& cache, int samples)
        : cache_(cache), settings_(cache.options()), samples_(samples) {}

    MaterialCost predicted(const Sight& sight, const MaterialLight& material) const {
        MaterialCost cost{.pixels = sight.pixels};
        if (sight.seen.empty() || material.way != LightWay::coefficients) return {};
        predictWalks(sight, cost);
        predictRecords(sight, material, cost);
        const double lookUps = cost.pixels * samples_;
        cost.cacheSeconds = cost.records * cost.recordSeconds + lookUps * cost.lookUpSeconds;
        cost.walks = static_cast<int>(std::clamp(
            std::ceil(cost.variance / std::max(cost.error, 1e-12) / samples_), 1.0, 1e6));
        cost.samplingSeconds = lookUps * cost.walks * cost.walkSeconds;
        return cost;
    }

private:
    void predictWalks(const Sight& sight, MaterialCost& cost) const {
        const std::size_t hits = std::min(walkHits, sight.seen.size());
        std::size_t rays = 0;
        Spread spread;
        for (std::size_t n = 0; n < hits; ++n) {
            const SurfaceHit& hit = evenly(sight, n, hits).hit;
            RandomNumbers random(settings_.seed, (std::uint64_t{3} << 48) + n);
            Rgb sum{}, squares{};
            for (int k = 0; k < walksOfHit; ++k) {
                const Rgb found = cache_.sampled(hit, random, rays);
                for (std::size_t c = 0; c < 3; ++c)
                    sum[c] += found[c], squares[c] += found[c] * found[c];
            }
            spread.add(sum, squares, walksOfHit);
        }
        cost.variance = spread.relative(static_cast<double>(hits));
        cost.walkSeconds =
            raySeconds * static_cast<double>(rays) / static_cast<double>(hits * walksOfHit);
    }

    void predictRecords(const Sight& sight, const MaterialLight& material,
                        MaterialCost& cost) const {
        const std::size_t hits = std::min(gatherHits, sight.seen.size());
        struct Pair {
            std::array<Rgb, 2> radiance{};
            double records = 0;  ///< in the area of the line of sight
            std::size_t rays = 0;
        };
        std::vector<Pair> pairs(hits);
        tbb::parallel_for(std::size_t{0}, hits, [&](std::size_t n) {
            const Seen& seen = evenly(sight, n, hits);
            for (const std::size_t k : {0U, 1U}) {
                const std::uint64_t item = (std::uint64_t{1} << 41) + 2 * n + k;
                const RadianceCache::Trial trial = cache_.trial(seen.hit, seen.height, item);
                const double bend = bendAt(seen.hit) / std::sqrt(2.0);
                const double perReach = (1 / trial.radius + bend) * (1 / trial.longRadius + bend) /
                                        (settings_.accuracy * settings_.accuracy);
                pairs[n].radiance[k] = trial.radiance;
                pairs[n].records += recordsInReach / pi * perReach * seen.area / 2;
                pairs[n].rays += trial.rays;
            }
        });
        const double pixels = sight.pixels / static_cast<double>(sight.seen.size());
        Spread spread;
        double records = 0;
        std::size_t rays = 0;
        for (const Pair& pair : pairs) {
            Rgb sum{}, squares{};
            for (const Rgb& found : pair.radiance)
                for (std::size_t c = 0; c < 3; ++c)
                    sum[c] += found[c], squares[c] += found[c] * found[c];
            spread.add(sum, squares, 2);
            // Records lie in the middles of pixels.
            records += std::min(pair.records, pixels) / static_cast<double>(hits);
            rays += pair.rays;
        }
        const IncomingFunctions& functions = cache_.materials().kinds[material.kind];
        const auto size = static_cast<double>(functions.size());
        const auto channels = static_cast<double>(material.channels);
        // A look-up at the end of the reach misses by half the second derivative at most.
        const double miss = settings_.accuracy * settings_.accuracy / 2;
        cost.error = spread.relative(static_cast<double>(hits)) / recordsInReach + miss * miss;
        cost.records = records * static_cast<double>(sight.seen.size());
        cost.recordSeconds =
            raySeconds * static_cast<double>(rays) / static_cast<double>(2 * hits) +
            tabulationSeconds * size * settings_.rays;
        cost.lookUpSeconds =
            recordsInReach * (reachSeconds + size * channels * productSeconds +
                              curvedShare(sight) * size * channels * material.order * turnSeconds);
    }

    /// The turn of the normal over a length, by the corners of the hit's triangle: over d it adds
    /// d times this over the root of 2 to what the weights of Eq. 23 compare with the accuracy.
    double bendAt(const SurfaceHit& hit) const {
        const Mesh& mesh = cache_.scene().mesh();
        const auto& t = mesh.triangles[hit.triangle];
        const MeshVector* normals = mesh.normals.data() + 3 * std::size_t{hit.triangle};
        double most = 0;
        for (const std::size_t k : {1U, 2U}) {
            const Direction turn = directionOf(normals[k]) - directionOf(normals[0]);
            const Direction edge =
                directionOf(mesh.positions[t[k]]) - directionOf(mesh.positions[t[0]]);
            most = std::max(most, std::sqrt(dot(turn, turn) / dot(edge, edge)));
        }
        return most;
    }

    /// The share of the hits about which records have other frames.
    double curvedShare(const Sight& sight) const {
        double curved = 0;
        for (const Seen& seen : sight.seen)
            if (bendAt(seen.hit) * seen.height > 1e-3) ++curved;
        return curved / static_cast<double>(sight.seen.size());
    }

    const RadianceCache& cache_;
    const CacheOptions& settings_;
    int samples_;
};

}  // namespace

std::vector<MaterialCost> predictCosts(const RadianceCache& cache,
                                       std::span<const Camera* const> cameras, int samples) {
    const std::vector<Sight> sights = sightsOf(cache, cameras);
    std::vector<MaterialCost> costs;
    for (std::size_t m = 0; m < sights.size(); ++m) {
        costs.push_back(
            Predicting(cache, samples).predicted(sights[m], cache.materials().materials[m]));
    }
    return costs;
}

}  // namespace hshfit::inline transport::inline radiance_cache
