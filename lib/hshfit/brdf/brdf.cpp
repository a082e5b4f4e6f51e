#include <hshfit/brdf/brdf.h>

#include <hshfit/brdf/kink_curve.h>

namespace hshfit::inline brdf {

void Brdf::coverage(const Direction& wo, DirectionBatch wi, unsigned char* covered) const {
    for (std::size_t k = 0; k < wi.count; ++k) covered[k] = wo.z > 0 && wi.z[k] > 0;
}

std::vector<Lobe> Brdf::lobes(const Direction&) const {
    return {};
}

std::vector<double> Brdf::kinks(const Direction&) const {
    return {};
}

std::vector<KinkCurve> kinkCurvesOf(const Brdf& brdf, const Direction& wo) {
    const auto* known = dynamic_cast<const HasKinkCurves*>(&brdf);
    return known ? known->kinkCurves(wo) : std::vector<KinkCurve>{};
}

std::vector<double> evaluate(const Brdf& brdf, const Direction& wi, const Direction& wo) {
    std::vector<double> values(brdf.channels().count());
    brdf.eval(wo, {&wi.x, &wi.y, &wi.z, 1}, values.data());
    return values;
}

}  // namespace hshfit::inline brdf
