#pragma once

#include <hshfit/brdf/brdf.h>

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::inline brdf {

/// A weighted mean of a BRDF's channels, as grey: sum of weights[c] f_c over the sum of the
/// weights. Equal weights: "grey:" and the BRDF's name; others: "grey=1/0/0:" and the name. Throws
/// UsageError unless there is one weight per channel, none below 0 and not all 0.
std::unique_ptr<Brdf> asGrey(std::unique_ptr<Brdf> brdf, std::vector<double> weights = {});

/// The prefix of a specification that asks for this: "grey:" or "grey=1/0/0:"; empty for any other.
std::string_view greyPrefix(std::string_view spec);
/// The weights of such a prefix, none for "grey:". Throws UsageError.
std::vector<double> greyWeights(std::string_view prefix);
/// The prefix for these weights.
std::string greyPrefixOf(const std::vector<double>& weights);

}  // namespace hshfit::inline brdf
