#pragma once

#include <hshfit/sampling/sampler.h>

namespace hshfit::inline sampling {

/// The axis of a lobe, (x wo.x, y wo.y, z wo.z) normalised; the normal where that is 0.
struct LobeAxis {
    double x = -1, y = -1, z = 1;
};
inline constexpr LobeAxis mirrorAxis{-1, -1, 1}, normalAxis{0, 0, 1};

/// cos(theta_i) / pi, by the area-preserving map of a disc (Shirley & Chiu 1997). Exact for
/// Lambert's BRDF.
std::shared_ptr<const Sampler> cosineSampler();

/// (n + 1) / (2 pi) cos(alpha)^n about the axis, 0 behind it, folded at the horizon; n >= 0.
/// Exact, up to cos(theta_i), for Phong's and Lafortune's lobes, and for Minnaert's BRDF about the
/// normal. Versines keep the digits of exponents of 1e6.
std::shared_ptr<const Sampler> powerCosineSampler(LobeAxis axis, double exponent);

/// lambda / (2 pi (1 - exp(-2 lambda))) exp(lambda (cos(alpha) - 1)), a von Mises-Fisher density
/// about the axis, folded at the horizon; lambda >= 0.
std::shared_ptr<const Sampler> gaussianLobeSampler(LobeAxis axis, double sharpness);

}  // namespace hshfit::inline sampling
