#include <brdfs/analytic/fresnel.h>

#include <brdfs/analytic/fresnel_terms.h>

#include <cmath>

namespace hshfit::brdfs {
double conductorReflectance(double cosine, double eta, double k) {
    return HWY_NAMESPACE::reflectanceOf<double>(cosine, eta, k);
}

double dielectricReflectance(double cosine, double eta) {
    return conductorReflectance(cosine, eta, 0);
}

double normalReflectance(double eta, double k) {
    return HWY_NAMESPACE::normalReflectanceOf(eta, k);
}

double iorOfReflectance(double f0) {
    return (1 + std::sqrt(f0)) / (1 - std::sqrt(f0));
}

}  // namespace hshfit::brdfs
