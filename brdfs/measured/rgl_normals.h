#pragma once

#include <brdfs/measured/rgl.h>
#include <brdfs/measured/rgl_tables.h>
#include <hshfit/brdf/brdf.h>

#include <cstddef>
#include <vector>

namespace hshfit::brdfs {

/// The source of a BRDF's distribution of normals D in the writer.
enum class NormalsFrom {
    retroReflection,  ///< Dupuy & Jakob 2018: D from f(w, w)
    average,          ///< D from f at the half vector, averaged over difference angles
    uniform,          ///< none: the square is (u, v) itself
};

/// Densities at half vectors h, over u = sqrt(2 theta_h / pi) along columns and v = phi_h / 2 pi +
/// 1/2 along rows (two rows if isotropic), with the integral of D(h) cos(theta_h) equal to 1.
struct NormalsGrid {
    std::size_t rows = 2, columns = 128;
};

/// D as above, mixed with the Lambertian 1 / pi of weight `floor`, so that no normal has
/// density 0.
///
/// retroReflection follows Dupuy, Heitz, Iehl, Poulin & Ostromoukhov 2015, "Extracting
/// Microfacet-based BRDF Parameters from Arbitrary Materials with Power Iterations", EGSR. With
/// a constant Fresnel factor, D(w) = 4 f(w, w) cos(theta) sigma(w) up to a factor. sigma is an
/// integral over D, so that D is the first eigenvector, found by power iteration. average: D(h)
/// is the mean of 4 f cos(theta_i) cos(theta_o) over difference angles above the horizon.
///
/// f is the luminance of RGB or the mean of wavelengths. Returns an empty plane if f gives no D
/// (all its samples are 0).
Plane estimateNormals(const Brdf& brdf, NormalsFrom from, NormalsGrid grid, double floor);

/// sigma(w), the integral of D(h) max(0, h . w) over the hemisphere, on a grid over (u, v) of w.
Plane projectedAreas(const Plane& ndf, std::size_t rows, std::size_t columns);

/// Densities over (u, v) of the normals seen from wi, D(h) max(0, h . wi) times the Jacobian.
/// The share `share` of them is even over the visible part of the square: it gives normals of
/// low density colours too, and keeps colours smooth where the Jacobian is 0. They sum to 1.
/// `turn` is added to the azimuths of the rows.
std::vector<float> visibleNormals(const Plane& ndf, const Direction& wi, double turn,
                                  NormalsGrid grid, double share);

/// Solid angle of normals per du dv.
double normalsJacobian(double u);

/// The weight by which renderers sample: luminance, or the mean of wavelengths.
double brightness(const Channels& channels, const double* values);

}  // namespace hshfit::brdfs
