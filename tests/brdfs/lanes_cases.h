// The functions of lanes_math.h and lanes_angles.h over arrays, for lanes_test.cpp; once for each
// instruction set.

#include <brdfs/lanes/lanes_angles.h>
#include <brdfs/lanes/lanes_math.h>

#include <algorithm>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

template <class Function>
HWY_INLINE void overArray(const double* x, std::size_t size, double* y, Function function) {
    constexpr std::size_t most = HWY_MAX_BYTES / sizeof(double);
    for (std::size_t k = 0; k < size; k += lanesIn<Lanes>()) {
        const std::size_t part = std::min(size - k, lanesIn<Lanes>());
        double in[most] = {}, out[most];
        std::copy_n(x + k, part, in);
        Lanes value;
        load(in, value);
        store(function(value), out);
        std::copy_n(out, part, y + k);
    }
}

void lanesExp(const double* x, std::size_t size, double* y) {
    overArray(x, size, y, [](Lanes v) HWY_ATTR { return exp(v); });
}
void lanesExpm1(const double* x, std::size_t size, double* y) {
    overArray(x, size, y, [](Lanes v) HWY_ATTR { return expm1(v); });
}
void lanesLog(const double* x, std::size_t size, double* y) {
    overArray(x, size, y, [](Lanes v) HWY_ATTR { return log(v); });
}
void lanesLog1p(const double* x, std::size_t size, double* y) {
    overArray(x, size, y, [](Lanes v) HWY_ATTR { return log1p(v); });
}
void lanesErfc(const double* x, std::size_t size, double* y) {
    overArray(x, size, y, [](Lanes v) HWY_ATTR { return erfc(v); });
}
void lanesIerfc(const double* x, std::size_t size, double* y) {
    overArray(x, size, y, [](Lanes v) HWY_ATTR { return ierfc(v); });
}
void lanesCos(const double* x, std::size_t size, double* y) {
    overArray(x, size, y, [](Lanes v) HWY_ATTR { return cos(v); });
}
void lanesSin(const double* x, std::size_t size, double* y) {
    overArray(x, size, y, [](Lanes v) HWY_ATTR { return sin(v); });
}
void lanesPow(const double* x, double power, std::size_t size, double* y) {
    overArray(x, size, y, [power](Lanes v) HWY_ATTR { return pow(v, Lanes(power)); });
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
