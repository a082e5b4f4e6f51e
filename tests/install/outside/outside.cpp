// The coefficient of a constant function: B_0^0 of HSH is 1 / sqrt(2 pi).
#include <hshfit/hshfit.h>

#include <cmath>
#include <cstdio>

int main() {
    const auto basis = hshfit::bases::make("hsh", 1);
    double value = 0;
    basis->evaluate(hshfit::Direction{0, 0, 1}, &value);
    std::printf("hshfit %s: %.12f\n", hshfit::version, value);
    return std::abs(value * std::sqrt(2 * hshfit::pi) - 1) < 1e-14 ? 0 : 1;
}
