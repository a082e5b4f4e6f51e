#include <hshfit/rendering/lit_picture.h>

#include <hshfit/pictures/sphere_picture.h>
#include <hshfit/rendering/internal/lit_points.h>
#include <hshfit/rendering/internal/point_integrals.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace hshfit::inline rendering {
namespace {

/// The errors of pixels from the errors of their points.
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
        result.picture.notFinite += fact.notFinite;
    }
    result.error = total > 0 ? std::sqrt(error / total) : 0;
    result.early = integrals.early();
    addPixelErrors(points, facts, result);
    result.evaluations = static_cast<double>(integrals.evaluations()) /
                         std::max<double>(1, static_cast<double>(points.count()));
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
