#include <hshfit/brdf.h>

namespace hshfit {

std::vector<Lobe> Brdf::lobes(const Direction&) const {
    return {};
}

std::vector<double> Brdf::kinks(const Direction&) const {
    return {};
}

std::vector<double> evaluate(const Brdf& brdf, const Direction& wi, const Direction& wo) {
    std::vector<double> values(brdf.channels().count());
    brdf.eval(wo, {&wi.x, &wi.y, &wi.z, 1}, values.data());
    return values;
}

}  // namespace hshfit
