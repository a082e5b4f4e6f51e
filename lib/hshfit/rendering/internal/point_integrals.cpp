#include <hshfit/rendering/internal/point_integrals.h>

#include <hshfit/brdf/transmission.h>
#include <hshfit/brdf/vectors.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <span>

namespace hshfit::inline rendering {
namespace {

constexpr double notReached = std::numeric_limits<double>::infinity();
constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
/// The tolerance of the first pass of a picture with an end of the time: wider ones take as long.
constexpr double coarsest = 0.5;
/// Points for each integral of a grid, at least.
constexpr std::size_t leastShared = 4;
/// Cells along the edge of a cube, at least: 7.5 degrees.
constexpr double fewestCells = 12;
/// Cells for the turn of a normal that moves the mirror direction by the width of a lobe.
constexpr double cellsPerLobe = 2;

/// Radiance in R, G, B and its error.
constexpr std::size_t valuesOfPoint = 4;
/// Cosine of the viewer at a vertex, at least: beyond, f is steep or nothing.
constexpr double lowestViewer = 0.02;

}  // namespace

PointIntegrals::PointIntegrals(const Brdf& brdf, const SurfacePoints& points, const View& view,
                               const DirectIntegral& light, const IntegrationOptions& options)
    : brdf_(brdf),
      points_(points),
      view_(view),
      light_(light),
      options_(options),
      through_(transmits(brdf)),
      facts_(points.count()),
      kept_(points.count(), notReached) {}

std::size_t PointIntegrals::early() const {
    return static_cast<std::size_t>(std::ranges::count_if(
        kept_, [&](double tolerance) { return tolerance > options_.tolerance; }));
}

void PointIntegrals::run(const RenderProgress& progress) {
    Steps steps(progress, blocksOf(points_));
    takeEvenLight([] { return true; });
    interpolate(options_.tolerance, steps, [] { return true; });
    pass(options_.tolerance, steps, [](std::size_t) { return true; });
}

void PointIntegrals::runUntil(const TimeLimit& limit, const RenderProgress& progress) {
    const double coarse = std::max(coarsest, options_.tolerance);
    std::vector<char> first(points_.count(), 0);
    for (std::size_t p = 0; p < points_.coverage.size(); ++p) {
        if (points_.first[p] < points_.first[p + 1]) first[points_.first[p]] = 1;
    }
    const auto inTime = [&] { return !limit.isOver(); };
    Steps steps(progress, 3 * blocksOf(points_));
    takeEvenLight(inTime);
    interpolate(coarse, steps, [] { return true; });
    pass(coarse, steps, [&](std::size_t k) { return first[k] != 0; });
    pass(coarse, steps, [&](std::size_t) { return inTime(); });
    interpolate(options_.tolerance, steps, inTime);
    pass(options_.tolerance, steps, [&](std::size_t) { return inTime(); });
    fillPixels();
}

void PointIntegrals::takeEvenLight(const GoesOn& goesOn) {
    if (absoluteSum(light_.evenRadiance()) > 0)
        evaluations_ +=
            even_.emplace(brdf_, options_, points_.count() / leastShared, goesOn).evaluations();
}

void PointIntegrals::pass(double tolerance, Steps& steps,
                          const std::function<bool(std::size_t)>& wanted) {
    forBlocks(points_, steps, [&](std::size_t first, std::size_t last) {
        for (std::size_t k = first; k < last; ++k)
            if (kept_[k] > tolerance && wanted(k)) integrate(k, tolerance);
    });
}

PointRadiance PointIntegrals::integral(const Direction& normal, const Direction& viewer,
                                       double tolerance) const {
    const LitPoint at = litPoint(normal, viewer, through_);
    IntegrationOptions how = options_;
    how.tolerance = tolerance;
    std::optional<PointRadiance> underEven;
    if (const auto one = even_ ? even_->at(at.wo) : std::nullopt) {
        const Rgb even = light_.evenRadiance();
        underEven.emplace();
        for (std::size_t c = 0; c < 3; ++c) underEven->radiance[c] = even[c] * one->radiance[c];
        underEven->error = one->error * std::max({even[0], even[1], even[2]});
    }
    return light_.at(brdf_, at.frame, at.wo, how, underEven);
}

void PointIntegrals::integrate(std::size_t k, double tolerance) {
    facts_[k] = integral(points_.normals[k], points_.viewer(k, view_), tolerance);
    evaluations_ += facts_[k].evaluations;
    keep(k, tolerance);
}

void PointIntegrals::keep(std::size_t k, double tolerance) {
    const bool fine = facts_[k].error <= options_.tolerance * absoluteSum(facts_[k].radiance);
    kept_[k] = fine ? options_.tolerance : tolerance;
}

void PointIntegrals::fillPixels() {
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

/// A cell is no wider than half of the turn that moves the mirror direction by the narrowest lobe,
/// unless the light is smoother.
std::size_t PointIntegrals::coarsestGrid() const {
    double narrowest = 1;
    for (const double theta : {0.0, 30.0, 60.0, 80.0}) {
        for (const Lobe& lobe : brdf_.lobes(directionFromAngles(radians(theta), 0)))
            narrowest = std::min(narrowest, lobe.width);
    }
    const double cells = pi / 2 * cellsPerLobe / std::max({narrowest, light_.finest(), 1e-6});
    return static_cast<std::size_t>(std::clamp(std::ceil(cells), fewestCells, 1e5));
}

void PointIntegrals::interpolate(double tolerance, Steps& steps, const GoesOn& goesOn) {
    if (!points_.viewers.empty()) return;
    std::vector<std::size_t> open;
    for (std::size_t k = 0; k < kept_.size(); ++k)
        if (kept_[k] > tolerance) open.push_back(k);
    for (std::size_t perEdge = coarsestGrid(); goesOn(); perEdge *= 2) {
        if (perEdge * perEdge > open.size()) return;
        std::vector<Direction> normals(open.size());
        for (std::size_t i = 0; i < open.size(); ++i) normals[i] = points_.normals[open[i]];
        NormalTable table(normals, static_cast<int>(perEdge));
        const std::size_t work = table.vertices() + table.middles().size();
        if (leastShared * work > open.size()) return;
        steps.more(work);
        fill(table, tolerance, steps, goesOn);
        const std::vector<double> gaps = gapsOf(table, open, tolerance, steps, goesOn);
        std::vector<std::size_t> rest;
        for (const std::size_t k : open) {
            if (kept_[k] <= tolerance) continue;  // the middle of a cell
            const double gap = gaps[table.cellOf(points_.normals[k])];
            if (!std::isfinite(gap)) {
                rest.push_back(k);
                continue;
            }
            std::array<double, valuesOfPoint> values;
            table.interpolate(points_.normals[k], values);
            // Polynomials swing below 0 beside a highlight, by less than they are off.
            for (double& value : values)
                if (value < 0 && value >= -gap) value = 0;
            facts_[k] = {.radiance = {values[0], values[1], values[2]},
                         .error = std::abs(values[3]) + gap};
            keep(k, tolerance);
        }
        open = std::move(rest);
    }
}

/// Radiance and its error at the vertices; nothing where the viewer is below, where a bound ended
/// the integral, or the time is over.
void PointIntegrals::fill(NormalTable& table, double tolerance, Steps& steps,
                          const GoesOn& goesOn) {
    table.fill(valuesOfPoint, [&](const Frame& frame, double* values) {
        std::fill_n(values, valuesOfPoint, nothing);
        steps.done();
        if (dot(frame.normal, view_.towards) < lowestViewer || !goesOn()) return;
        const PointRadiance found = integral(frame.normal, view_.towards, tolerance);
        evaluations_ += found.evaluations;
        if (found.cut || found.notFinite > 0) return;
        std::ranges::copy(found.radiance, values);
        values[3] = found.error;
    });
}

/// Integrates the point in the middle of each cell. Returns how far interpolation is off there,
/// summed over R, G and B, and infinity for cells that do not serve.
std::vector<double> PointIntegrals::gapsOf(const NormalTable& table,
                                           const std::vector<std::size_t>& open, double tolerance,
                                           Steps& steps, const GoesOn& goesOn) {
    const std::span<const std::size_t> middles = table.middles();
    std::vector<double> gaps(middles.size(), notReached);
    tbb::parallel_for(std::size_t{0}, middles.size(), [&](std::size_t cell) {
        steps.done();
        const std::size_t k = open[middles[cell]];
        std::array<double, valuesOfPoint> nearly;
        table.interpolate(points_.normals[k], nearly);
        if (!std::isfinite(nearly[0]) || !goesOn()) return;
        integrate(k, tolerance);
        gaps[cell] = 0;
        for (std::size_t c = 0; c < 3; ++c)
            gaps[cell] += std::abs(nearly[c] - facts_[k].radiance[c]);
    });
    double floor = 0, count = 0;
    for (std::size_t cell = 0; cell < gaps.size(); ++cell) {
        if (!std::isfinite(gaps[cell])) continue;
        floor += darkest * absoluteSum(facts_[open[middles[cell]]].radiance);
        ++count;
    }
    for (std::size_t cell = 0; cell < gaps.size(); ++cell) {
        const double there = absoluteSum(facts_[open[middles[cell]]].radiance);
        if (gaps[cell] > interpolationShare * tolerance * std::max(there, floor / count))
            gaps[cell] = notReached;
    }
    std::vector<double> serving = gaps;
    for (std::size_t cell = 0; cell < gaps.size(); ++cell) {
        for (const std::size_t beside : table.cellsAround(points_.normals[open[middles[cell]]]))
            serving[cell] = std::max(serving[cell], gaps[beside]);
    }
    return serving;
}

}  // namespace hshfit::inline rendering
