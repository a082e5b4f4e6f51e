#include <hshfit/rendering/lit_picture.h>

#include <hshfit/brdf/transmission.h>
#include <hshfit/pictures/sphere_picture.h>
#include <hshfit/rendering/internal/lit_points.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace hshfit::inline rendering {
namespace {

/// The integrals at the points, and the tolerance that each has kept to.
class PointIntegrals {
public:
    PointIntegrals(const Brdf& brdf, const SurfacePoints& points, const View& view,
                   const DirectIntegral& light, const IntegrationOptions& options)
        : brdf_(brdf),
          points_(points),
          view_(view),
          light_(light),
          options_(options),
          through_(transmits(brdf)),
          facts_(points.count()),
          kept_(points.count(), notReached) {}

    const std::vector<PointRadiance>& facts() const { return facts_; }
    std::size_t early() const {
        return static_cast<std::size_t>(std::ranges::count_if(
            kept_, [&](double tolerance) { return tolerance > options_.tolerance; }));
    }

    void run(const RenderProgress& progress) {
        Steps steps(progress, blocksOf(points_));
        pass(options_.tolerance, steps, [](std::size_t) { return true; });
    }
    void runUntil(const TimeLimit& limit, const RenderProgress& progress) {
        const double coarse = std::max(coarsest, options_.tolerance);
        std::vector<char> first(points_.count(), 0);
        for (std::size_t p = 0; p < points_.coverage.size(); ++p) {
            if (points_.first[p] < points_.first[p + 1]) first[points_.first[p]] = 1;
        }
        const auto inTime = [&](std::size_t) { return !limit.isOver(); };
        Steps steps(progress, 3 * blocksOf(points_));
        pass(coarse, steps, [&](std::size_t k) { return first[k] != 0; });
        pass(coarse, steps, inTime);
        pass(options_.tolerance, steps, inTime);
        fillPixels();
    }

private:
    static constexpr double notReached = std::numeric_limits<double>::infinity();
    /// The tolerance of the first pass: wider ones take as long.
    static constexpr double coarsest = 0.5;

    template <class Wanted>
    void pass(double tolerance, Steps& steps, const Wanted& wanted) {
        forBlocks(points_, steps, [&](std::size_t first, std::size_t last) {
            for (std::size_t k = first; k < last; ++k)
                if (kept_[k] > tolerance && wanted(k)) integrate(k, tolerance);
        });
    }
    void integrate(std::size_t k, double tolerance) {
        const LitPoint at = litPoint(points_.normals[k], points_.viewer(k, view_), through_);
        IntegrationOptions how = options_;
        how.tolerance = tolerance;
        facts_[k] = light_.at(brdf_, at.frame, at.wo, how);
        const bool fine = facts_[k].error <= options_.tolerance * absoluteSum(facts_[k].radiance);
        kept_[k] = fine ? options_.tolerance : tolerance;
    }
    void fillPixels() {
        for (std::size_t p = 0; p < points_.coverage.size(); ++p) {
            Rgb sum{};
            double error = 0, count = 0;
            for (std::size_t k = points_.first[p]; k < points_.first[p + 1]; ++k) {
                if (kept_[k] == notReached) continue;
                for (std::size_t c = 0; c < 3; ++c) sum[c] += facts_[k].radiance[c];
                error += facts_[k].error;
                ++count;
            }
            for (std::size_t k = points_.first[p]; k < points_.first[p + 1]; ++k) {
                if (kept_[k] != notReached) continue;
                facts_[k].radiance = {sum[0] / count, sum[1] / count, sum[2] / count};
                facts_[k].error = error / count;
            }
        }
    }

    const Brdf& brdf_;
    const SurfacePoints& points_;
    const View& view_;
    const DirectIntegral& light_;
    const IntegrationOptions& options_;
    const bool through_;
    std::vector<PointRadiance> facts_;
    std::vector<double> kept_;  ///< the tolerance by point
};

/// The errors of pixels from those of their points.
void addPixelErrors(const SurfacePoints& points, const std::vector<PointRadiance>& facts,
                    LitPicture& result) {
    double mean = 0;
    for (const PointRadiance& fact : facts) mean += absoluteSum(fact.radiance);
    mean /= std::max<double>(1, static_cast<double>(facts.size()));
    std::vector<float>& errors = result.picture.error;
    errors.assign(points.coverage.size(), 0.0F);
    for (std::size_t pixel = 0; pixel < errors.size(); ++pixel) {
        const std::size_t first = points.first[pixel], last = points.first[pixel + 1];
        double error = 0, radiance = 0;
        for (std::size_t k = first; k < last; ++k) {
            error += facts[k].error;
            radiance += absoluteSum(facts[k].radiance);
        }
        const double scale = std::max(radiance, darkest * mean * static_cast<double>(last - first));
        if (!(scale > 0)) continue;
        errors[pixel] = static_cast<float>(error / scale);
        if (error / scale <= result.largest.error) continue;
        const auto size = static_cast<std::size_t>(points.size);
        result.largest = {error / scale, pixel % size, pixel / size};
    }
}

}  // namespace

LitPicture renderByIntegration(const Brdf& brdf, const SurfacePoints& points, const View& view,
                               const DirectIntegral& light, const IntegrationOptions& options,
                               const RenderProgress& progress, const TimeLimit& until) {
    assert(brdf.channels().count() == 1 || brdf.channels().count() == 3);
    PointIntegrals integrals(brdf, points, view, light, options);
    if (until)
        integrals.runUntil(until, progress);
    else
        integrals.run(progress);
    const std::vector<PointRadiance>& facts = integrals.facts();
    Radiance radiance;
    for (const PointRadiance& fact : facts) radiance.push_back(fact.radiance);
    LitPicture result{.picture = pictureOf(points, radiance)};
    double error = 0, total = 0;
    for (const PointRadiance& fact : facts) {
        double sum = 0;
        for (const double value : fact.radiance) sum += value;
        error += fact.error * fact.error;
        total += sum * sum;
        result.cut += fact.cut ? 1 : 0;
        result.evaluations += static_cast<double>(fact.evaluations);
        result.picture.notFinite += fact.notFinite;
    }
    result.error = total > 0 ? std::sqrt(error / total) : 0;
    result.early = integrals.early();
    addPixelErrors(points, facts, result);
    result.evaluations /= std::max<double>(1, static_cast<double>(points.count()));
    return result;
}

PictureDifference differenceOf(const SpherePicture& reference, const SpherePicture& approximation) {
    const SpherePicture difference = sphereDifference(reference, approximation);
    PictureDifference result;
    double sum = 0, weight = 0, largest = -1;
    for (std::size_t i = 0; i < difference.radiance.size(); ++i) {
        const double covered = reference.coverage[i / 3];
        if (!(covered > 0)) continue;
        sum += covered * reference.radiance[i];
        weight += covered;
        const double here = std::abs(double{difference.radiance[i]});
        if (here <= largest) continue;
        largest = here;
        result.column = i / 3 % static_cast<std::size_t>(reference.size);
        result.row = i / 3 / static_cast<std::size_t>(reference.size);
    }
    const double squared = meanSquare(reference);
    result.meanRadiance = weight > 0 ? sum / weight : 0;
    result.relativeL2 = squared > 0 ? std::sqrt(meanSquare(difference) / squared) : 0;
    result.maximum = result.meanRadiance > 0 && largest > 0 ? largest / result.meanRadiance : 0;
    return result;
}

}  // namespace hshfit::inline rendering
