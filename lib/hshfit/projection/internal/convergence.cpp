#include <hshfit/projection/internal/convergence.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline projection {
namespace {

double ratioOf(double change, double before) {
    if (change == 0) return 0;
    return before > 0 ? change / before : infinity;
}

constexpr double growth = 1.4;  ///< of the number of nodes, from level to level

/// A last change far below the one that the two before lead to is an accident.
double withoutAccident(const Changes& changes) {
    const auto& [last, before, earlier] = changes.values;
    constexpr double plausible = 0.03;
    if (!(earlier < infinity && earlier > 0)) return last;
    return std::max(last, plausible * before * std::pow(std::min(1.0, before / earlier), growth));
}

/// The factor by which the next change is expected to be below the last one; 1 where changes do not
/// shrink as they do for a smooth f. Errors are about exp(-c 1.4^k) at level k: their ratios go
/// down with every level, and an error is the last change to the power of 1.4. The larger of the
/// two counts, since either may be an accident. Factors from trials over the catalog
/// (docs/results/stability.md).
double smoothFactor(const Changes& changes) {
    const auto& [last, before, earlier] = changes.values;
    constexpr double ofPower = 20, fast = 0.3;
    const double ratio = ratioOf(last, before);
    if (!(ratio < fast)) return 1;
    const double power = ofPower * std::pow(last, growth - 1);
    constexpr double ofOneRatio = 0.5;
    if (earlier == infinity) return std::min(1.0, std::max(ofOneRatio * ratio, power));
    constexpr double ofTwoRatios = 5, fastBefore = 0.25, further = 1.2;
    const double ratioBefore = ratioOf(before, earlier);
    if (!(ratioBefore < fastBefore)) return 1;
    const double sure = std::max(ratio, std::pow(ratioBefore, growth));
    return std::min(1.0, std::max(ofTwoRatios * std::pow(sure, further), power));
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

PanelError panelError(const Changes& given, bool mayBeSmooth) {
    constexpr double ofTables = 3, ofOneChange = 10;
    Changes changes = given;
    auto& [last, before, earlier] = changes.values;
    if (last == infinity) return {infinity, infinity};
    last = withoutAccident(changes);
    const double rough = before == infinity ? last : roughError(changes);
    if (!mayBeSmooth) return {last, (before == infinity ? ofOneChange : ofTables) * rough};
    if (before == infinity) return {rough, rough};
    const double factor = smoothFactor(changes);
    const double error = factor < 1 ? std::min(rough, factor * last) : rough;
    return {error, error};
}

PanelError earlyError(const Changes& changes) {
    constexpr double ofOneChange = 3;
    const auto& [last, before, earlier] = changes.values;
    if (last == infinity) return {infinity, infinity};
    const double error = before == infinity ? ofOneChange * last : roughError(changes);
    return {error, error};
}

}  // namespace hshfit::inline projection
