#pragma once

#include <cstddef>
#include <vector>

/// The network of Sztrajman et al. (2021), "Neural BRDF Representation and Importance Sampling":
/// 6 inputs, two layers of 21 with max(0, .), three outputs exp(.) - 1. The weights are
/// arbitrary, because only the speed matters. Compiled for AVX2 and FMA, as the kernels that it
/// is measured against choose at run time.
class Network {
public:
    static constexpr std::size_t inputs = 6, width = 21, outputs = 3;

    /// `block`: the number of columns that go through all layers at a time, to stay in the cache.
    explicit Network(std::size_t block);

    static bool supported();
    /// in[column * 6 + input], out[column * 3 + output]; `count` is a multiple of the block.
    void evaluate(const float* in, std::size_t count, float* out) const;

private:
    std::size_t block_;
    std::vector<float> first_, second_, third_, bias_;
};
