#include <hshfit/rendering/lit_picture.h>

#include <hshfit/bases/catalog.h>
#include <hshfit/brdf/transmission.h>
#include <hshfit/light/light_above.h>
#include <hshfit/light/picture_light.h>
#include <hshfit/light/radiance.h>
#include <hshfit/rendering/internal/light_cells.h>
#include <hshfit/rendering/internal/lit_points.h>
#include <hshfit/rendering/internal/normal_table.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <memory>
#include <optional>

namespace hshfit::inline rendering {
namespace {

/// Points at which levels of light samples are compared.
constexpr std::size_t comparedPoints = 32;
constexpr int mostSampleLevel = 6;
/// A table of normals: cells along the edge of a cube for each band of the basis.
constexpr std::size_t cellsPerBand = 4;
constexpr std::size_t leastParts = 64, leastPoints = 1000;
/// Values of a table: 32 MiB.
constexpr std::size_t mostValues = std::size_t{1} << 22;

/// Skies with a gradient as pictures: their parts serve every normal, where nodes in each normal's
/// hemisphere would cost exponentials. Uniform and overcast skies keep their nodes.
std::vector<Light> withoutCostlySkies(std::span<const Light> lights) {
    std::vector<Light> result;
    for (const Light& light : lights) {
        const auto* sky = std::get_if<SkyLight>(&light);
        result.push_back(sky && sky->peaked() ? skyPicture({&light, 1}) : light);
    }
    return result;
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

    const Basis& basis() const { return *basis_; }
    bool through() const { return through_; }
    BasisLight inBasis(const LightSamples& samples) const { return {*basis_, quantity_, samples}; }

    /// [material]; `turn`: azimuth of the frame's tangent in the axes of `light`.
    void shade(const BasisLight& light, const Direction& wo, double turn, Rgb* out) const {
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
            out[k] = light.radiance(c, material.order, found.turn + turn);
        }
    }
    /// The same with the light above the point.
    void radiance(const LightAbove& light, const LitPoint& point, Rgb* out) const {
        shade(inBasis(light.at(point.frame)), point.wo, 0, out);
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
            const std::size_t at = compared[k];
            shader.radiance(light,
                            litPoint(points.normals[at], points.viewer(at, view), shader.through()),
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

double sumOfSquares(const Rgb& value) {
    return value[0] * value[0] + value[1] * value[1] + value[2] * value[2];
}

/// Light of pictures in the basis, by normal. A table is used where it takes less work than the
/// points themselves, and in cells in whose middle the interpolated radiance agrees with the
/// radiance computed there.
class LightByNormal {
public:
    LightByNormal(const CoefficientShader& shader, const LightAbove& light, std::size_t materials,
                  const SurfacePoints& points, const View& view)
        : shader_(shader), light_(light), points_(points), view_(view), materials_(materials) {
        const auto order = static_cast<std::size_t>(shader.basis().order());
        const std::size_t values = 3 * order * order;
        if (light.pictureParts() < leastParts || points.count() < leastPoints) return;
        std::vector<Direction> normals(points.count());
        for (std::size_t k = 0; k < normals.size(); ++k) normals[k] = at(k).frame.normal;
        table_.emplace(normals, static_cast<int>(cellsPerBand * order));
        if (2 * work() > points.count() || values * table_->vertices() > mostValues) table_.reset();
    }

    /// The steps of `prepare`.
    std::size_t work() const { return table_ ? table_->vertices() + table_->middles().size() : 0; }
    /// Makes the table; `tolerance` of a cell.
    void prepare(double tolerance, Steps& steps) {
        if (!table_) return;
        const auto order = static_cast<std::size_t>(shader_.basis().order());
        table_->fill(3 * order * order, [&](const Frame& frame, double* out) {
            const BasisLight inBasis = shader_.inBasis(light_.pictures(frame));
            std::ranges::copy(inBasis.values(), out);
            steps.done();
        });
        check(tolerance, steps);
    }

    /// Relative L2 of interpolation, over the middles of the cells that serve.
    double error() const { return error_; }

    /// [material] of a point.
    void radiance(std::size_t k, Rgb* out) const {
        const LitPoint point = at(k);
        if (table_ && serves_[table_->cellOf(point.frame.normal)])
            interpolated(point, out);
        else
            shader_.radiance(light_, point, out);
    }

private:
    LitPoint at(std::size_t k) const {
        return litPoint(points_.normals[k], points_.viewer(k, view_), shader_.through());
    }
    void interpolated(const LitPoint& point, Rgb* out) const {
        const int order = shader_.basis().order();
        std::vector<double> values(3 * static_cast<std::size_t>(order * order));
        const double turn = table_->interpolate(point.frame.normal, values);
        shader_.shade(BasisLight(order, std::move(values)), point.wo, turn, out);
        if (!light_.hasOthers()) return;
        std::vector<Rgb> others(materials_);
        shader_.shade(shader_.inBasis(light_.others(point.frame)), point.wo, 0, others.data());
        for (std::size_t m = 0; m < materials_; ++m) {
            for (std::size_t c = 0; c < 3; ++c) out[m][c] += others[m][c];
        }
    }

    void check(double tolerance, Steps& steps) {
        const std::span<const std::size_t> middles = table_->middles();
        const std::size_t count = middles.size() * materials_;
        std::vector<Rgb> exactly(count), nearly(count);
        tbb::parallel_for(std::size_t{0}, middles.size(), [&](std::size_t k) {
            const LitPoint point = at(middles[k]);
            shader_.radiance(light_, point, exactly.data() + k * materials_);
            interpolated(point, nearly.data() + k * materials_);
            steps.done();
        });
        std::vector<double> floors(materials_, 0.0);
        for (std::size_t i = 0; i < count; ++i) {
            floors[i % materials_] +=
                darkest * absoluteSum(exactly[i]) / static_cast<double>(middles.size());
        }
        serves_.assign(middles.size(), 1);
        double squared = 0, reference = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const Rgb& exact = exactly[i];
            const Rgb gap = {nearly[i][0] - exact[0], nearly[i][1] - exact[1],
                             nearly[i][2] - exact[2]};
            reference += sumOfSquares(exact);
            if (absoluteSum(gap) > tolerance * std::max(absoluteSum(exact), floors[i % materials_]))
                serves_[i / materials_] = 0;
            else
                squared += sumOfSquares(gap);
        }
        error_ = reference > 0 ? std::sqrt(squared / reference) : 0;
    }

    const CoefficientShader& shader_;
    const LightAbove& light_;
    const SurfacePoints& points_;
    const View& view_;
    const std::size_t materials_;
    std::optional<NormalTable> table_;
    std::vector<char> serves_;  ///< by cell
    double error_ = 0;
};

}  // namespace

std::vector<LitPicture> renderByCoefficients(std::span<const Coefficients* const> materials,
                                             const SurfacePoints& points, const View& view,
                                             std::span<const Light> lights,
                                             const CoefficientShading& options) {
    const CoefficientShader shader(materials);
    const std::vector<Light> pictured = withoutCostlySkies(lights);
    const ChosenLight chosen =
        chooseLight(shader, materials.size(), points, view, pictured, options.tolerance);
    LightByNormal byNormal(shader, chosen.light, materials.size(), points, view);
    Steps steps(options.progress, byNormal.work() + blocksOf(points));
    byNormal.prepare(options.tolerance / 4, steps);
    std::vector<Radiance> radiance(materials.size(), Radiance(points.count()));
    forBlocks(points, steps, [&](std::size_t first, std::size_t last) {
        std::vector<Rgb> at(materials.size());
        for (std::size_t k = first; k < last; ++k) {
            byNormal.radiance(k, at.data());
            for (std::size_t i = 0; i < at.size(); ++i) radiance[i][k] = at[i];
        }
    });
    std::vector<LitPicture> results;
    for (const Radiance& one : radiance) {
        results.push_back({.picture = pictureOf(points, one),
                           .error = std::hypot(chosen.error, byNormal.error())});
    }
    return results;
}

}  // namespace hshfit::inline rendering
