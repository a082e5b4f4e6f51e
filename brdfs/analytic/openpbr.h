#pragma once

#include <brdfs/rows/model.h>

namespace hshfit::brdfs {

/// The reflecting part of OpenPBR Surface 1.1 (Academy Software Foundation), with the layering of
/// its reference graph in MaterialX 1.39, under its names and defaults. E: directional albedos.
///     f = fuzz + (1 - fuzz_weight E_z(cos_o)) (coat + (1 - coat_weight E_c(cos_o)) tint under)
///     tint = mix(1, coat_color, coat_weight) mix(1, (1 - K)/(1 - K E_b), share),
///     share = coat_weight coat_darkening,  K = 1 - (1 - F0(coat_ior))/coat_ior^2,
///     E_b = base_color mix(1, specular_weight, metalness)
///     under = mix(specular_color S F(eta) + (1 - E_s(cos_o)) D, specular_weight S M, metalness)
/// D: eon of base_weight base_color. S: ggx with ax = r^2 sqrt(2/(1 + (1 - a)^2)), ay = (1 - a) ax,
/// heights correlated, r roughened by the coat, x turned by geometry_tangent (an angle in place of
/// the vectors geometry_tangent and geometry_coat_tangent). F: exact, of specular_ior (by coat_ior
/// under a coat), scaled by specular_weight at normal incidence. M: Schlick's form that
/// specular_color bends at 82 degrees. Fuzz: Zeltner, Burley & Chiang 2022, by MaterialX's rational
/// fits.
///
/// Approximations: layers by albedo scaling with cos_o alone, hence not reciprocal; absorption in
/// the coat does not depend on the angle; E_s and E_c are of sqrt(ax ay), to 1e-3; no light that
/// facets scatter twice; alpha is at least 1e-4. The specification leaves the film's formula open
/// (it names Belcour & Barla 2017): here it is glTF's. MaterialX 1.39 has the boundaries of each
/// polarisation, halves the reflectance of a metal's, and turns the whole sum by its matrix. E_s
/// is that without the film, as in MaterialX, and the film's metal has no bend. Without
/// transmission, subsurface, emission.
const Model& openpbrModel();

}  // namespace hshfit::brdfs
