#include <hshfit/transport/path_tracer.h>

#include <hshfit/brdf/vectors.h>
#include <hshfit/transport/internal/random_numbers.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>

namespace hshfit::inline transport {
namespace {

void add(Rgb& sum, const Rgb& weight, const Rgb& radiance, double factor) {
    for (std::size_t c = 0; c < 3; ++c) sum[c] += weight[c] * radiance[c] * factor;
}

/// The power heuristic with exponent 2.
double shareOf(double mine, double other) {
    return mine * mine / (mine * mine + other * other);
}

struct Counts {
    std::size_t rays = 0, cut = 0;
};

/// One path.
class Path {
public:
    Path(const SurfaceScene& scene, const PathOptions& options, RandomNumbers& random,
         Counts& counts)
        : scene_(scene), options_(options), random_(random), counts_(counts) {}

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

    /// The share of choosing emitters where there is light far away too.
    double emitterShare() const {
        if (!scene_.hasEmitters()) return 0;
        return scene_.environment().any() ? 0.5 : 1;
    }

    void meetEnvironment(const Direction& direction, int bounce) {
        if (!counted(bounce) || !scene_.environment().any()) return;
        const double light =
            bounce == 0 ? 0 : (1 - emitterShare()) * scene_.environment().pdf(direction);
        add(sum_, weight_, scene_.environment().radiance(direction),
            bounce == 0 ? 1 : shareOf(pdf_, light));
    }

    void meetEmitter(const SurfaceHit& hit, int bounce) {
        if (!counted(bounce) || hit.emission == Rgb{}) return;
        double share = 1;
        if (bounce > 0) {
            const double cosine = dot(hit.flat, hit.frame.toWorld(hit.wo));
            const double light = emitterShare() * scene_.emitterPdf(hit) * hit.distance *
                                 hit.distance / std::max(cosine, 1e-300);
            share = shareOf(pdf_, light);
        }
        add(sum_, weight_, hit.emission, share);
    }

    /// Light that is sampled as such.
    void addLight(const SurfaceHit& hit) {
        const double emitters = emitterShare();
        if (emitters == 0 && !scene_.environment().any()) return;
        const auto u = three();
        if (random_.next() < emitters)
            addEmitter(hit, scene_.sampleEmitters(u), emitters);
        else
            addEnvironment(hit, scene_.environment().sample(u), 1 - emitters);
    }

    /// f cos(theta_i) for a direction of the world; 0 from behind the surface.
    Rgb reflected(const SurfaceHit& hit, const Direction& world, Direction& wi) const {
        wi = normalised(hit.frame.toLocal(world));
        if (!(wi.z > 0) || !(dot(world, hit.flat) > 0)) return {};
        Rgb f = scene_.reflectance(hit, wi);
        for (double& value : f) value *= wi.z;
        return f;
    }
    double samplerPdf(const SurfaceHit& hit, const Direction& wi) const {
        return scene_.material(hit).sampler->pdf(hit.wo, wi);
    }

    void addEnvironment(const SurfaceHit& hit, const EnvironmentSample& light, double share) {
        if (!(light.pdf > 0)) return;
        Direction wi;
        const Rgb f = reflected(hit, light.world, wi);
        if (f == Rgb{}) return;
        ++counts_.rays;
        if (!scene_.visible(hit, light.world)) return;
        const double pdf = share * light.pdf;
        addSampled(f, light.radiance, (light.delta ? 1 : shareOf(pdf, samplerPdf(hit, wi))) / pdf);
    }

    void addEmitter(const SurfaceHit& hit, const EmitterSample& light, double share) {
        const Direction gap{light.position[0] - hit.position[0],
                            light.position[1] - hit.position[1],
                            light.position[2] - hit.position[2]};
        const double squared = dot(gap, gap);
        if (!(squared > 0)) return;
        const Direction world = normalised(gap);
        const double cosine = -dot(world, light.normal);
        if (!(cosine > 0)) return;
        Direction wi;
        const Rgb f = reflected(hit, world, wi);
        if (f == Rgb{}) return;
        ++counts_.rays;
        if (!scene_.visible(hit, world, light.position)) return;
        const double pdf = share * light.pdf * squared / cosine;
        addSampled(f, light.radiance, shareOf(pdf, samplerPdf(hit, wi)) / pdf);
    }

    void addSampled(const Rgb& f, const Rgb& radiance, double factor) {
        for (std::size_t c = 0; c < 3; ++c) sum_[c] += weight_[c] * f[c] * radiance[c] * factor;
    }

    /// Whether the path goes on, in `direction`.
    bool goOn(const SurfaceHit& hit, Direction& direction, int bounce) {
        const Sample next = scene_.material(hit).sampler->sample(hit.wo, three());
        if (!(next.pdf > 0)) return false;
        const Direction world = normalised(hit.frame.toWorld(next.wi));
        Direction wi;
        const Rgb f = reflected(hit, world, wi);
        if (f == Rgb{}) return false;
        for (std::size_t c = 0; c < 3; ++c) weight_[c] *= f[c] / next.pdf;
        pdf_ = next.pdf;
        direction = world;
        if (bounce < options_.sureBounces) return true;
        const double most =
            std::max({std::abs(weight_[0]), std::abs(weight_[1]), std::abs(weight_[2])});
        const double survival = std::min(0.95, most);
        if (!(random_.next() < survival)) return false;
        for (double& value : weight_) value /= survival;
        return true;
    }

    const SurfaceScene& scene_;
    const PathOptions& options_;
    RandomNumbers& random_;
    Counts& counts_;
    Rgb weight_{1, 1, 1}, sum_{};
    double pdf_ = 0;  ///< of the last direction, per steradian
};

/// Mean and standard error of samples, by Welford's recurrence.
struct Statistics {
    Rgb mean{}, squares{};
    double count = 0;

    void add(const Rgb& sample) {
        count += 1;
        for (std::size_t c = 0; c < 3; ++c) {
            const double off = sample[c] - mean[c];
            mean[c] += off / count;
            squares[c] += off * (sample[c] - mean[c]);
        }
    }
    Rgb error() const {
        Rgb error{};
        if (count < 2) return error;
        for (std::size_t c = 0; c < 3; ++c) error[c] = std::sqrt(squares[c] / (count - 1) / count);
        return error;
    }
};

}  // namespace

PathPicture tracePaths(const SurfaceScene& scene, const Camera& camera,
                       const PathOptions& options) {
    const CameraRays rays(camera);
    PathPicture picture{.width = camera.width, .height = camera.height};
    picture.radiance.resize(3 * camera.pixels());
    picture.error.resize(3 * camera.pixels());
    const auto width = static_cast<std::size_t>(camera.width);
    const int side = std::max(1, static_cast<int>(std::sqrt(options.samples)));
    std::vector<Counts> counts(static_cast<std::size_t>(camera.height));
    std::atomic<std::size_t> done = 0;
    tbb::parallel_for(std::size_t{0}, counts.size(), [&](std::size_t row) {
        for (std::size_t column = 0; column < width; ++column) {
            const std::size_t pixel = row * width + column;
            RandomNumbers random(options.seed, pixel);
            Statistics statistics;
            for (int k = 0; k < options.samples; ++k) {
                double x = random.next(), y = random.next();
                if (k < side * side) {
                    x = (k % side + x) / side;
                    y = (k / side + y) / side;
                }
                statistics.add(
                    Path(scene, options, random, counts[row])
                        .radiance(rays.origin(), rays.direction(static_cast<double>(column) + x,
                                                                static_cast<double>(row) + y)));
            }
            const Rgb error = statistics.error();
            for (std::size_t c = 0; c < 3; ++c) {
                picture.radiance[3 * pixel + c] = static_cast<float>(statistics.mean[c]);
                picture.error[3 * pixel + c] = static_cast<float>(error[c]);
            }
        }
        if (options.progress) options.progress(++done, counts.size());
    });
    for (const Counts& one : counts) {
        picture.rays += one.rays;
        picture.cut += one.cut;
    }
    return picture;
}

PathEstimate tracePaths(const SurfaceScene& scene, const Point& origin, const Direction& direction,
                        const PathOptions& options) {
    Statistics statistics;
    Counts counts;
    for (int k = 0; k < options.samples; ++k) {
        RandomNumbers random(options.seed, static_cast<std::uint64_t>(k));
        statistics.add(Path(scene, options, random, counts).radiance(origin, direction));
    }
    return {statistics.mean, statistics.error()};
}

}  // namespace hshfit::inline transport
