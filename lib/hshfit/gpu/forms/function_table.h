#pragma once

#include <hshfit/gpu/texels.h>
#include <hshfit/representation/halfway/halfway.h>

#include <cstddef>
#include <vector>

namespace hshfit::gpu::inline forms {

/// The number of nodes along the axes of a table, each at least 2.
struct TableSize {
    std::size_t half = 0, plane = 0, horizon = 0;

    std::size_t nodes() const { return half * plane * horizon; }
};

/// The place of a pair on the axes of a table, each from 0 to 1. With theta_h between the half
/// vector h and the normal n, rho the length of wo in the plane of both, m the lesser cosine, and x
/// as in halfway_axes.h:
///     half     0.7 x^0.45 + 0.3 (1 - cos(theta_h)^(1/3))
///     plane    0.35 rho^3 + 0.65 rho^(1/3)
///     horizon  (1 - (m / (rho cos(theta_h)))^(1/4))^(1/2)
/// In the plane of h and n the projections of wi and wo are mirrored at h, so that the pairs fill
/// the cube: m = 0 is horizon = 1 everywhere. Functions of a pair that are isotropic, reciprocal
/// and mirror symmetric are functions of these three; along them the terms of the halfway form have
/// no bends sharper than elsewhere, neither at the horizon nor in the mirror direction. Shares and
/// exponents have the least errors over four libraries, of models and of measured tables.
struct TablePlace {
    static constexpr double halfBend = 0.3, planeBend = 0.65;
    /// They keep quotients finite; no function depends on kappa where the second counts.
    static constexpr double leastSquare = 1e-20, leastSine2 = 1e-12;

    double half, plane, horizon;
};
TablePlace tablePlace(const HalfwayAxes& axes, const Direction& wi, const Direction& wo);

/// The sums of all terms of a halfway form at a point, smooth and of the lobe together: one a
/// channel.
std::vector<double> sumsAt(const HalfwayExpansion& expansion, const HalfwayPoint& point);

/// Sums of the terms of a halfway form, smooth and of the lobe together, at the nodes of a grid, in
/// float16: layer g has the sums 4 g .. 4 g + 3, as many rows as nodes along `plane`, one group of
/// rows after another for the nodes along `horizon`, and texels along `half`. A number is less than
/// the sum at its node by a sixteenth of the second difference along each axis, which halves the
/// largest error of linear interpolation.
class FunctionTable {
public:
    /// Each channel of the form, which is isotropic, reciprocal and bilateral, is a sum.
    FunctionTable(const Representation& functions, const TableSize& size);

    const TableSize& size() const { return size_; }
    const Texels& texels() const { return texels_; }
    const HalfwayAxes& axes() const { return axes_; }
    std::size_t groups() const { return texels_.layers; }

    /// The weights of linear interpolation along `half` and `plane`: as they are, or in steps of
    /// 1/256, as GPUs filter textures. Weights along `horizon` are the shader's own.
    enum class Weights { exact, filtered };
    /// Writes 4 groups() sums; the ones beyond the channels are 0.
    void evaluate(const Direction& wi, const Direction& wo, Weights weights, double* out) const;

private:
    TableSize size_;
    HalfwayAxes axes_;
    Texels texels_;
    std::vector<float> values_;  ///< of the texels
};

}  // namespace hshfit::gpu::inline forms
