#include <hshfit/rendering/lit_picture.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/brdf/transmission.h>
#include <hshfit/light/picture_light.h>
#include <hshfit/light/radiance.h>
#include <hshfit/pictures/sphere_picture.h>
#include <hshfit/rendering/internal/light_cells.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cmath>

namespace hshfit::inline rendering {
namespace {

/// Points of a task.
constexpr std::size_t blockSize = 64;
/// Points at which levels of light samples are compared.
constexpr std::size_t comparedPoints = 32;
constexpr int mostSampleLevel = 6;

/// Calls `work(first, last)` for blocks of the points, on all threads.
void forBlocks(std::size_t count, const RenderProgress& progress,
               const std::function<void(std::size_t, std::size_t)>& work) {
    const std::size_t blocks = (count + blockSize - 1) / blockSize;
    std::atomic<std::size_t> done = 0;
    tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t block) {
        work(block * blockSize, std::min(count, (block + 1) * blockSize));
        if (progress) progress(++done, blocks);
    });
}

/// Skies with a gradient as pictures: their parts serve every normal, where nodes in each normal's
/// hemisphere would cost exponentials. Uniform and overcast skies keep their nodes.
std::vector<Light> withoutCostlySkies(std::span<const Light> lights) {
    std::vector<Light> result;
    for (const Light& light : lights) {
        const auto* sky = std::get_if<SkyLight>(&light);
        const bool costly =
            sky && (sky->model == SkyLight::Model::cie || sky->model == SkyLight::Model::preetham);
        result.push_back(costly ? withSkyPictures({&light, 1}).front() : light);
    }
    return result;
}

/// The lights as samples above any normal: parts of pictures are cut once, in the world.
class LightAbove {
public:
    LightAbove(std::span<const Light> lights, int level) : level_(level) {
        for (const Light& light : lights) {
            if (const auto* picture = std::get_if<PictureLight>(&light)) {
                const auto parts = pictureSamples(*picture, 1e-3 * std::pow(1.5, -3 * level));
                parts_.insert(parts_.end(), parts.begin(), parts.end());
            } else {
                others_.push_back(light);
            }
        }
    }
    LightSamples at(const Frame& frame) const {
        LightSamples samples = sampleLights(others_, frame, level_);
        for (const PictureSample& part : parts_) {
            samples.add(frame.toLocal(part.direction), part.flux, 1);
        }
        return samples;
    }

private:
    int level_;
    std::vector<PictureSample> parts_;
    std::vector<Light> others_;
};

/// A point of a surface in the frame of its lit side.
struct LitPoint {
    Frame frame;
    Direction wo;
};

/// The side that is seen, for a reflection. A transmission is a thin pane: light comes from behind
/// it, and the viewer's direction, below the lit side, is mirrored at the surface.
LitPoint litPoint(const Direction& normal, const Direction& viewer, bool through) {
    if (!through) {
        const Frame frame = frameAt(normal);
        return {frame, frame.toLocal(viewer)};
    }
    const Frame frame = frameAt({-normal.x, -normal.y, -normal.z});
    return {frame, throughSurface(frame.toLocal(viewer))};
}

/// Coefficients of materials met with light at single points.
class CoefficientShader {
public:
    explicit CoefficientShader(std::span<const Coefficients* const> materials)
        : materials_(materials) {
        const Coefficients& one = *materials.front();
        basis_ = bases::make(one.basis, one.order, {.condonShortley = one.condonShortley});
        quantity_ = one.quantity;
        for ([[maybe_unused]] const Coefficients* other : materials) {
            assert(other->basis == one.basis && other->order == one.order);
            assert(other->condonShortley == one.condonShortley && other->quantity == quantity_);
            assert(other->channels.count() == 1 || other->channels.count() == 3);
            assert(transmissionSide(other->source).empty() == transmissionSide(one.source).empty());
        }
        through_ = !transmissionSide(one.source).empty();
    }

    /// [material]; returns the number of light samples.
    std::size_t radiance(const LightAbove& light, const Direction& normal, const Direction& viewer,
                         Rgb* out) const {
        const auto [frame, wo] = litPoint(normal, viewer, through_);
        const LightSamples samples = light.at(frame);
        const BasisLight inBasis(*basis_, quantity_, samples);
        std::vector<double> c;
        for (std::size_t k = 0; k < materials_.size(); ++k) {
            const Coefficients& material = *materials_[k];
            const std::size_t size = material.channels.count() * material.slots();
            const OutgoingLookup found = lookUp(material.outgoing, wo);
            c.assign(size, 0.0);
            for (std::size_t n = 0; n < static_cast<std::size_t>(found.count); ++n) {
                const double* from = material.at(found.index[n], 0);
                for (std::size_t i = 0; i < size; ++i) c[i] += found.weight[n] * from[i];
            }
            out[k] = inBasis.radiance(c, material.order, found.turn);
        }
        return samples.count();
    }

private:
    std::span<const Coefficients* const> materials_;
    std::unique_ptr<Basis> basis_;
    Quantity quantity_ = Quantity::brdf;
    bool through_ = false;
};

double squaredDistance(const std::vector<Rgb>& a, const std::vector<Rgb>& b, double& reference) {
    double sum = 0;
    for (std::size_t k = 0; k < a.size(); ++k) {
        for (std::size_t c = 0; c < 3; ++c) {
            sum += (a[k][c] - b[k][c]) * (a[k][c] - b[k][c]);
            reference += b[k][c] * b[k][c];
        }
    }
    return sum;
}

/// Light samples fine enough, and the error that they leave.
struct ChosenLight {
    LightAbove light;
    double error = 0;
};

ChosenLight chooseLight(const CoefficientShader& shader, std::size_t materials,
                        const SurfacePoints& points, const View& view,
                        std::span<const Light> lights, double tolerance) {
    std::vector<std::size_t> compared;
    const std::size_t step = std::max<std::size_t>(1, points.count() / comparedPoints);
    for (std::size_t k = step / 2; k < points.count(); k += step) {
        compared.push_back(k);
    }
    const auto shaded = [&](const LightAbove& light) {
        std::vector<Rgb> radiance(compared.size() * materials);
        tbb::parallel_for(std::size_t{0}, compared.size(), [&](std::size_t k) {
            shader.radiance(light, points.normals[compared[k]], points.viewer(compared[k], view),
                            radiance.data() + k * materials);
        });
        return radiance;
    };
    ChosenLight chosen{LightAbove(lights, 0)};
    std::vector<Rgb> before = shaded(chosen.light);
    for (int level = 1; level <= mostSampleLevel; ++level) {
        chosen.light = LightAbove(lights, level);
        std::vector<Rgb> now = shaded(chosen.light);
        double reference = 0;
        const double difference = squaredDistance(before, now, reference);
        chosen.error = reference > 0 ? std::sqrt(difference / reference) : 0;
        if (chosen.error <= tolerance) break;
        before = std::move(now);
    }
    return chosen;
}

double sumOf(const Rgb& value) {
    return value[0] + value[1] + value[2];
}

/// The errors of pixels from those of their points.
void addPixelErrors(const SurfacePoints& points, const std::vector<PointRadiance>& facts,
                    LitPicture& result) {
    constexpr double darkest = 0.05;
    double mean = 0;
    for (const PointRadiance& fact : facts) mean += std::abs(sumOf(fact.radiance));
    mean /= std::max<double>(1, static_cast<double>(facts.size()));
    std::vector<float>& errors = result.picture.error;
    errors.assign(points.coverage.size(), 0.0F);
    for (std::size_t pixel = 0; pixel < errors.size(); ++pixel) {
        const std::size_t first = points.first[pixel], last = points.first[pixel + 1];
        double error = 0, radiance = 0;
        for (std::size_t k = first; k < last; ++k) {
            error += facts[k].error;
            radiance += std::abs(sumOf(facts[k].radiance));
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
                               const RenderProgress& progress) {
    assert(brdf.channels().count() == 1 || brdf.channels().count() == 3);
    Radiance radiance(points.count());
    std::vector<PointRadiance> facts(points.count());
    const bool through = transmits(brdf);
    forBlocks(points.count(), progress, [&](std::size_t first, std::size_t last) {
        for (std::size_t k = first; k < last; ++k) {
            const LitPoint at = litPoint(points.normals[k], points.viewer(k, view), through);
            facts[k] = light.at(brdf, at.frame, at.wo, options);
            radiance[k] = facts[k].radiance;
        }
    });
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
    addPixelErrors(points, facts, result);
    result.evaluations /= std::max<double>(1, static_cast<double>(points.count()));
    return result;
}

std::vector<LitPicture> renderByCoefficients(std::span<const Coefficients* const> materials,
                                             const SurfacePoints& points, const View& view,
                                             std::span<const Light> lights,
                                             const CoefficientShading& options) {
    const CoefficientShader shader(materials);
    const std::vector<Light> pictured = withoutCostlySkies(lights);
    const ChosenLight chosen =
        chooseLight(shader, materials.size(), points, view, pictured, options.tolerance);
    std::vector<Radiance> radiance(materials.size(), Radiance(points.count()));
    std::vector<std::size_t> samples(points.count());
    forBlocks(points.count(), options.progress, [&](std::size_t first, std::size_t last) {
        std::vector<Rgb> at(materials.size());
        for (std::size_t k = first; k < last; ++k) {
            samples[k] =
                shader.radiance(chosen.light, points.normals[k], points.viewer(k, view), at.data());
            for (std::size_t i = 0; i < at.size(); ++i) radiance[i][k] = at[i];
        }
    });
    double mean = 0;
    for (const std::size_t count : samples) mean += static_cast<double>(count);
    mean /= std::max<double>(1, static_cast<double>(points.count()));
    std::vector<LitPicture> results;
    for (const Radiance& one : radiance) {
        results.push_back(
            {.picture = pictureOf(points, one), .error = chosen.error, .evaluations = mean});
    }
    return results;
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
