#include <hshfit/rendering/internal/smooth_light_nodes.h>

#include <hshfit/brdf/steps.h>
#include <hshfit/brdf/vectors.h>
#include <hshfit/light/coefficient_light.h>
#include <hshfit/quadrature/ring_points.h>
#include <hshfit/rendering/internal/even_light.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline rendering {

SmoothLightNodes::SmoothLightNodes(const Light& light, const Frame& frame, const Brdf& brdf,
                                   const Direction& wo)
    : disc_(std::get_if<DiscLight>(&light)),
      series_(std::get_if<CoefficientLight>(&light)),
      frame_(frame),
      wo_(wo),
      lobes_(brdf.lobes(wo)),
      kinks_(brdf.kinks(wo)),
      curves_(kinkCurvesOf(brdf, wo)),
      squareLevels_(evenRadianceOf(light) ? squareLevelsOf(brdf) : 0) {
    const bool half =
        series_ && series_->coefficients->domain == LightCoefficients::Domain::hemisphere;
    if (half || (disc_ && !evenRadianceOf(light))) {
        edge_ = {frame.toLocal(half ? series_->normal : disc_->towards),
                 half ? 0 : std::cos(disc_->radius)};
        curves_.push_back(circleAbout(edge_->axis, edge_->cosine));
    }
}

int SmoothLightNodes::firstLevel(double tolerance) const {
    constexpr double wide = 0.02;
    if (squareLevels_ > 0) return 0;
    return tolerance >= wide ? -2 : -1;
}

LightSamples SmoothLightNodes::samples(int level) const {
    constexpr int squareLevels = 7;
    if (squareLevels_ > 0) return squareSamples(std::min(squareLevels_, squareLevels) + level);
    // Exact products of the series and f are not needed: levels are compared.
    const int order = series_ ? (series_->coefficients->order + 1) / 2 : 1;
    const HemisphereGrid grid =
        gridFor(lobes_, wo_, {.order = order, .level = level, .squeezed = true}, kinks_, curves_);
    std::vector<Direction> local, world;
    std::vector<double> solidAngles;
    RingPoints points(grid);
    while (points.next()) {
        for (std::size_t j = 0; j < points.count(); ++j) {
            const Direction wi = points.direction(j);
            if (edge_ && dot(wi, edge_->axis) < edge_->cosine) continue;
            local.push_back(wi);
            if (series_) world.push_back(frame_.toWorld(wi));
            solidAngles.push_back(points.weight(j));
        }
    }
    const std::vector<Rgb> radiance =
        series_ ? radianceOf(*series_, world) : std::vector<Rgb>(local.size(), disc_->radiance);
    LightSamples samples;
    for (std::size_t k = 0; k < local.size(); ++k)
        samples.add(local[k], radiance[k], solidAngles[k]);
    return samples;
}

LightSamples SmoothLightNodes::squareSamples(int levels) const {
    const std::size_t side = std::size_t{1} << levels;
    const auto middle = [side](std::size_t k) {
        return (static_cast<double>(k) + 0.5) / static_cast<double>(side);
    };
    LightSamples samples;
    for (std::size_t a = 0; a < side; ++a) {
        for (std::size_t b = 0; b < side; ++b) {
            const Direction wi = directionFromSquare({middle(a), middle(b)});
            samples.add(wi, disc_->radiance, pi / static_cast<double>(side * side) / wi.z);
        }
    }
    return samples;
}

}  // namespace hshfit::inline rendering
