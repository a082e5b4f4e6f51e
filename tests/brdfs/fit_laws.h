#pragma once

#include <brdfs/catalog.h>
#include <brdfs/fit/normal_equations.h>
#include <brdfs/fit/prediction.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace hshfit::brdfs {

/// At x, shapes and then linear parameters by channel: f is f of the specification that the sum
/// writes, in all three channels, and the gradient of the loss agrees with its differences.
inline void expectValuesAndGradients(const FitSamples& samples, const ParametricSum& sum,
                                     const FitProblem& problem, std::vector<double> x) {
    std::vector<double> shapes;
    for (std::size_t j = 0; j < sum.shapes().size(); ++j)
        shapes.push_back(sum.shapes()[j].toValue(x[j]));
    const std::vector<double> f = problem.values(x);
    const auto own =
        open(sum.filledIn({shapes}, std::span<const double>(x).subspan(shapes.size()), 3));
    const std::vector<double> expected = valuesOf(*own, samples);
    for (std::size_t v = 0; v < f.size(); ++v)
        ASSERT_NEAR(f[v], expected[v], 1e-10 * (1 + expected[v])) << "value " << v;
    const Equations equations = problem.joint(x, true);
    for (std::size_t i = 0; i < x.size(); ++i) {
        const double at = x[i], step = 1e-6 * std::max(1., std::abs(at));
        x[i] = at + step;
        const double above = problem.joint(x, false).cost;
        x[i] = at - step;
        const double below = problem.joint(x, false).cost;
        x[i] = at;
        EXPECT_NEAR(equations.gradient[i], (above - below) / (2 * step),
                    1e-5 * (1e-3 + std::abs(equations.gradient[i])))
            << "parameter " << i;
    }
}

}  // namespace hshfit::brdfs
