#include <hshfit/accuracy/exchange.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace hshfit::inline accuracy {
namespace {

/// The least share of the largest value, with its cosines, that a pair needs to count.
constexpr double visible = 0.01;

std::vector<ExchangeAtHorizon> candidates(const Brdf& brdf) {
    constexpr std::array low = {60.0, 70.0, 75.0, 80.0, 85.0};
    constexpr std::array high = {0.0, 15.0, 30.0, 45.0, 60.0, 75.0};
    std::vector<ExchangeAtHorizon> pairs;
    const int turns = brdf.laws().isotropic ? 1 : 4;
    for (const double grazing : low) {
        for (const double other : high) {
            for (int k = 0; k < 8 * turns; ++k) {
                const double phi = k / 8 * pi / 2 + 0.1, difference = k % 8 * pi / 4;
                const Direction wi = directionFromAngles(radians(grazing), phi);
                const Direction wo = directionFromAngles(radians(other), phi + difference);
                const std::vector<double> one = evaluate(brdf, wi, wo);
                const std::vector<double> two = evaluate(brdf, wo, wi);
                for (std::size_t c = 0; c < one.size(); ++c) {
                    if (one[c] >= two[c])
                        pairs.push_back({wi, wo, c, one[c], two[c]});
                    else
                        pairs.push_back({wo, wi, c, two[c], one[c]});
                }
            }
        }
    }
    std::erase_if(pairs, [](const ExchangeAtHorizon& pair) {
        return !std::isfinite(pair.value) || !(pair.exchanged >= 0);
    });
    return pairs;
}

double seen(const ExchangeAtHorizon& pair) {
    return pair.value * pair.wi.z * pair.wo.z;
}

}  // namespace

double ExchangeAtHorizon::ratio() const {
    if (value == exchanged) return 1;
    return exchanged > 0 ? value / exchanged : std::numeric_limits<double>::infinity();
}

ExchangeAtHorizon exchangeAtHorizon(const Brdf& brdf) {
    const std::vector<ExchangeAtHorizon> pairs = candidates(brdf);
    double largest = 0;
    for (const ExchangeAtHorizon& pair : pairs) largest = std::max(largest, seen(pair));
    ExchangeAtHorizon worst;
    for (const ExchangeAtHorizon& pair : pairs) {
        if (seen(pair) >= visible * largest && pair.ratio() > worst.ratio()) worst = pair;
    }
    return worst;
}

}  // namespace hshfit::inline accuracy
