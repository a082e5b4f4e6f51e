#include <hshfit/material_library/form_error.h>

#include <hshfit/error.h>
#include <hshfit/material_library/log_terms.h>

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace hshfit::material_library {

FormError formError(const Brdf& f, const Brdf& g, const PairSample& pairs) {
    const std::size_t channels = f.channels().count();
    assert(g.channels().count() == channels);
    const std::vector<double> theirs = evaluateOn(f, pairs, true),
                              ours = evaluateOn(g, pairs, true);
    FormError error;
    double square = 0, all = 0;
    for (std::size_t n = 0; n < theirs.size(); ++n) {
        const std::size_t k = n % pairs.size();
        if (!std::isfinite(theirs[n]))
            throw NumericError(fmt::format("{}: f is not finite at a pair", f.name()));
        const double a = std::max(theirs[n], 0.0), b = std::max(ours[n], 0.0), c = pairs.z[k];
        const double weight = pairs.weights[k] / static_cast<double>(channels);
        error.meanLog += weight * std::abs(std::log1p(a * c) - std::log1p(b * c));
        error.logError += weight * std::abs(std::log((b + logOffset) / (a + logOffset)));
        square += weight * (a - b) * (a - b) * c * c;
        all += weight * a * a * c * c;
        error.maximum = std::max(error.maximum, std::abs(a - b) * c);
        error.largest = std::max(error.largest, a * c);
    }
    error.relativeL2 = all > 0 ? std::sqrt(square / all) : 0;
    return error;
}

std::string beyond(const FormError& error, const Limits& limits) {
    const auto text = [](const char* of, double value, double limit) {
        // An excess that three digits do not show has more.
        std::string digits = fmt::format("{:.3g}", value);
        for (int more = 4; digits == fmt::format("{:.3g}", limit) && more <= 17; ++more)
            digits = fmt::format("{:.{}g}", value, more);
        return fmt::format("has a {} of {}, limit {:.3g}", of, digits, limit);
    };
    if (error.logError > limits.log)
        return text("mean error of ln(f + 0.001)", error.logError, limits.log);
    if (error.maximumShare() > limits.maximum)
        return text("largest error of f cos, as a share of the largest f cos,",
                    error.maximumShare(), limits.maximum);
    if (error.flip > limits.flip) return text("mean FLIP", error.flip, limits.flip);
    return {};
}

const PairSample& errorPairs() {
    static const PairSample pairs = spreadPairs();
    return pairs;
}

}  // namespace hshfit::material_library
