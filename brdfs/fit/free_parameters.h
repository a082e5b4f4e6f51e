#pragma once

#include <brdfs/catalog/tables.h>

#include <cmath>
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
    /// A colour that scales f, such as an albedo, in which f is not linear, and no free ks scales
    /// the same lobe: coloured data give it a value for each channel.
    bool albedo = false;
    double period = 0;  ///< values that differ by it have the same f; 0: none do

    /// The value of the same f in [0, period).
    double reduced(double value) const {
        return period > 0 ? value - period * std::floor(value / period) : value;
    }
};

/// The parameters of `model` that are free to fit, given those that are stated: the ones whose row
/// has a FitRange that applies. Stated parameters are not free. In a sum of models, kd and Rd with
/// a default of 0 stay 0.
std::vector<FreeParameter> freeParameters(const Model& model, const Parameters& stated,
                                          bool isotropic, bool inSum);

/// The stated parameters, and the others that their FitRange holds at one value.
Parameters withHeldParameters(const Model& model, Parameters stated, bool isotropic);

/// All parameters: those not stated have their defaults, or without a default their least value.
Parameters withDefaults(const Model& model, const Parameters& stated);

}  // namespace hshfit::brdfs
