// sample_basis NAME ORDER: the lobes |B_l^m| of a basis as surfaces for bases.gp.
// Columns: x y z sign. Each lobe is scaled to a largest radius of 0.47, turned by -25 degrees about
// z so that lobes along y show, and moved to (m, 0, -l). An empty line ends a scan, two a function.

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include <fmt/format.h>

namespace {

using namespace hshfit;

constexpr int elevations = 40, azimuths = 72;

void printLobe(const std::vector<Direction>& grid, const std::vector<double>& values, int l,
               int m) {
    double largest = 0;
    for (const double value : values) largest = std::max(largest, std::abs(value));
    for (std::size_t k = 0; k < grid.size(); ++k) {
        const double radius = 0.47 * std::abs(values[k]) / largest;
        const Direction d = rotateAboutZ(grid[k], radians(-25));
        fmt::print("{:.5f} {:.5f} {:.5f} {}\n", m + radius * d.x, radius * d.y, -l + radius * d.z,
                   values[k] < 0 ? -1 : 1);
        if (k % (azimuths + 1) == azimuths) fmt::print("\n");
    }
    fmt::print("\n");
}

void printBasis(const Basis& basis) {
    std::vector<Direction> grid;
    std::vector<std::vector<double>> values;
    for (int i = 0; i <= elevations; ++i)
        for (int k = 0; k <= azimuths; ++k) {
            // A pole slightly off the axis keeps its azimuth.
            const double theta = std::max(1e-6, radians(90.0 * i / elevations));
            grid.push_back(directionFromAngles(theta, radians(360.0 * k / azimuths)));
            values.emplace_back(static_cast<std::size_t>(basis.slots()));
            basis.evaluate(grid.back(), values.back().data());
        }
    for (int l = 0; l < basis.order(); ++l)
        for (int m = -l; m <= l; ++m) {
            if (!basis.has(l, m)) continue;
            std::vector<double> one;
            for (const auto& all : values)
                one.push_back(all[static_cast<std::size_t>(slotOf(l, m))]);
            printLobe(grid, one, l, m);
        }
}

}  // namespace

int main(int argc, char** argv) try {
    if (argc != 3) throw UsageError("usage: sample_basis NAME ORDER");
    printBasis(*bases::make(argv[1], std::atoi(argv[2])));
} catch (const Error& error) {
    fmt::print(stderr, "sample_basis: {}\n", error.what());
    return static_cast<int>(error.code());
}
