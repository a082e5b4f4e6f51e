#include <hshfit/brdf/steps.h>
#include <hshfit/brdf/transmission.h>

#include <algorithm>
#include <cmath>

namespace hshfit::inline brdf {

std::vector<double> outgoingKinksOf(const Brdf& brdf, const Direction& wi) {
    const auto* known = dynamic_cast<const HasSteps*>(&brdf);
    return known ? known->outgoingKinks(wi) : brdf.kinks(wi);
}

std::vector<KinkCurve> outgoingKinkCurvesOf(const Brdf& brdf, const Direction& wi) {
    const auto* known = dynamic_cast<const HasSteps*>(&brdf);
    return known ? known->outgoingKinkCurves(wi) : kinkCurvesOf(brdf, wi);
}

int squareLevelsOf(const Brdf& brdf) {
    const auto* known = dynamic_cast<const HasSteps*>(&brdf);
    return known ? known->squareLevels() : 0;
}

Direction directionFromSquare(const SquarePoint& point) {
    const double a = 2 * point.u - 1, b = 2 * point.v - 1;
    if (a == 0 && b == 0) return {0, 0, 1};
    const bool flat = std::fabs(b) <= std::fabs(a);
    const double r = flat ? a : b;
    const double angle = pi / 4 * (flat ? b / a : a / b);
    const double along = r * std::cos(angle), across = r * std::sin(angle);
    // 1 - r^2 without cancellation.
    return {flat ? along : across, flat ? across : along,
            std::sqrt(std::max((1 - r) * (1 + r), 0.0))};
}

void Exchanged::eval(const Direction& wo, DirectionBatch wi, double* out) const {
    const std::size_t channels = brdf_.channels().count();
    std::vector<double> values(channels);
    for (std::size_t k = 0; k < wi.count; ++k) {
        brdf_.eval({wi.x[k], wi.y[k], wi.z[k]}, {&wo.x, &wo.y, &wo.z, 1}, values.data());
        for (std::size_t c = 0; c < channels; ++c) out[c * wi.count + k] = values[c];
    }
}

std::vector<Lobe> Exchanged::lobes(const Direction& wo) const {
    return outgoingLobesOf(brdf_, wo);
}

void Exchanged::coverage(const Direction& wo, DirectionBatch wi, unsigned char* covered) const {
    for (std::size_t k = 0; k < wi.count; ++k)
        brdf_.coverage({wi.x[k], wi.y[k], wi.z[k]}, {&wo.x, &wo.y, &wo.z, 1}, covered + k);
}

}  // namespace hshfit::inline brdf
