#include <hshfit/transport/path_tracer.h>

#include <hshfit/brdf/vectors.h>
#include <hshfit/transport/light_sampling.h>
#include <hshfit/transport/random_numbers.h>
#include <hshfit/transport/sample_mean.h>
#include <hshfit/transport/scattering.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>

namespace hshfit::inline transport {
namespace {

void add(Rgb& sum, const Rgb& weight, const Rgb& radiance, double factor) {
    for (std::size_t c = 0; c < 3; ++c) sum[c] += weight[c] * radiance[c] * factor;
}

struct Counts {
    std::size_t rays = 0, cut = 0;
};

/// One path.
class Path {
public:
    Path(const SurfaceScene& scene, const PathOptions& options, RandomNumbers& random,
         Counts& counts)
        : scene_(scene), lights_(scene), options_(options), random_(random), counts_(counts) {}

    Rgb radiance(const Point& origin, Direction direction) {
        ++counts_.rays;
        auto hit = scene_.firstHit(origin, direction);
        for (int bounce = 0;; ++bounce) {
            if (!hit) {
                meetEnvironment(direction, bounce);
                break;
            }
            meetEmitter(*hit, bounce);
            if (bounce >= options_.mostBounces) {
                ++counts_.cut;
                break;
            }
            if (bounce + 1 >= options_.fewestBounces) addLight(*hit);
            if (!goOn(*hit, direction, bounce)) break;
            ++counts_.rays;
            hit = scene_.firstHit(*hit, direction);
        }
        return sum_;
    }

private:
    std::array<double, 3> three() {
        const double a = random_.next(), b = random_.next();
        return {a, b, random_.next()};
    }
    bool counted(int bounce) const { return bounce >= options_.fewestBounces; }

    void meetEnvironment(const Direction& direction, int bounce) {
        if (!counted(bounce) || !scene_.environment().any()) return;
        add(sum_, weight_, scene_.environment().radiance(direction),
            bounce == 0 ? 1 : lights_.environmentWeight(direction, pdf_));
    }

    void meetEmitter(const SurfaceHit& hit, int bounce) {
        if (!counted(bounce) || hit.emission == Rgb{}) return;
        add(sum_, weight_, hit.emission, bounce == 0 ? 1 : lights_.emitterWeight(hit, pdf_));
    }

    /// Light that is sampled as such.
    void addLight(const SurfaceHit& hit) {
        if (!lights_.any()) return;
        const auto u = three();
        const double choice = random_.next();
        add(sum_, weight_,
            lights_.reflected(hit, {u[0], u[1], u[2], choice}, LightSampling::Weight::heuristic,
                              counts_.rays),
            1);
    }

    /// Whether the path goes on, in `direction`.
    bool goOn(const SurfaceHit& hit, Direction& direction, int bounce) {
        const auto next = scatter(scene_, hit, three());
        if (!next) return false;
        for (std::size_t c = 0; c < 3; ++c) weight_[c] *= next->weight[c];
        pdf_ = next->pdf;
        direction = next->world;
        if (bounce < options_.sureBounces) return true;
        const double most =
            std::max({std::abs(weight_[0]), std::abs(weight_[1]), std::abs(weight_[2])});
        const double survival = std::min(0.95, most);
        if (!(random_.next() < survival)) return false;
        for (double& value : weight_) value /= survival;
        return true;
    }

    const SurfaceScene& scene_;
    const LightSampling lights_;
    const PathOptions& options_;
    RandomNumbers& random_;
    Counts& counts_;
    Rgb weight_{1, 1, 1}, sum_{};
    double pdf_ = 0;  ///< of the last direction, per steradian
};

/// The row of a picture that `rays` looks along.
PathRow tracedRow(const SurfaceScene& scene, const CameraRays& rays, const Camera& camera, int row,
                  const PathOptions& options) {
    const auto width = static_cast<std::size_t>(camera.width);
    PathRow done;
    Counts counts;
    for (std::size_t column = 0; column < width; ++column) {
        RandomNumbers random(options.seed, static_cast<std::size_t>(row) * width + column);
        SampleMean statistics;
        for (int k = 0; k < options.samples; ++k) {
            const double u = random.next(), v = random.next();
            const auto [x, y] = placeInPixel(k, options.samples, {u, v});
            const Direction along = rays.direction(static_cast<double>(column) + x, row + y);
            statistics.add(Path(scene, options, random, counts).radiance(rays.origin(), along));
        }
        const Rgb error = statistics.error();
        for (std::size_t c = 0; c < 3; ++c) {
            done.radiance.push_back(static_cast<float>(statistics.mean[c]));
            done.error.push_back(static_cast<float>(error[c]));
        }
    }
    done.rays = counts.rays;
    done.cut = counts.cut;
    return done;
}

}  // namespace

PathPicture tracePaths(const SurfaceScene& scene, const Camera& camera, const PathOptions& options,
                       const PathRows& rows) {
    const CameraRays rays(camera);
    PathPicture picture{.width = camera.width, .height = camera.height};
    picture.radiance.resize(3 * camera.pixels());
    picture.error.resize(3 * camera.pixels());
    std::atomic<std::size_t> done = 0, traced = 0, cut = 0;
    tbb::parallel_for(0, camera.height, [&](int row) {
        std::optional<PathRow> result;
        if (rows.find) result = rows.find(row);
        if (!result) {
            result = tracedRow(scene, rays, camera, row, options);
            if (rows.keep) rows.keep(row, *result);
        }
        const auto first = 3 * static_cast<std::ptrdiff_t>(row) * camera.width;
        std::ranges::copy(result->radiance, picture.radiance.begin() + first);
        std::ranges::copy(result->error, picture.error.begin() + first);
        traced += result->rays;
        cut += result->cut;
        if (options.progress) options.progress(++done, static_cast<std::size_t>(camera.height));
    });
    picture.rays = traced;
    picture.cut = cut;
    return picture;
}

int samplesWithin(const SurfaceScene& scene, const Camera& camera, const PathOptions& options,
                  const TimeLimit& limit) {
    constexpr int fewest = 2, step = 8;
    if (!limit || options.samples <= fewest) return options.samples;
    PathOptions trial = options;
    trial.samples = fewest;
    trial.progress = {};
    const std::size_t width = 3 * static_cast<std::size_t>(camera.width);
    const PathRow dark{.radiance = std::vector<float>(width), .error = std::vector<float>(width)};
    const double before = limit.secondsLeft();
    tracePaths(scene, camera, trial, {.find = [&](int row) {
                   return row % step == 0 ? std::nullopt : std::optional(dark);
               }});
    const double left = limit.secondsLeft(), perSample = (before - left) * step / fewest;
    const double fit = perSample > 0 ? left / perSample : options.samples;
    return static_cast<int>(std::clamp<double>(fit, fewest, options.samples));
}

PathEstimate tracePaths(const SurfaceScene& scene, const Point& origin, const Direction& direction,
                        const PathOptions& options) {
    SampleMean statistics;
    Counts counts;
    for (int k = 0; k < options.samples; ++k) {
        RandomNumbers random(options.seed, static_cast<std::uint64_t>(k));
        statistics.add(Path(scene, options, random, counts).radiance(origin, direction));
    }
    return {statistics.mean, statistics.error()};
}

}  // namespace hshfit::inline transport
