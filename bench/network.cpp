#include "network.h"

#include <Eigen/Core>

#include <cmath>

namespace {

using Matrix = Eigen::Map<const Eigen::MatrixXf>;

std::vector<float> weights(std::size_t count) {
    std::vector<float> values(count);
    for (std::size_t k = 0; k < count; ++k) values[k] = std::sin(static_cast<float>(k)) / 8;
    return values;
}

}  // namespace

Network::Network(std::size_t block)
    : block_(block),
      first_(weights(width * inputs)),
      second_(weights(width * width)),
      third_(weights(outputs * width)),
      bias_(weights(width)) {}

bool Network::supported() {
#if defined(__x86_64__)
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#else
    return true;
#endif
}

void Network::evaluate(const float* in, std::size_t count, float* out) const {
    const auto columns = static_cast<Eigen::Index>(block_);
    const Matrix first(first_.data(), width, inputs), second(second_.data(), width, width),
        third(third_.data(), outputs, width);
    const Eigen::Map<const Eigen::VectorXf> bias(bias_.data(), width);
    Eigen::MatrixXf a(width, columns), b(width, columns);
    for (std::size_t at = 0; at < count; at += block_) {
        const Matrix input(in + at * inputs, inputs, columns);
        Eigen::Map<Eigen::MatrixXf> output(out + at * outputs, outputs, columns);
        a.noalias() = first * input;
        a = (a.colwise() + bias).cwiseMax(0.0F);
        b.noalias() = second * a;
        b = (b.colwise() + bias).cwiseMax(0.0F);
        output.noalias() = third * b;
        output = (output.colwise() + bias.head<outputs>()).array().exp() - 1;
    }
}
