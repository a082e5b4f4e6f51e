#include "number_text.h"

#include <hshfit/error.h>
#include <hshfit/wording.h>

#include <fmt/format.h>

#include <charconv>
#include <cmath>

namespace hshfit::jobs {

std::vector<double> numbersIn(const std::string& text, std::size_t least, std::size_t most,
                              std::string_view member, std::string_view form) {
    std::vector<double> numbers;
    const char *at = text.data(), *end = at + text.size();
    for (bool more = true; more && numbers.size() < most;) {
        double number = 0;
        const auto [next, error] = std::from_chars(at, end, number);
        if (error != std::errc() || !std::isfinite(number)) break;
        numbers.push_back(number);
        more = next != end && *next == ',' && numbers.size() < most;
        at = more ? next + 1 : next;
    }
    if (numbers.size() < least || at != end || text.back() == ',')
        throw UsageError(fmt::format("{} '{}': give {}", Setting{member}, text, form));
    return numbers;
}

Direction Angles::direction() const {
    Direction d = directionFromAngles(radians(theta), radians(phi));
    if (std::abs(std::remainder(theta, 180)) == 90) d.z = 0;
    return d;
}

Angles anglesIn(const std::string& text, std::string_view member, double mostTheta) {
    const std::string form =
        fmt::format("THETA,PHI in degrees, theta from 0 to {} (for example 45,0)", mostTheta);
    const auto angles = numbersIn(text, 2, 2, member, form);
    if (!(angles[0] >= 0 && angles[0] <= mostTheta))
        throw UsageError(fmt::format("{} '{}': give {}", Setting{member}, text, form));
    return {angles[0], angles[1]};
}

std::string anglesText(const Angles& angles) {
    return fmt::format("{},{}", angles.theta, angles.phi);
}

}  // namespace hshfit::jobs
