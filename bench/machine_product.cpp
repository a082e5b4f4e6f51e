#include "machine_product.h"

#include <Eigen/Core>

namespace {

template <class Real>
void multiplied(const Real* left, const Real* right, std::int64_t rows, std::int64_t inner,
                std::int64_t columns, Real* out) {
    using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Eigen::Map<Matrix>(out, rows, columns).noalias() =
        Eigen::Map<const Matrix>(left, rows, inner) *
        Eigen::Map<const Matrix>(right, inner, columns);
}

}  // namespace

void multiply(const double* left, const double* right, std::int64_t rows, std::int64_t inner,
              std::int64_t columns, double* out) {
    multiplied(left, right, rows, inner, columns, out);
}

void multiply(const float* left, const float* right, std::int64_t rows, std::int64_t inner,
              std::int64_t columns, float* out) {
    multiplied(left, right, rows, inner, columns, out);
}

bool productSupported() {
#if defined(__x86_64__)
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#else
    return true;
#endif
}
