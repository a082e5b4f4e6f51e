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
};

/// What of `model` is free to fit, given the parameters that were stated: those whose table row has
/// a FitRange that applies. Stated parameters are not free. In a sum of models, kd with a default
/// of 0 stays 0.
std::vector<FreeParameter> freeParameters(const Model& model, const Parameters& stated,
                                          bool isotropic, bool inSum);

/// "key=value,…" of the parameters whose FitRange holds them, unless they are stated.
std::string heldParameters(const Model& model, const Parameters& stated, bool isotropic);

/// "key=value,…" parsed for what is stated only: keys and values are checked, absent ones are not
/// missed. Throws UsageError.
Parameters statedParameters(const Model& model, std::string_view text);

}  // namespace hshfit::brdfs
