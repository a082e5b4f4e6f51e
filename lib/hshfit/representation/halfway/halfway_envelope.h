#pragma once

#include <hshfit/brdf/directions.h>
#include <hshfit/representation/content.h>

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace hshfit::inline representation::inline halfway {

/// The place of two elevations on the axes of the envelope. With d = |theta_o - theta_i|:
///     a = (1 - cos d)^(1/2), negative where wo is the lower one
///     b = min(cos theta_i, cos theta_o)^(1/4)
/// Lobes about the mirror direction have their ridge at a = 0; powers of the cosine towards the
/// horizon are nearly straight lines of the logarithm over b. No angle is formed. Pairs above the
/// horizon have a^2 + b^4 <= 1.
struct EnvelopePoint {
    double a, b;
};
EnvelopePoint envelopePoint(const Direction& wi, const Direction& wo);

/// The greatest f of the halfway form at two elevations, per channel: ln E is kept at the nodes of
/// a grid, bilinear between them, so that E is nowhere above its greatest node. The array is
/// [node along b][node along x][channel]. With the width r of the ridge,
///     x = a (1 + r) / (|a| + r),
/// nodes divide b in [0, 1] evenly, and x in [0, 1] where the form is reciprocal, in [-1, 1]
/// elsewhere; one node along an axis: constant.
class HalfwayEnvelope {
public:
    HalfwayEnvelope() = default;  ///< bounds nothing: files without the array
    /// Throws InputError that starts with `where` if the shape is no such grid or `ridge` not above
    /// 0.
    HalfwayEnvelope(const EnvelopeArray& array, std::size_t channels, bool reciprocal,
                    const std::string& where);

    bool empty() const { return logs_.empty(); }
    std::size_t nodesAlongA() const { return alongA_; }
    std::size_t nodesAlongB() const { return alongB_; }
    bool reciprocal() const { return reciprocal_; }
    double ridge() const { return ridge_; }
    const std::vector<double>& logs() const { return logs_; }  ///< [b][a][channel]

    /// Up to four nodes and their weights.
    struct Mix {
        std::array<std::size_t, 4> node;
        std::array<double, 4> weight;
    };
    Mix mixAt(const EnvelopePoint& point) const;
    /// ln E of a channel.
    double logAt(const Mix& mix, std::size_t channel) const;

private:
    std::size_t alongA_ = 1, alongB_ = 1, channels_ = 0;
    double ridge_ = 1;
    bool reciprocal_ = true;
    std::vector<double> logs_;
};

}  // namespace hshfit::inline representation::inline halfway
