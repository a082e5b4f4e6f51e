#pragma once

#include <hshfit/pictures/sphere.h>

#include <array>
#include <span>
#include <string>
#include <vector>

namespace hshfit::inline pictures {

/// Spheres of a source, of a BRDF in its place, and of their difference under one light.
struct PictureStrip {
    std::string light;                     ///< PictureLight::name
    double stops = 0;                      ///< the exposure of the source, for all three
    double times = 1;                      ///< the difference is shown so many times as bright
    std::array<SpherePicture, 3> spheres;  ///< the last is |difference| times `times`
};

/// Spheres of a BRDF under the lights of strips, which are two of the picture error's lights: one
/// that shows the highlight, and one with light from all around.
std::vector<SpherePicture> stripSpheres(const Brdf& brdf);

/// A strip for each light, from stripSpheres() of both.
std::vector<PictureStrip> pictureStrips(std::span<const SpherePicture> source,
                                        std::span<const SpherePicture> other);

/// A PNG file of a strip: its spheres side by side.
std::string pngOf(const PictureStrip& strip);
/// A PNG file of strips below one another, each at its own exposure.
std::string pngOf(std::span<const PictureStrip> strips);

}  // namespace hshfit::inline pictures
