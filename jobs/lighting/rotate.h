#pragma once

#include <jobs/common/option_row.h>

#include <hshfit/coefficients/coefficients.h>
#include <hshfit/coefficients/light_coefficients.h>
#include <hshfit/rotation/hemisphere_rotation.h>
#include <hshfit/rotation/rotation.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::jobs {

/// Angles in degrees, R_z(a) R_y(b) R_z(c).
struct EulerAngles {
    double a = 0, b = 0, c = 0;

    Rotation rotation() const { return Rotation::euler(radians(a), radians(b), radians(c)); }
};

struct RotateOptions {
    std::optional<Rotation> rotation = {};  ///< to be given
    /// Light on the whole sphere has `exact` alone.
    HemisphereRotationOptions way = {};
};
OptionRows<RotateOptions> rotateOptions();

struct Rotated {
    std::string kind;  ///< "brdf" or "light"
    std::string basis, domain;
    int order = 0;
    HemisphereMethod method = HemisphereMethod::exact;
    double lostEnergy = 0, error = 0;  ///< HemisphereRotated
    int bands = 0;                     ///< of the way through SH
};

/// Rotates a coefficient file of a BRDF (plain, JSON or EXR) or of light (JSON) to another.
///
/// BRDF: for each outgoing direction its function over wi rotates, wo stays. A set of elevations
/// rotates in the frame in which wo is at azimuth 0 and stays isotropic; other sets do not, none
/// stays reciprocal, and bilateral only those that turn about y.
/// Light: on the whole sphere every direction moves; on a hemisphere it is rotated about the axes
/// of that hemisphere's frame, whose normal stays. The energy that the file states becomes the
/// energy of the part that stays. Throws UsageError for a way that the basis does not have,
/// InputError and OutputError.
Rotated rotate(const std::string& input, const std::string& output, const RotateOptions& options);

/// Rotates coefficients at hand in place; `name` is the light in messages.
Rotated rotate(Coefficients& coefficients, const RotateOptions& options);
Rotated rotate(LightCoefficients& light, const RotateOptions& options, const std::string& name);

struct MatrixOptions {
    std::string from, to;  ///< bases
    int order = 3;         ///< of `to`
    int fromOrder = 0;     ///< 0: as `order`
    std::optional<Rotation> rotation = {};
    std::optional<EulerAngles> euler = {};  ///< the rotation, if there is none above
    /// Both bases with the Condon-Shortley sign, as in the source papers.
    bool condonShortley = false;
    /// Weight of the integral of a change of basis; none: the inner product of TO.
    std::optional<Basis::Inner> weight = {};

    int orderOfFrom() const { return fromOrder > 0 ? fromOrder : order; }
};
/// Without the rotation as such.
OptionRows<MatrixOptions> matrixOptions();

/// "solid-angle" or "cosine".
std::string_view weightName(Basis::Inner weight);

/// Rows TO, columns FROM: the change of basis or, with a rotation, from the coefficients of a
/// function to the coefficients of the rotated function. A rotation of different bases needs SH as
/// one of them, which rotates. At most 2^22 entries. Throws UsageError.
std::vector<std::vector<double>> matrix(const MatrixOptions& options);

}  // namespace hshfit::jobs
