#pragma once

// Shares as people read them; seventeen digits belong in JSON alone.

#include <fmt/format.h>

#include <cmath>
#include <string>

namespace hshfit {

/// "0.85", "64", "127": significant digits, and all that stand before the point.
inline std::string significant(double value, int digits = 2) {
    // From here on rounding would reach the next power of ten.
    return std::abs(value) < std::pow(10, digits) - 0.5 ? fmt::format("{:.{}g}", value, digits)
                                                        : fmt::format("{:.0f}", value);
}

/// "0.846 %".
inline std::string percent(double share, int digits = 3) {
    return significant(100 * share, digits) + " %";
}

/// "7 %", and from tenfold on "12 times", which a share in percent would hide behind its digits.
inline std::string percentOrTimes(double share) {
    return share < 10 ? percent(share, 2) : fmt::format("{:.3g} times", share);
}

/// A share in percent with its sign: "+0.846 %".
inline std::string signedPercent(double share, int digits = 2) {
    const std::string text = percent(std::abs(share), digits);
    return (share < 0 ? "-" : "+") + text;
}

}  // namespace hshfit
