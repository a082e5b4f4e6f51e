// Sums of a kernel over a pyramid of light, of several axes at once.
#include <hshfit/lighting/internal/light_pyramid.h>

#include <gtest/gtest.h>
#include <vector_targets.h>

#include <cmath>
#include <optional>
#include <random>

namespace hshfit::lighting {
namespace {

using Axes = LightPyramid::Axes;
using Sums = LightPyramid::Sums;

Direction randomDirection(std::mt19937& random) {
    std::normal_distribution<double> normal;
    const Direction d{normal(random), normal(random), normal(random)};
    const double length = std::sqrt(dot(d, d));
    return {d.x / length, d.y / length, d.z / length};
}

/// Nodes all over the sphere, each of its own colour.
LightNodes randomNodes(std::size_t count) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> colour(0.1, 1);
    LightNodes nodes;
    for (std::size_t k = 0; k < count; ++k)
        nodes.add(randomDirection(random), {colour(random), colour(random), colour(random)}, 1e-3);
    return nodes;
}

/// GGX about an axis, of alpha 0.2, as of an engine's environment.
const LobeKernel::Scaled& kernel() {
    static const LobeKernel::Scaled made = [] {
        std::vector<double> t, values;
        for (int k = 0; k <= 400; ++k) {
            t.push_back(1e-4 * std::pow(1e4, k / 400.0));
            const double d = (0.04 + t.back() * t.back()) / (1 + t.back() * t.back());
            values.push_back(1 / (d * d));
        }
        return LobeKernel(std::move(t), std::move(values)).scaled(1);
    }();
    return made;
}

/// Neighbours, as the texels of a block are, `apart` from each other, in no order.
Axes neighbours(double apart) {
    std::mt19937 random(7);
    const Direction about = randomDirection(random);
    Axes axes;
    for (Direction& axis : axes) {
        const Direction off = randomDirection(random);
        const Direction d{about.x + apart * off.x, about.y + apart * off.y,
                          about.z + apart * off.z};
        const double length = std::sqrt(dot(d, d));
        axis = {d.x / length, d.y / length, d.z / length};
    }
    return axes;
}

/// An axis takes the cells and has the bits that it has alone, whatever the others and whatever the
/// vectors of the machine.
TEST(LightPyramid, AxesDoNotMatterToEachOther) {
    for (const std::size_t count : {3000U, 60000U}) {  // kept in the pyramid, and not
        const LightPyramid pyramid(randomNodes(count), 24);
        EXPECT_EQ(pyramid.first.empty(), count > 2 * 6 * 24 * 24);
        const PyramidKernel own(kernel(), 0.3);
        std::optional<Sums> before;
        for (const double apart : {0.02, 0.5, 3.0}) {
            const Axes axes = neighbours(apart);
            before.reset();
            test::forEveryTarget([&] {
                Sums together{};
                pyramid.add(axes, own, together);
                if (before) {
                    EXPECT_EQ(together, *before);
                }
                before = together;
                for (std::size_t k = 0; k < axes.size(); k += 5) {
                    Axes same;
                    same.fill(axes[k]);
                    Sums alone{};
                    pyramid.add(same, own, alone);
                    for (const Rgb& rgb : alone) EXPECT_EQ(rgb, together[k]);
                }
            });
        }
    }
}

/// Cells in place of nodes change a sum by the square of their size over their distance, a seventh
/// at most, times the curvature of the kernel: less than a hundredth.
TEST(LightPyramid, SumsAreThoseOverAllNodes) {
    const LightNodes nodes = randomNodes(6000);
    const LightPyramid pyramid(nodes, 32);
    const Axes axes = neighbours(0.1);
    Sums sums{};
    pyramid.add(axes, PyramidKernel(kernel()), sums);
    double worst = 0;
    for (std::size_t k = 0; k < axes.size(); ++k) {
        for (std::size_t c = 0; c < 3; ++c) {
            double plain = 0;
            for (std::size_t i = 0; i < nodes.count(); ++i)
                plain += nodes.flux[c][i] *
                         kernel().at(dot(axes[k], {nodes.x[i], nodes.y[i], nodes.z[i]}));
            worst = std::max(worst, std::abs(sums[k][c] / plain - 1));
        }
    }
    EXPECT_LT(worst, 1e-2);
    EXPECT_GT(worst, 0);  // some cells are nodes
}

}  // namespace
}  // namespace hshfit::lighting
