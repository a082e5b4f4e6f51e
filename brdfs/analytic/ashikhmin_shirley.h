#pragma once

#include <brdfs/rows/model.h>

namespace hshfit::brdfs {

/// Ashikhmin & Shirley 2000, 10.1080/10867651.2000.10487522: anisotropic Phong lobe with Fresnel's
/// reflectance, over a diffuse term that gives way to it at grazing angles.
///     specular  sqrt((nu + 1)(nv + 1)) / (8 pi) (h.z)^((nu h.x^2 + nv h.y^2) / (1 - h.z^2))
///               F / (h.wo max(cos_i, cos_o)),   F = Rs + (1 - Rs)(1 - h.wo)^5
///     diffuse   28 Rd / (23 pi) (1 - Rs) (1 - (1 - cos_i/2)^5) (1 - (1 - cos_o/2)^5)
/// Unlike the paper, this model scales the lobe by ks and adds kd / pi, because published fits
/// use a plain Lambert term. `ior` in place of Rs makes F the exact reflectance of a dielectric.
/// nu along x (the paper's u), nv along y. The model has no masking, so that the lobe is too bright
/// at grazing angles.
const Model& ashikhminShirleyModel();

}  // namespace hshfit::brdfs
