#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/pictures/sphere_albedo.h>

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace hshfit::inline pictures {

/// A light far away. `towards` is in the frame of the picture: x to the right, y up, z to the
/// viewer. A white Lambert surface that faces the light has radiance `strength`: the irradiance
/// across the beam is pi * strength.
struct SphereLight {
    Direction towards;
    double strength = 1;
};

/// The lights of the sphere pictures.
struct SphereRig {
    /// The key light from the upper left at 45 degrees to the line of sight, which shows highlights
    /// in front; the fill light from the lower right at 75 degrees, which shows grazing ones.
    std::vector<SphereLight> lights = {{directionFromAngles(pi / 4, 3 * pi / 4), 1},
                                       {directionFromAngles(75 * pi / 180, -pi / 6), 0.25}};
    /// Uniform radiance from all directions, so that the albedo is visible in the shadows too.
    double dome = 0.1;
};

struct SphereOptions {
    SphereRig rig = {};
    int size = 256;   ///< pixels along an edge of the square picture
    int samples = 3;  ///< 3 x 3 a pixel, so that edges and highlights have no steps
    /// More samples in the nine pixels about the mirror image of a light whose isotropic highlight
    /// is narrower than their distance, by Brdf::lobes. Pictures that are compared go without: the
    /// two of a pair need not know their lobes alike.
    bool sharpened = false;
    std::function<void(std::size_t, std::size_t)> progress = {};
};

/// Radiance of a sphere, linear Rec. 709, row 0 at the top.
struct SpherePicture {
    int size = 0;
    std::vector<float> radiance;  ///< [row][column][R, G, B], the mean over the covered samples
    std::vector<float> coverage;  ///< [row][column], the share of samples on the sphere
    std::string colours;          ///< the conversion of channels to R, G and B
    std::size_t notFinite = 0;    ///< values of f that were left out
    /// [row][column], the relative error of a pixel; empty where it is not known.
    std::vector<float> error = {};
};

/// The sphere's radius in half edges of the picture.
constexpr double sphereRadius = 0.96;

/// A unit sphere of the material, seen along parallel lines:
///     L = sum over lights of pi strength f(wi, wo) max(0, wi.n) + dome * albedo(wo)
/// at the normal n = (x, y, sqrt(1 - x^2 - y^2)) with x = (2 (column + 1/2) / size - 1) /
/// sphereRadius, y likewise and up. The tangent is horizontal, along (n.z, 0, -n.x), and the
/// bitangent n x t points up: brushed materials are brushed along the parallels. Spectra become RGB
/// as in colour.h; spectra with too few wavelengths become the mean over channels, as grey.
/// Values below 0 are kept. The picture does not depend on the number of threads.
SpherePicture renderSphere(const Brdf& brdf, const AlbedoTable& albedo,
                           const SphereOptions& options = {});
SpherePicture renderSphere(const Brdf& brdf, const SphereOptions& options = {});

}  // namespace hshfit::inline pictures
