// The tables of docs/explanation/bases.md: the errors of each basis in double and in float. It is
// no test and only prints its measurements.

#include <hshfit/bases/catalog.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <random>
#include <string>

#include <fmt/format.h>

#include "lib/bases/quadrature.h"

namespace {

using namespace hshfit;

/// Every m up to order 256; beyond, the first few and every 37th, to limit the time to seconds.
double orthonormalityError(const bases::Entry& entry, int order, std::size_t nodes) {
    const auto basis = entry.make(order, {});
    const quadrature::Rule rule = quadrature::ruleOf(*basis, nodes);
    double worst = 0;
    for (int m = 0; m < order; ++m)
        if (order <= 256 || m < 3 || m % 37 == 0)
            worst = std::max(worst, quadrature::gramError(*basis, m, rule));
    return worst;
}

void printOrthonormality() {
    fmt::print("orthonormality error | order 32 | order 256 | order 1000\n--|--|--|--\n");
    for (const bases::Entry& entry : bases::catalog()) {
        if (!entry.orthonormal) continue;
        fmt::print("{}", entry.name);
        if (entry.maxOrder < 32) {
            fmt::print(" | {:.0e} (order {}) | – | –\n",
                       orthonormalityError(entry, entry.maxOrder, 20), entry.maxOrder);
            continue;
        }
        for (const auto& [order, nodes] :
             {std::pair{32, 64}, std::pair{256, 512}, std::pair{1000, 1024}}) {
            if (order <= entry.maxOrder)
                fmt::print(" | {:.0e}", orthonormalityError(entry, order, nodes));
            else
                fmt::print(" | –");
        }
        fmt::print("\n");
    }
}

/// Directions near the peak of every function: even in theta and denser at both ends.
std::vector<Direction> sampleDirections() {
    std::vector<Direction> directions{{0, 0, 1}, {0.6, 0.8, 0}};
    constexpr int even = 320, crowded = 40;
    std::mt19937_64 generator(1);  // equal steps in azimuth would miss some m altogether
    std::uniform_real_distribution<double> azimuth(-pi, pi);
    for (int k = 0; k < even; ++k)
        directions.push_back(directionFromAngles((k + 0.5) / even * pi / 2, azimuth(generator)));
    for (int k = 0; k < crowded; ++k) {
        const double small = std::pow(10.0, -7.0 * (k + 1) / crowded);
        directions.push_back(directionFromAngles(small, azimuth(generator)));
        directions.push_back(directionFromAngles(pi / 2 - small, azimuth(generator)));
    }
    return directions;
}

/// [l]: the largest |float - double| of a function of band l, over the largest value that the
/// function takes, both over the sample directions.
std::vector<double> floatErrors(const bases::Entry& entry, int order) {
    const auto basis = entry.make(order, {});
    const auto slots = static_cast<std::size_t>(basis->slots());
    std::vector<double> values(slots), largest(slots, 0.0), error(slots, 0.0);
    std::vector<float> singles(slots);
    for (const Direction& d : sampleDirections()) {
        const DirectionBatch one{&d.x, &d.y, &d.z, 1};
        basis->evaluate(one, values.data());
        basis->evaluate(one, singles.data());
        for (std::size_t i = 0; i < slots; ++i) {
            largest[i] = std::max(largest[i], std::abs(values[i]));
            error[i] = std::max(error[i], std::abs(values[i] - double{singles[i]}));
        }
    }
    std::vector<double> worst(static_cast<std::size_t>(order), 0.0);
    for (int l = 0; l < order; ++l)
        for (int m = -l; m <= l; ++m) {
            const auto i = static_cast<std::size_t>(slotOf(l, m));
            if (largest[i] > 0) worst[l] = std::max(worst[l], error[i] / largest[i]);
        }
    return worst;
}

void printFloat() {
    constexpr std::array orders{2, 4, 8, 16, 32, 64, 128, 256, 512, 1000};
    constexpr std::array limits{1e-6, 1e-5, 1e-4, 1e-3, 1e-2};
    std::string header = "float error / max at order", rule = "--", passing;
    for (const int order : orders) header += fmt::format(" | {}", order), rule += "|--";
    fmt::print("\n{}\n{}\n", header, rule);
    for (const bases::Entry& entry : bases::catalog()) {
        std::vector<double> worst = floatErrors(entry, std::min(1000, entry.maxOrder));
        for (std::size_t l = 1; l < worst.size(); ++l) worst[l] = std::max(worst[l], worst[l - 1]);
        fmt::print("{}", entry.name);
        for (const int order : orders)
            order <= entry.maxOrder ? fmt::print(" | {:.1e}", worst[order - 1])
                                    : fmt::print(" | –");
        fmt::print("\n");
        passing += entry.name;
        for (const double limit : limits) {
            const auto at = std::upper_bound(worst.begin(), worst.end(), limit);
            passing += at == worst.end() ? fmt::format(" | > {}", worst.size())
                                         : fmt::format(" | {}", at - worst.begin() + 1);
        }
        passing += "\n";
    }
    fmt::print(
        "\nfirst order with a float error above | 1e-6 | 1e-5 | 1e-4 | 1e-3 | 1e-2\n"
        "--|--|--|--|--|--\n{}",
        passing);
}

/// The share of energy that noise of unit size in every moment keeps: the rank of the solve over
/// n^2.
void printRank() {
    const auto basis = bases::make("lsosh", 64);
    fmt::print("\nlsosh order | functions | kept by the solve\n--|--|--\n");
    std::vector<double> moments(64 * 64, 0.0);
    for (const int n : {4, 8, 12, 16, 17, 20, 24, 32, 48, 64}) {
        double rank = 0;
        for (std::size_t i = 0; i < static_cast<std::size_t>(n * n); ++i) {
            moments[i] = 1;  // the trace of a projection is its rank
            rank += basis->capturedEnergy(moments.data(), n);
            moments[i] = 0;
        }
        fmt::print("{} | {} | {:.0f}\n", n, n * n, rank);
    }
}

}  // namespace

int main() {
    printOrthonormality();
    printFloat();
    printRank();
}
