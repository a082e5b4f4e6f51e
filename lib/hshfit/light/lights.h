#pragma once

#include <hshfit/brdf/directions.h>
#include <hshfit/coefficients/light_coefficients.h>
#include <hshfit/rotation/rotation.h>

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace hshfit::inline light {

/// Linear Rec. 709.
using Rgb = std::array<double, 3>;

/// The mean of the three components.
inline double meanOf(const Rgb& rgb) {
    return (rgb[0] + rgb[1] + rgb[2]) / 3;
}

/// The luminance of linear Rec. 709 (ITU-R BT.709-6, 3.2).
inline double luminanceOf(const Rgb& rgb) {
    return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
}

/// A round light of uniform radiance, `radius` radians from its centre to its rim.
struct DiscLight {
    Direction towards;
    double radius = 0;
    Rgb radiance{};
};

/// A flat panel of uniform radiance that faces the surface: `width` (along azimuth) and `height`
/// (along elevation) are the angles, in radians, under which its axes are seen; then turned about
/// its centre by `turn`.
struct PanelLight {
    Direction towards;
    double width = 0, height = 0, turn = 0;
    Rgb radiance{};
};

/// The shape of a sky by two angles, theta from the zenith and chi from the sun:
///     F = (1 + a exp(b / cos theta)) (1 + c (exp(d chi) - offset) + e cos^2 chi)
/// offset is exp(d pi / 2) in the CIE general sky and 0 in the formula of Perez et al. 1993.
struct SkyShape {
    double a = 0, b = -1, c = 0, d = -1, e = 0, offset = 0;
};

struct HosekWilkieTerm;

/// The half space above the world's horizon, and a uniform ground below it.
/// uniform   L = zenith
/// overcast  L = zenith (1 + 2 cos theta) / 3   (Moon & Spencer 1942; CIE standard overcast sky)
/// cie       L = zenith F / F(zenith), F of shapes[0]   (ISO 15469:2004; sky.h)
/// hosekWilkie  L = zenith times the colour of the sum of `terms` (internal/hosek_wilkie_sky.h)
/// preetham  L = zenith times the colour of the chromaticity (x, y) and the luminance Y, each its
///           value at the zenith times F / F(zenith) by shapes[0], [1], [2] of Y, x, y; Y is 1 at
///           the zenith. Components of colours beyond the gamut count as 0.
struct SkyLight {
    enum class Model { uniform, overcast, cie, preetham, hosekWilkie };
    Model model = Model::uniform;
    Rgb zenith{}, ground{};
    Direction sun{};
    std::array<SkyShape, 3> shapes{};
    std::array<double, 2> chromaticity{};  ///< x and y at the zenith
    std::shared_ptr<const std::vector<HosekWilkieTerm>> terms = {};

    /// Whether the radiance rises to a peak with a kink at the sun.
    bool peaked() const { return model != Model::uniform && model != Model::overcast; }
};

/// The place of directions in a picture (picture_layout.h).
enum class PictureLayout { latlong, angular, mirrorBall, cross, faces, dome, equalArea };

/// The code of a picture's values, which decodes to linear ones (picture_reader.h).
enum class TransferCurve { linear, srgb, rec709, gamma18, gamma22, gamma24 };

/// Pixels of a picture that are no radiance, each counted once.
struct PictureCensus {
    std::size_t negative = 0, notANumber = 0, infinite = 0;
    std::size_t total() const { return negative + notANumber + infinite; }
};

/// A pixel of a file in place of one that is no radiance; not scaled.
struct FilledPixel {
    std::size_t row = 0, column = 0;
    std::array<float, 3> rgb{};
};

/// A picture of radiance, constant within a pixel. In a latitude-longitude picture, row 0 is around
/// the zenith, and the azimuth is pi at the left edge, 0 in the middle, -pi at the right edge, plus
/// `turn`.
struct PictureLight {
    std::string file;
    std::size_t width = 0, height = 0;
    std::vector<float> rgb;  ///< [row][column][R, G, B], scaled
    double turn = 0;         ///< radians about +z
    PictureLayout layout = PictureLayout::latlong;
    /// For `forEachRow`, which reads a larger file again: the size of the file, 0 where `rgb` is
    /// all of it, and the way from the file's values to radiance.
    std::size_t fileWidth = 0, fileHeight = 0;
    TransferCurve curve = TransferCurve::linear;
    std::string part = {}, layer = {};  ///< of the file, as asked for
    bool clamped = false;               ///< pixels that are no radiance are clamped
    double scale = 1;
    PictureCensus census = {};  ///< of pixels that are no radiance in the file
    /// In the picture's frame left and right are exchanged first, then it is tilted, then turned.
    bool mirrored = false;
    Rotation tilt = {};
    /// The layout as specifications name it: a dome of rows is held as a latlong picture.
    PictureLayout fileLayout = PictureLayout::latlong;
    std::shared_ptr<const std::vector<FilledPixel>> filled =
        {};                   ///< by row and column; may be null
    std::string remark = {};  ///< a fault of the file that does not stop its use
};

/// Light from one direction alone. Its radiance is infinite there and 0 elsewhere; `irradiance` is
/// measured on a surface across the beam.
struct DirectionalLight {
    Direction towards;
    Rgb irradiance{};
};

/// Radiance by coefficients: the sum of the series on the whole sphere, or on a hemisphere and 0
/// beside it. It rings, and may be below 0 (coefficient_light.h).
struct CoefficientLight {
    std::string file;
    std::shared_ptr<const LightCoefficients> coefficients;
    std::shared_ptr<const Basis> basis;    ///< of the coefficients
    Direction tangent, bitangent, normal;  ///< the axes of the coefficients in the world
    double scale = 1;
};

/// A light of any kind; several shine as their sum.
using Light =
    std::variant<DiscLight, PanelLight, SkyLight, PictureLight, DirectionalLight, CoefficientLight>;

}  // namespace hshfit::inline light
