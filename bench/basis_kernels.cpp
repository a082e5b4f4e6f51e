// Whole bases at a batch of directions whose output stays in the cache: vector kernels in double
// and float and on each instruction set, the scalar path, GSL, libstdc++ and Boost.Math, and a
// write of as many bytes. Runs are interleaved; bench/summary prints medians of CPU time and
// ratios. `error` is the largest error over the largest magnitude of a function, against 100
// digits.

#include <hshfit/vector_targets.h>

#include "interleaved.h"

#include <benchmark/benchmark.h>
#include <gsl/gsl_sf_legendre.h>
#include <hshfit/bases/catalog.h>
#include <hshfit/bases/jacobi.h>
#include <hwy/targets.h>

#include <boost/math/special_functions/spherical_harmonic.hpp>
#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <random>
#include <string>
#include <vector>

#include <lib/bases/columns_reference.h>

namespace {

using namespace hshfit;
using Make = std::function<std::unique_ptr<Basis>(int order)>;

struct Directions {
    std::vector<double> x, y, z;

    explicit Directions(std::size_t count) : x(count), y(count), z(count) {
        std::mt19937_64 random(1);
        std::uniform_real_distribution<double> uniform;
        for (std::size_t k = 0; k < count; ++k) {
            const Direction d =
                directionFromAngles(std::acos(1 - uniform(random)), 2 * pi * uniform(random));
            x[k] = d.x, y[k] = d.y, z[k] = d.z;
        }
    }
    DirectionBatch batch() const { return {x.data(), y.data(), z.data(), z.size()}; }
};

std::size_t slotsOf(int order) {
    return static_cast<std::size_t>(order * order);
}

/// The number of directions whose doubles take 256 KiB, at least 16.
std::size_t directionCount(int order) {
    return std::max<std::size_t>(16, 32768 / slotsOf(order));
}

/// Error of out[k * slots + slot] in the columns 0, 1, 2, n/2 and n - 1 at eight directions.
template <class Real>
double errorOf(const std::string& name, int order, const Directions& directions, const Real* out) {
    std::map<std::pair<int, int>, double> largest, error;
    for (const std::size_t k : {0, 1, 2, 3, 4, 5, 6, 7})
        for (const int m : {0, 1, 2, order / 2, order - 1}) {
            if (m >= order || k >= directions.x.size()) continue;
            const auto truth =
                columns::values(name, order - 1, m,
                                columns::place(directions.x[k], directions.y[k], directions.z[k]));
            for (int l = m; l < order; ++l) {
                const auto exact = static_cast<double>(truth[static_cast<std::size_t>(l - m)]);
                const double value =
                    out[k * slotsOf(order) + static_cast<std::size_t>(slotOf(l, m))];
                double& most = largest[{l, m}];
                most = std::max(most, std::abs(exact));
                double& worst = error[{l, m}];
                worst = std::max(worst, std::abs(exact - value));
            }
        }
    double worst = 0;
    // Eight directions do not find every maximum; the mean square is 1 / 2 pi or 1 / 4 pi.
    for (const auto& [function, difference] : error)
        worst = std::max(worst, difference / std::max(largest[function], 0.3));
    return worst;
}

/// Times repeated calls of `fill(directions, out)`.
template <class Real, class Fill>
void measure(benchmark::State& state, const std::string& name, int order, std::size_t count,
             Fill fill) {
    const Directions directions(count);
    std::vector<Real> out(count * slotsOf(order));
    for (auto _ : state) {
        fill(directions, out.data());
        benchmark::DoNotOptimize(out.data());
        benchmark::ClobberMemory();
    }
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(count));
    if (!name.empty()) state.counters["error"] = errorOf(name, order, directions, out.data());
}

template <class Real>
void kernel(benchmark::State& state, const std::string& name, int order, std::int64_t target) {
    const auto basis = bases::make(name, order);
    hwy::SetSupportedTargetsForTest(target);
    measure<Real>(state, name, order, directionCount(order),
                  [&](const Directions& d, Real* out) { basis->evaluate(d.batch(), out); });
    hwy::SetSupportedTargetsForTest(0);
}

void bySlot(benchmark::State& state, const std::string& name, int order) {
    const auto basis = bases::make(name, order);
    measure<double>(state, {}, order, directionCount(order), [&](const Directions& d, double* out) {
        basis->evaluateColumns(d.batch(), out);
    });
}

void scalar(benchmark::State& state, const std::string& name, int order) {
    const auto basis = bases::make(name, order);
    const auto reference = scalarReference(dynamic_cast<const bases::JacobiBasis&>(*basis));
    measure<double>(state, name, order, directionCount(order),
                    [&](const Directions& d, double* out) { reference->evaluate(d.batch(), out); });
}

void onePerCall(benchmark::State& state, const std::string& name, int order) {
    const auto basis = bases::make(name, order);
    measure<double>(state, name, order, 64, [&](const Directions& d, double* out) {
        for (std::size_t k = 0; k < d.x.size(); ++k)
            basis->evaluate({d.x[k], d.y[k], d.z[k]}, out + k * slotsOf(order));
    });
}

template <class Real>
void writeBytes(benchmark::State& state, int order) {
    int value = 0;
    measure<Real>(state, {}, order, directionCount(order), [&](const Directions& d, Real* out) {
        std::memset(out, value++ & 127, d.x.size() * slotsOf(order) * sizeof(Real));
    });
}

/// GSL's normalised Legendre functions times powers of the azimuth.
void gsl(benchmark::State& state, int order) {
    const auto top = static_cast<std::size_t>(order - 1);
    std::vector<double> legendre(gsl_sf_legendre_array_n(top));
    measure<double>(state, "sh", order, directionCount(order), [&](const Directions& d, double* o) {
        for (std::size_t k = 0; k < d.x.size(); ++k, o += slotsOf(order)) {
            gsl_sf_legendre_array(GSL_SF_LEGENDRE_SPHARM, top, d.z[k], legendre.data());
            const double radius = std::sqrt(d.x[k] * d.x[k] + d.y[k] * d.y[k]);
            const double c = d.x[k] / radius, s = d.y[k] / radius;
            double re = 1, im = 0;
            for (int m = 0; m < order; ++m) {
                const double scale = m == 0 ? 1 : std::sqrt(2.0);
                for (int l = m; l < order; ++l) {
                    const double value = legendre[static_cast<std::size_t>(l * (l + 1) / 2 + m)];
                    o[slotOf(l, -m)] = value * scale * im;
                    o[slotOf(l, m)] = value * scale * re;
                }
                const double next = re * c - im * s;
                im = re * s + im * c;
                re = next;
            }
        }
    });
}

/// One call for each (l, m): theta(l, m, angle) for m >= 0, times cos and sin of m phi.
template <class Theta>
void byFunction(benchmark::State& state, int order, std::size_t count, Theta theta) {
    measure<double>(state, "sh", order, count, [&](const Directions& d, double* o) {
        for (std::size_t k = 0; k < d.x.size(); ++k, o += slotsOf(order)) {
            const double angle = std::acos(d.z[k]), phi = std::atan2(d.y[k], d.x[k]);
            for (int m = 0; m < order; ++m)
                for (int l = m; l < order; ++l) {
                    const double value =
                        theta(static_cast<unsigned>(l), m, angle) * (m == 0 ? 1 : std::sqrt(2.0));
                    o[slotOf(l, -m)] = value * std::sin(m * phi);
                    o[slotOf(l, m)] = value * std::cos(m * phi);
                }
        }
    });
}

template <class Function>
void add(const std::string& name, int order, Function function) {
    benchmark::RegisterBenchmark((name + "/" + std::to_string(order)).c_str(), function);
}

void addPeers(int order, bool slowOnes) {
    add("memset/double", order, [=](auto& s) { writeBytes<double>(s, order); });
    add("memset/float", order, [=](auto& s) { writeBytes<float>(s, order); });
    add("gsl", order, [=](auto& s) { gsl(s, order); });
    if (!slowOnes) return;
    add("std::sph_legendre", order, [=](auto& s) {
        byFunction(s, order, 64, [](unsigned l, int m, double angle) {
            return std::sph_legendre(l, static_cast<unsigned>(m), angle) * (m % 2 ? -1 : 1);
        });
    });
    add("boost", order, [=](auto& s) {
        byFunction(s, order, 8, [](unsigned l, int m, double angle) {
            return boost::math::spherical_harmonic_r(l, m, angle, 0.0) * (m % 2 ? -1 : 1);
        });
    });
}

}  // namespace

int main(int argc, char** argv) {
    const std::vector<std::string> families{"hsh",     "sh",        "esh",
                                            "zernike", "makhotkin", "makhotkin-flux"};
    for (const int order : {7, 10}) {
        addPeers(order, true);
        for (const std::string& name : families) {
            for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
                const std::string on = std::string("@") + hwy::TargetName(target);
                add(name + "/double" + on, order,
                    [=](auto& s) { kernel<double>(s, name, order, target); });
                add(name + "/float" + on, order,
                    [=](auto& s) { kernel<float>(s, name, order, target); });
            }
            add(name + "/columns", order, [=](auto& s) { bySlot(s, name, order); });
            add(name + "/scalar", order, [=](auto& s) { scalar(s, name, order); });
            add(name + "/one", order, [=](auto& s) { onePerCall(s, name, order); });
        }
    }
    for (const int order : {4, 8, 16, 32, 64, 128, 256}) {
        addPeers(order, false);
        for (const std::string name : {"hsh", "sh"}) {
            add(name + "/double", order, [=](auto& s) { kernel<double>(s, name, order, 0); });
            add(name + "/float", order, [=](auto& s) { kernel<float>(s, name, order, 0); });
            add(name + "/scalar", order, [=](auto& s) { scalar(s, name, order); });
        }
    }
    runInterleaved(argc, argv, 11, "0.005");
}
