#pragma once

#include <cstdint>

/// out = left x right by Eigen, one thread, compiled for AVX2 and FMA where it is x86-64 (Eigen
/// does not choose at run time). Row-major: left [rows][inner], right [inner][columns].
void multiply(const double* left, const double* right, std::int64_t rows, std::int64_t inner,
              std::int64_t columns, double* out);
void multiply(const float* left, const float* right, std::int64_t rows, std::int64_t inner,
              std::int64_t columns, float* out);

/// Whether this machine has the instructions that the product is compiled for.
bool productSupported();
