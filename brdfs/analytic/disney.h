#pragma once

#include <brdfs/rows/model.h>

namespace hshfit::brdfs {

/// The "principled" BRDF: Burley 2012, "Physically-based shading at Disney", SIGGRAPH course notes,
/// with the addenda of 2014; s(x) = (1 - x)^5, d = half angle to wi, F = s(cos d), base: baseColor.
///     f = (1 - metallic) (mix(diffuse, flat, subsurface) base/pi + sheen F mix(1, tint,
///     sheenTint))
///         + mix(C0, 1, F) Ds Gs/4 + clearcoat/4 mix(0.04, 1, F) Dc Gc/4
///     diffuse = mix(1, f90, s(cos_i)) mix(1, f90, s(cos_o)),  f90 = 1/2 + 2 roughness cos^2 d
///     flat = 1.25 (ss (1/(cos_i + cos_o) - 1/2) + 1/2), ss as diffuse with f90 = roughness cos^2 d
///     C0 = mix(0.08 specular mix(1, tint, specularTint), base, metallic)
///     tint = base/luminance,  luminance = 0.3 R + 0.6 G + 0.1 B
///     Ds: GGX with ax, ay = max(0.001, roughness^2/a), max(0.001, roughness^2 a),
///         a^2 = 1 - 0.9 anisotropic
///     Dc: gtr with gamma 1, alpha = mix(0.1, 0.001, clearcoatGloss); Gc: Smith GGX of alpha 0.25
///     Gs: separable Smith, with ax and ay (2014), or of alpha (1/2 + roughness/2)^2 (2012);
///         G here includes 1/(cos_i cos_o)
/// baseColor is linear (the BRDF Explorer's is a monitor value, to the power of 2.2). The sum
/// of the lobes may have an albedo above 1; flat is unbounded where both directions graze. The
/// transmission, thin surface and diffusion of Burley's 2015 BSDF are left out.
const Model& disneyModel();

}  // namespace hshfit::brdfs
