#pragma once

#include <string>
#include <string_view>

namespace hshfit::cli {

/// The share of a function that is 0, or whose energy does not exist.
inline constexpr std::string_view noCapturedEnergy = "no captured energy";

/// A number with its error, both to the second digit of the error: "0.0663 +- 0.0022". Without an
/// error above 0 the number has six digits; it never has more than eight. "none" for a number that
/// is not finite.
std::string withError(double value, double error);

/// The text with every number in it to at most six digits: specifications as people read them.
std::string withShortNumbers(std::string_view text);

}  // namespace hshfit::cli
