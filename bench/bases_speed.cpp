// Evaluating whole bases at a batch of directions, against what one would write with GSL and with
// the C++17 special functions for spherical harmonics of the same order.

#include <benchmark/benchmark.h>
#include <gsl/gsl_sf_legendre.h>
#include <hshfit/bases/catalog.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace {

using namespace hshfit;

constexpr std::size_t directionCount = 1024;

struct Directions {
    std::vector<double> x, y, z;

    Directions() : x(directionCount), y(directionCount), z(directionCount) {
        std::mt19937_64 random(1);
        std::uniform_real_distribution<double> uniform;
        for (std::size_t k = 0; k < directionCount; ++k) {
            const Direction d =
                directionFromAngles(std::acos(1 - uniform(random)), 2 * pi * uniform(random));
            x[k] = d.x;
            y[k] = d.y;
            z[k] = d.z;
        }
    }
    DirectionBatch batch() const { return {x.data(), y.data(), z.data(), z.size()}; }
};

const Directions& directions() {
    static const Directions instance;
    return instance;
}

/// All functions of `order` bands go to a [direction][slot] array, which `Fill` writes.
template <class Real, class Fill>
void evaluate(benchmark::State& state, int order, Fill fill) {
    std::vector<Real> out(directionCount * static_cast<std::size_t>(order * order));
    for (auto _ : state) {
        fill(out.data());
        benchmark::DoNotOptimize(out.data());
        benchmark::ClobberMemory();
    }
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(directionCount));
}

template <class Real>
void ours(benchmark::State& state, const std::string& name) {
    const int order = static_cast<int>(state.range(0));
    const auto basis = bases::make(name, order);
    evaluate<Real>(state, order, [&](Real* out) { basis->evaluate(directions().batch(), out); });
}

/// Spherical harmonics from `theta(l, m, k)`, the normalised Legendre part at direction k.
template <class Theta>
void fromLegendre(int order, std::size_t k, Theta theta, double* out) {
    const double phi = std::atan2(directions().y[k], directions().x[k]);
    for (int m = 0; m < order; ++m) {
        const double scale = m == 0 ? 1 : std::sqrt(2.0);
        const double cosine = scale * std::cos(m * phi), sine = scale * std::sin(m * phi);
        for (int l = m; l < order; ++l) {
            const double value = theta(l, m);
            out[slotOf(l, m)] = value * cosine;
            if (m > 0) out[slotOf(l, -m)] = value * sine;
        }
    }
}

void gsl(benchmark::State& state) {
    const int order = static_cast<int>(state.range(0));
    const auto lmax = static_cast<std::size_t>(order - 1);
    std::vector<double> legendre(gsl_sf_legendre_array_n(lmax));
    evaluate<double>(state, order, [&](double* out) {
        for (std::size_t k = 0; k < directionCount; ++k) {
            gsl_sf_legendre_array(GSL_SF_LEGENDRE_SPHARM, lmax, directions().z[k], legendre.data());
            const auto theta = [&](int l, int m) {
                return legendre[gsl_sf_legendre_array_index(static_cast<std::size_t>(l),
                                                            static_cast<std::size_t>(m))];
            };
            fromLegendre(order, k, theta, out + k * static_cast<std::size_t>(order * order));
        }
    });
}

void sphLegendre(benchmark::State& state) {
    const int order = static_cast<int>(state.range(0));
    evaluate<double>(state, order, [&](double* out) {
        for (std::size_t k = 0; k < directionCount; ++k) {
            const double angle = std::acos(directions().z[k]);
            const auto theta = [&](int l, int m) {
                return std::sph_legendre(static_cast<unsigned>(l), static_cast<unsigned>(m), angle);
            };
            fromLegendre(order, k, theta, out + k * static_cast<std::size_t>(order * order));
        }
    });
}

void forOrders(benchmark::internal::Benchmark* benchmark) {
    for (const int order : {7, 10, 33}) benchmark->Arg(order);
}

BENCHMARK(gsl)->Apply(forOrders);
BENCHMARK(sphLegendre)->Apply(forOrders);

}  // namespace

int main(int argc, char** argv) {
    for (const std::string name : {"hsh", "sh", "zernike", "makhotkin"}) {
        benchmark::RegisterBenchmark((name + "/double").c_str(), ours<double>, name)
            ->Apply(forOrders);
        benchmark::RegisterBenchmark((name + "/float").c_str(), ours<float>, name)
            ->Apply(forOrders);
    }
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
}
