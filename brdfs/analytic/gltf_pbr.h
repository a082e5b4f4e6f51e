#pragma once

#include <brdfs/rows/model.h>

namespace hshfit::brdfs {

/// The material of glTF 2.0 (Khronos, specification 2.0.1, appendix B) and its ratified
/// KHR_materials_{ior, specular, sheen, clearcoat, anisotropy, iridescence}, under glTF's names and
/// defaults.
/// w = (1 - wo.h)^5, S = D G/(4 cos_i cos_o) as ggx with masking=correlated, alpha = roughness^2:
///     base = metallic (c + (1 - c) w) S + (1 - metallic) (layer + specular (F0 + (1 - F0) w) S)
///     layer = (1 - specular max_c(F0 + (1 - F0) w)) c/pi,  c: baseColorFactor
///     F0 = min(1, ((ior - 1)/(ior + 1))^2 specularColor)
///     sheened = (1 - max_c(sheenColor) max(E_i, E_o)) base + sheenColor C
///     f = (1 - k) sheened + k S',  k = clearcoat (0.04 + 0.96 (1 - cos_o)^5)
/// C: charlie of r = sheenRoughness^2, E its albedo (sheen_albedo.h); S': S of clearcoatRoughness.
/// Anisotropy widens alpha along its direction to 1 + (alpha - 1)(1 - strength^2); the rotation
/// turns it from the tangent towards the bitangent, in radians.
///
/// Iridescence: with i = iridescenceFactor, the reflectances c + (1 - c) w of the metal and
/// specular (F0 + (1 - F0) w) of the dielectric, in the layer too, are mixed by i with R of
/// thin_film.h, for f0 = c and f0 = specular F0, at wo.h. The viewers of thin_film.h take R at the
/// normal instead; the thickness is the extension's maximum, which it has without a texture.
///
/// G is of correlated heights, as in the Khronos Sample Viewer (V_GGX), three.js
/// (V_GGX_SmithCorrelated) and Babylon.js (smithVisibility_GGXCorrelated); appendix B prints the
/// product of both directions' masking, which is darker towards grazing angles.
///
/// Not reciprocal with a clearcoat. The albedo of a dielectric may exceed 1 towards grazing. alpha
/// is at least 1e-4 and sheenRoughness acts as at least 0.1. ior = 0, which glTF allows, is not
/// accepted. Without transmission, volume and dispersion.
const Model& gltfPbrModel();

}  // namespace hshfit::brdfs
