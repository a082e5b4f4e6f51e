#include <hshfit/transport/radiance_cache/cached_picture.h>

#include <hshfit/brdf/vectors.h>
#include <hshfit/transport/sample_mean.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <span>

namespace hshfit::inline transport::inline radiance_cache {
namespace {

/// Records made at once. More would let records lie too close to each other, fewer would let
/// threads wait.
constexpr std::size_t batch = 32;
constexpr int coarsest = 16;
/// Widening of the reach for points between pixels' centres.
constexpr double widening = 2;

void add(Rgb& sum, const Rgb& weight, const Rgb& radiance) {
    for (std::size_t c = 0; c < 3; ++c) sum[c] += weight[c] * radiance[c];
}

struct Wanted {
    SurfaceHit hit;
    double height = 0;  ///< of the picture there
    std::uint64_t pixel = 0, order = 0;
};

class Taking {
public:
    Taking(RadianceCache& cache, const Camera& camera, const CachedPictureOptions& options)
        : cache_(cache),
          scene_(cache.scene()),
          walk_(cache.walk()),
          settings_(cache.options()),
          camera_(camera),
          rays_(camera),
          options_(options),
          slope_(2 * std::tan(camera.fieldOfView / 2)),
          total_(static_cast<std::size_t>(2 * camera.height)),
          tried_(camera.pixels()) {}

    CachedPicture taken() {
        const std::size_t before = cache_.records().size(), rays = cache_.rays();
        if (needsRecords()) makeRecords();
        cache_.settle();
        result_.made = cache_.records().size() - before;
        shade();
        result_.picture.rays += cache_.rays() - rays;
        return std::move(result_);
    }

private:
    /// Whether light of enough reflections is asked for at all.
    bool needsRecords() const {
        return settings_.mostBounces >= (settings_.direct == DirectLight::sampled ? 2 : 1);
    }
    double heightAt(const SurfaceHit& hit) const { return hit.distance * slope_; }

    void makeRecords() {
        for (int step = coarsest; step > 1; step /= 2) fill(step);
        // New records shrink the reach of others, which uncovers pixels that were seen before.
        // A pixel that has had its turn without a record that reaches it is sampled.
        while (fill(1)) {
        }
    }

    /// Makes records until each pixel of a raster that none reached has been; whether any was.
    bool fill(int step) {
        const std::vector<std::vector<Wanted>> rows = missing(step);
        std::vector<Wanted> wanted;
        for (const std::vector<Wanted>& row : rows)
            wanted.insert(wanted.end(), row.begin(), row.end());
        std::ranges::sort(wanted, {}, &Wanted::order);
        const bool any = !wanted.empty() && !cache_.full();
        while (!wanted.empty() && !cache_.full()) {
            const std::size_t count = std::min(batch, wanted.size());
            std::vector<SurfaceHit> hits;
            std::vector<double> heights;
            for (std::size_t k = 0; k < count; ++k) {
                if (step == 1) tried_[wanted[k].pixel] = 1;
                hits.push_back(wanted[k].hit);
                heights.push_back(wanted[k].height);
            }
            cache_.make(hits, heights);
            wanted.erase(wanted.begin(), wanted.begin() + static_cast<long>(count));
            wanted = uncovered(wanted);
        }
        return any;
    }

    /// Centres of pixels of a raster that no record reaches, row by row.
    std::vector<std::vector<Wanted>> missing(int step) {
        const int count = (camera_.height + step - 1) / step;
        std::vector<std::vector<Wanted>> rows(static_cast<std::size_t>(count));
        std::atomic<std::size_t> traced = 0;
        tbb::parallel_for(0, count, [&](int k) {
            const int row = k * step;
            for (int column = 0; column < camera_.width; column += step) {
                // Pixels of the coarser rasters were reached before. The last raster looks at them
                // again, because reaches shrink.
                const bool before = row % (2 * step) == 0 && column % (2 * step) == 0;
                if (before && step < coarsest && step > 1) continue;
                ++traced;
                const auto pixel =
                    static_cast<std::uint64_t>(row) * static_cast<std::uint64_t>(camera_.width) +
                    static_cast<std::uint64_t>(column);
                if (tried_[pixel] != 0) continue;
                const auto hit =
                    scene_.firstHit(rays_.origin(), rays_.direction(column + 0.5, row + 0.5));
                if (!hit || !cache_.takesRecords(*hit) || cache_.covers(*hit)) continue;
                rows[static_cast<std::size_t>(k)].push_back(
                    {*hit, heightAt(*hit), pixel,
                     static_cast<std::uint64_t>(RandomNumbers(settings_.seed, pixel).next() *
                                                0x1p53)});
            }
        });
        result_.picture.rays += traced;
        const int pass = passes_++;
        if (pass < 5) report(static_cast<std::size_t>(camera_.height) / 5);
        return rows;
    }

    std::vector<Wanted> uncovered(const std::vector<Wanted>& wanted) const {
        std::vector<unsigned char> still(wanted.size());
        tbb::parallel_for(std::size_t{0}, wanted.size(),
                          [&](std::size_t k) { still[k] = cache_.covers(wanted[k].hit) ? 0 : 1; });
        std::vector<Wanted> left;
        for (std::size_t k = 0; k < wanted.size(); ++k)
            if (still[k] != 0) left.push_back(wanted[k]);
        return left;
    }

    struct Counts {
        std::size_t rays = 0, uncovered = 0;
    };

    /// Reflected light by the records, or by a walk where none reaches.
    Rgb indirect(const SurfaceHit& hit, RandomNumbers& random, Counts& counts) const {
        Rgb found{};
        if (cache_.takesRecords(hit)) {
            if (cache_.radiance(hit, found) || cache_.radiance(hit, found, widening)) return found;
            ++counts.uncovered;
        }
        const int walks = cache_.walksAt(hit);
        found = {};
        for (int k = 0; k < walks; ++k) {
            const double share = 1.0 / walks;
            add(found, {share, share, share}, cache_.sampled(hit, random, counts.rays));
        }
        return found;
    }

    Rgb radiance(const Direction& direction, RandomNumbers& random, Counts& counts) const {
        ++counts.rays;
        const auto hit = scene_.firstHit(rays_.origin(), direction);
        if (!hit) {
            if (settings_.fewestBounces > 0 || !scene_.environment().any()) return {};
            return scene_.environment().radiance(direction);
        }
        Rgb sum{};
        if (settings_.fewestBounces == 0) sum = hit->emission;
        if (settings_.direct == DirectLight::sampled && settings_.fewestBounces <= 1 &&
            settings_.mostBounces >= 1)
            add(sum, {1, 1, 1}, walk_.direct(*hit, random, counts.rays));
        if (needsRecords()) add(sum, {1, 1, 1}, indirect(*hit, random, counts));
        return sum;
    }

    void shade() {
        const auto height = static_cast<std::size_t>(camera_.height);
        const auto width = static_cast<std::size_t>(camera_.width);
        PathPicture& picture = result_.picture;
        picture.width = camera_.width;
        picture.height = camera_.height;
        picture.radiance.resize(3 * camera_.pixels());
        picture.error.resize(3 * camera_.pixels());
        std::vector<Counts> counts(height);
        tbb::parallel_for(std::size_t{0}, height, [&](std::size_t row) {
            for (std::size_t column = 0; column < width; ++column) {
                const std::size_t pixel = row * width + column;
                RandomNumbers random(settings_.seed, (std::uint64_t{1} << 48) + pixel);
                SampleMean samples;
                for (int k = 0; k < options_.samples; ++k) {
                    const double u = random.next(), v = random.next();
                    const auto [x, y] = placeInPixel(k, options_.samples, {u, v});
                    samples.add(radiance(rays_.direction(static_cast<double>(column) + x,
                                                         static_cast<double>(row) + y),
                                         random, counts[row]));
                }
                const Rgb error = samples.error();
                for (std::size_t c = 0; c < 3; ++c) {
                    picture.radiance[3 * pixel + c] = static_cast<float>(samples.mean[c]);
                    picture.error[3 * pixel + c] = static_cast<float>(error[c]);
                }
            }
            report(1);
        });
        for (const Counts& one : counts) {
            picture.rays += one.rays;
            result_.uncovered += one.uncovered;
        }
    }

    void report(std::size_t rows) {
        done_ += rows;
        if (options_.progress) options_.progress(std::min(done_.load(), total_), total_);
    }

    RadianceCache& cache_;
    const SurfaceScene& scene_;
    const LightWalk& walk_;
    const CacheOptions& settings_;
    const Camera& camera_;
    const CameraRays rays_;
    const CachedPictureOptions& options_;
    const double slope_;  ///< height of the picture at distance 1
    const std::size_t total_;
    std::atomic<std::size_t> done_ = 0;
    int passes_ = 0;
    std::vector<unsigned char> tried_;  ///< pixels that a record was made for
    CachedPicture result_;
};

}  // namespace

CachedPicture takePicture(RadianceCache& cache, const Camera& camera,
                          const CachedPictureOptions& options) {
    return Taking(cache, camera, options).taken();
}

std::vector<RecordPlace> recordPlaces(const RadianceCache& cache, const Camera& camera) {
    const CameraRays rays(camera);
    std::vector<RecordPlace> places;
    for (std::size_t k = 0; k < cache.records().size(); ++k) {
        const Point& at = cache.records()[k].position;
        const auto pixel = rays.pixelOf(at);
        if (!pixel) continue;
        const auto met =
            cache.scene().firstHit(rays.origin(), rays.direction((*pixel)[0], (*pixel)[1]));
        const double distance = std::hypot(at[0] - rays.origin()[0], at[1] - rays.origin()[1],
                                           at[2] - rays.origin()[2]);
        if (!met || std::abs(met->distance - distance) > 1e-3 * distance) continue;
        places.push_back({static_cast<int>((*pixel)[0]), static_cast<int>((*pixel)[1]), k});
    }
    return places;
}

}  // namespace hshfit::inline transport::inline radiance_cache
