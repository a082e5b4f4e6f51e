#pragma once

#include <hshfit/light/picture_layout.h>

#include <map>
#include <string>
#include <vector>

namespace hshfit::jobs {

/// The values of a parameter from texel to texel: those of a picture.
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

/// Materials of one model with parameters from texel to texel.
struct MaterialDescription {
    std::string file, model;
    std::map<std::string, std::string> words = {};  ///< choices
    std::vector<DescribedParameter> parameters = {};
};

/// Reads {"format": "hshfit-svbrdf", "version": 1, "model": …, "parameters": {…}} (docs/svbrdf.md).
/// Paths of maps are relative to the file. Parameters are checked against the model by name and
/// kind; maps are not opened. Throws InputError that starts with `file` and names the field.
MaterialDescription readMaterialDescription(const std::string& file);

}  // namespace hshfit::jobs
