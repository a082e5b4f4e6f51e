#pragma once

#include <brdfs/catalog.h>

#include <string>
#include <string_view>
#include <vector>

namespace hshfit::brdfs {

/// A parameter that a fit may move. Several keys of a model may share it (ax = ay).
struct FreeParameter {
    std::vector<std::string> keys;
    double min = 0, max = 0;
    bool logarithmic = false;  ///< moves on a logarithmic scale
    double startLow = 0, startHigh = 0;
    bool colour = false;  ///< may have a value per channel
    bool linear = false;  ///< f is linear in it (Parameter::linear)
};

/// What of `model` is free to fit, given the parameters that are stated: those whose table row has
/// a FitRange that applies. Stated parameters are not free. In a sum of models, kd with a default
/// of 0 stays 0.
std::vector<FreeParameter> freeParameters(const Model& model, const Parameters& stated,
                                          bool isotropic, bool inSum);

/// What is stated, and the parameters besides whose FitRange holds them.
Parameters withHeldParameters(const Model& model, Parameters stated, bool isotropic);

/// All parameters, with defaults for what is not stated, and the least value where there is none.
Parameters withDefaults(const Model& model, const Parameters& stated);

}  // namespace hshfit::brdfs
