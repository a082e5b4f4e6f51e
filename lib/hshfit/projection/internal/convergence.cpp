#include <hshfit/projection/internal/convergence.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline projection {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

double ratioOf(double change, double before) {
    if (change == 0) return 0;
    return before > 0 ? change / before : infinity;
}

/// The factor by which the next change is expected to be below the last one; 1 where changes do not
/// shrink as those of a smooth f do. Errors are about exp(-c 1.4^k) at level k: their ratios go
/// down with every level, and an error is the last change to the power of 1.4. The larger of the
/// two counts, since either may be an accident. Safety factors from trials over the catalog
/// (docs/stability.md).
double smoothFactor(const Changes& changes) {
    const auto& [last, before, earlier] = changes.values;
    constexpr double growth = 1.4, ofRatio = 5, ofPower = 30;
    const double ratio = ratioOf(last, before);
    const double power = ofPower * std::pow(last, growth - 1);
    if (earlier == infinity) {  // two changes show less
        constexpr double fast = 0.1;
        return ratio < fast ? std::min(1.0, std::max(ofRatio * ratio, power)) : 1;
    }
    constexpr double fast = 0.2, fastBefore = 0.35, further = 1.2;
    const double ratioBefore = ratioOf(before, earlier);
    if (!(ratio < fast && ratioBefore < fastBefore)) return 1;
    const double sure = std::max(ratio, std::pow(ratioBefore, growth));
    return std::min(1.0, std::max(ofRatio * std::pow(sure, further), power));
}

/// The error that algebraic convergence leaves.
double roughError(const Changes& changes) {
    const auto& [last, before, earlier] = changes.values;
    constexpr double slow = 0.5, slowest = 0.75;
    double error = std::max(last, slow * before);
    double ratio = ratioOf(last, before);
    if (earlier < infinity) {
        error = std::max(error, slow * slow * earlier);
        ratio = std::max(ratio, std::sqrt(ratioOf(last, earlier)));
    }
    ratio = std::min(ratio, slowest);
    return std::max(error, last * ratio / (1 - ratio));
}

}  // namespace

PanelError panelError(const Changes& changes, bool mayBeSmooth) {
    const auto& [last, before, earlier] = changes.values;
    constexpr double ofOneChange = 2, ofTables = 3;
    if (last == infinity) return {infinity, infinity};
    const double rough = before == infinity ? ofOneChange * last : roughError(changes);
    if (!mayBeSmooth) return {rough, ofTables * rough};
    if (before == infinity) return {rough, rough};
    const double factor = smoothFactor(changes);
    const double error = factor < 1 ? std::min(rough, factor * last) : rough;
    return {error, error};
}

}  // namespace hshfit::inline projection
