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

/// What of `model` is free to fit, given the parameters that were stated: those of the table in
/// the source, for isotropic or anisotropic data, or for a model that has no row there every number
/// and colour that may be left to a default or has none. A row leaves out what only another choice
/// reads (an index of refraction where F0 is given) and what another parameter makes ambiguous.
/// Stated parameters are not free. In a sum of models, kd with a default of 0 stays 0.
std::vector<FreeParameter> freeParameters(const Model& model, const Parameters& stated,
                                          bool isotropic, bool inSum);

/// "key=value,…" parsed for what is stated only: keys and values are checked, absent ones are not
/// missed. Throws UsageError.
Parameters statedParameters(const Model& model, std::string_view text);

}  // namespace hshfit::brdfs
