#pragma once

#include <brdfs/measured/rgl.h>
#include <brdfs/measured/rgl_tables.h>
#include <hshfit/brdf/brdf.h>

#include <cstddef>
#include <vector>

namespace hshfit::brdfs {

/// Where the writer takes a BRDF's distribution of normals D from.
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

/// D as above, mixed with a Lambertian one, 1 / pi, of weight `floor`, so that no normal is
/// without.
///
/// From retro-reflection (Dupuy, Heitz, Iehl, Poulin & Ostromoukhov 2015, "Extracting
/// Microfacet-based BRDF Parameters from Arbitrary Materials with Power Iterations", EGSR): with
/// Fresnel's factor constant, D(w) = 4 f(w, w) cos(theta) sigma(w) up to a factor, and sigma is an
/// integral over D: D is the first eigenvector, found by power iteration. Averaged:
/// D(h) = 4 f cos(theta_i) cos(theta_o), mean over difference angles above the horizon.
///
/// f is the luminance of RGB, the mean of wavelengths. Returns an empty plane where f gives no D (f
/// is 0 wherever it is sampled).
Plane estimateNormals(const Brdf& brdf, NormalsFrom from, NormalsGrid grid, double floor);

/// sigma(w), the integral of D(h) max(0, h . w) over the hemisphere, on a grid over (u, v) of w.
Plane projectedAreas(const Plane& ndf, std::size_t rows, std::size_t columns);

/// Densities over (u, v) of the normals seen from wi, D(h) max(0, h . wi) times the Jacobian. Of
/// them, `share` is spread evenly over the part of the square that is seen: normals that D knows
/// little of get their colours too, and the colours are smooth where the Jacobian is 0. They sum to
/// 1. `turn` is added to the azimuths of the rows.
std::vector<float> visibleNormals(const Plane& ndf, const Direction& wi, double turn,
                                  NormalsGrid grid, double share);

/// Solid angle of normals per du dv.
double normalsJacobian(double u);

/// The weight by which renderers sample: luminance, or the mean of wavelengths.
double brightness(const Channels& channels, const double* values);

}  // namespace hshfit::brdfs
