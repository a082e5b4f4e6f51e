#include <brdfs/analytic/fresnel.h>

#include <algorithm>
#include <cmath>

namespace hshfit::brdfs {
namespace {

struct Complex {
    double real, imaginary;

    double squaredLength() const { return real * real + imaginary * imaginary; }
};

/// The root in the first quadrant, for imaginary >= 0; neither part from a difference.
Complex squareRoot(const Complex& z) {
    const double larger = std::sqrt((std::hypot(z.real, z.imaginary) + std::abs(z.real)) / 2);
    const double smaller = larger > 0 ? z.imaginary / larger / 2 : 0;
    return z.real >= 0 ? Complex{larger, smaller} : Complex{smaller, larger};
}

}  // namespace

double conductorReflectance(double cosine, double eta, double k) {
    // Below 1e-150 its square underflows; the reflectance has long been that of the horizon.
    const double c = std::clamp(cosine, 1e-150, 1.0);
    const double squaredSine = (1 - c) * (1 + c);
    const Complex g = squareRoot({(eta - 1) * (eta + 1) + c * c - k * k, 2 * eta * k});
    const double across = Complex{c - g.real, g.imaginary}.squaredLength() /
                          Complex{c + g.real, g.imaginary}.squaredLength();
    const double ratio = Complex{c * g.real - squaredSine, c * g.imaginary}.squaredLength() /
                         Complex{c * g.real + squaredSine, c * g.imaginary}.squaredLength();
    return std::min(1.0, across * (1 + ratio) / 2);
}

double dielectricReflectance(double cosine, double eta) {
    return conductorReflectance(cosine, eta, 0);
}

double normalReflectance(double eta, double k) {
    return ((eta - 1) * (eta - 1) + k * k) / ((eta + 1) * (eta + 1) + k * k);
}

double iorOfReflectance(double f0) {
    return (1 + std::sqrt(f0)) / (1 - std::sqrt(f0));
}

}  // namespace hshfit::brdfs
