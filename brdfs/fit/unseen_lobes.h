#pragma once

#include <brdfs/fit/covariance.h>
#include <brdfs/fit/normal_equations.h>

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace hshfit::brdfs {

/// The order of parameters in x: shapes, then linear ones, one after another for every channel.
struct ParameterOrder {
    std::size_t shapes = 0, channels = 1;
    std::size_t end = 0;  ///< of the linear ones
};

/// Takes away the errors of linear parameters that are not told from 0 (two errors) in any channel,
/// and errors of the shapes that have no effect without them: shapes are not determined there, and
/// errors by derivatives mean nothing, the error of the scale included (Davies 1977,
/// 10.1093/biomet/64.2.247). `joint`: the equations at another x.
void reportUnseenLobes(const ParameterOrder& order,
                       const std::function<Equations(std::span<const double>)>& joint,
                       const std::vector<double>& x, const Equations& equations,
                       const std::vector<bool>& fixed, Covariance& covariance);

}  // namespace hshfit::brdfs
