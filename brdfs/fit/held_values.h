#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace hshfit::brdfs {

/// A parameter that a fit leaves as the specification of its model states it, or as its FitRange
/// holds it.
struct HeldValue {
    std::string name;             ///< as of FittedParameter: "kd", or "ggx.kd" in a sum
    std::vector<double> numbers;  ///< one, or three of a colour; empty: `word`
    std::string word;
    bool isDefault = false;  ///< the default of the model
    bool isStated = false;   ///< with the model
};

/// The held parameters of a model as it is given to fit, in the order of its terms and their
/// tables. A fit has been made of that model before.
std::vector<HeldValue> heldValues(std::string_view model, bool isotropic);

}  // namespace hshfit::brdfs
