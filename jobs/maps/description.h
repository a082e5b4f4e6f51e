#pragma once

#include <hshfit/light/picture_layout.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::jobs {

/// The values of a parameter from texel to texel, taken from a picture.
struct MapReference {
    std::string path;
    /// One, or three for a colour; empty: R, G, B of a colour, else the first.
    std::vector<std::string> channels = {};
    TransferCurve curve = TransferCurve::linear;
    /// value = offset + scale * decoded^power
    double scale = 1, offset = 0, power = 1;
};

/// A parameter of the model: a map, or one or three constant values.
struct DescribedParameter {
    std::string name;
    std::vector<double> values = {};
    MapReference map = {};  ///< without a path: constant
};

/// The code of the components of a vector: v of 0 to 1 stand for 2 v - 1; automatic: such
/// codes in whole numbers, else the values themselves.
enum class VectorCodes { automatic, unsignedCodes, signedValues };

/// A map of normals in the frame of the surface: x to the right, y up, z towards the viewer.
struct NormalReference {
    std::string path = {};
    std::vector<std::string> channels = {};  ///< three, or two: z follows from them
    VectorCodes codes = VectorCodes::automatic;
    bool yDown = false;        ///< as DirectX has it
    double scale = 1;          ///< of x and y
    bool renormalise = false;  ///< lengths other than 1, which are refused otherwise
};

enum class DirectionUnit { degrees, turns, radians, vector };
/// The direction that the model calls x, as an angle from the surface's x towards its y.
struct DirectionReference {
    double degrees = 0;     ///< where it is one for all texels
    std::string path = {};  ///< else
    std::vector<std::string> channels = {};
    DirectionUnit unit = DirectionUnit::degrees;
    VectorCodes codes = VectorCodes::automatic;
    double scale = 1, offset = 0;  ///< angle = offset + scale * value
    bool yDown = false;
};

/// Materials of one model with parameters from texel to texel.
struct MaterialDescription {
    std::string file, model;
    std::map<std::string, std::string> words = {};  ///< choices
    std::vector<DescribedParameter> parameters = {};
    std::optional<NormalReference> normal = {};
    std::optional<DirectionReference> direction = {};
    /// A file of measured texels (docs/explanation/svbrdf.md) in place of a model.
    std::string texels = {};
    bool isotropic = false;  ///< of measured texels
};

/// Reads {"format": "hshfit-svbrdf", "version": 1, "model": …, "parameters": {…}}
/// (docs/explanation/svbrdf.md), with "normal" and "direction" if need be, or with "texels" in
/// place of all of these. Paths of maps are relative to the file. Parameters are checked against
/// the model by name and kind; maps are not opened. Throws InputError that starts with `file` and
/// names the field.
MaterialDescription readMaterialDescription(const std::string& file);

}  // namespace hshfit::jobs
