#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/brdf/kink_curve.h>
#include <hshfit/light/light_samples.h>

#include <optional>
#include <vector>

namespace hshfit::inline rendering {

/// Nodes for light that is smooth but for an edge: a disc, even light from all around, a series of
/// coefficients. Rings follow the lobes of f, however narrow, and end at the light's edge. For even
/// light and tables of cells on the square (steps.h) they are the middles of cells.
class SmoothLightNodes {
public:
    /// `light` is a disc or a series, and outlives this, as `frame` does.
    SmoothLightNodes(const Light& light, const Frame& frame, const Brdf& brdf, const Direction& wo);

    /// The level to begin with, which the next one is compared with.
    int firstLevel(double tolerance) const;
    /// Every level has 1.4 times as many nodes in both directions, twice as many for such tables.
    LightSamples samples(int level) const;

private:
    LightSamples squareSamples(int levels) const;

    struct Edge {
        Direction axis;
        double cosine;  ///< of the angle about it
    };

    const DiscLight* disc_;
    const CoefficientLight* series_;
    const Frame& frame_;
    Direction wo_;
    std::vector<Lobe> lobes_;
    std::vector<double> kinks_;
    std::vector<KinkCurve> curves_;
    int squareLevels_;
    std::optional<Edge> edge_;
};

}  // namespace hshfit::inline rendering
