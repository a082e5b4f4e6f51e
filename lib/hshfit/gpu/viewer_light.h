#pragma once

#include <hshfit/coefficients/light_coefficients.h>
#include <hshfit/light/catalog.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::gpu {

/// A light as a page carries it: a latitude-longitude picture of mean radiances, and coefficients.
struct ViewerLight {
    std::string name;  ///< the specification, without the folders of its files
    int width = 0, height = 0;
    /// [row][column]: R, G, B and an exponent, radiance = value 2^(exponent - 136); steps of at
    /// most 1/128 of the largest of the three. Row 0 is the zenith; columns as PictureLight has.
    std::vector<std::uint8_t> rgbe;
    /// SH over the sphere, of the light itself and not of the picture.
    LightCoefficients coefficients;
    double captured = 0;  ///< share of the energy within the order; NaN for light from points
    /// Root mean square of the difference of the picture's own coefficients, relative.
    double pictureError = 0;
};

/// `light` in `order` bands and a picture of 2 `height` x `height` pixels. Discs, panels and light
/// from one direction keep their flux, which falls into the nearest pixels. Throws as projectLight
/// does.
ViewerLight viewerLight(const LightSpecification& light, int order, int height = 128);

/// Functions of JavaScript on coefficients of spherical harmonics, among them
/// rotated(order, matrix, coefficients), with coefficients as [slot][R, G, B].
std::string_view harmonicsScript();

/// Radiance [row][column][R, G, B] from ViewerLight::rgbe.
std::vector<float> decodeRgbe(const std::vector<std::uint8_t>& rgbe);

/// The name in a specification for readers: a path loses its folders, its extension and its
/// parameters; other text stays as it is.
std::string shownName(const std::string& specification);

}  // namespace hshfit::gpu
