#pragma once

#include <hshfit/gpu/shader_data.h>

#include <kainjow/mustache.hpp>

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace hshfit::inline material_maps::inline exports {

/// Sums of texels of four numbers, lane = out * in() + i, times numbers that a shader has:
///     to(out, colour) += factor[k] * sum over i of texel k (lane) * from(i, colour)
/// for each colour of light of `coloursOf(out)`. Two kinds of names are its input and its output.
struct WeightedSums {
    std::size_t outs = 1, ins = 1;
    std::string texel;                 ///< name of the variables
    std::vector<std::string> factors;  ///< one for each lookup of a quadruple
    std::function<std::string(std::size_t k, std::size_t group)> fetch;
    std::function<std::string(std::size_t i, std::size_t colour)> from;
    std::function<std::string(std::size_t out, std::size_t colour)> to;
    std::function<std::vector<std::size_t>(std::size_t out)> coloursOf;
};

/// One entry of the list that the template "sums" runs through; adds to `cost`.
kainjow::mustache::data sumsData(const WeightedSums& sums, gpu::ShaderCost& cost);

}  // namespace hshfit::inline material_maps::inline exports
