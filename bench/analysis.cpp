// Coefficients of 1024 functions on the Gauss x equispaced grid, against libsharp's analysis in a
// loop over the functions: SH on the sphere, order = degree + 1 rings, the next multiple of 4 above
// twice the degree as azimuths, double precision, one thread. HSH on its own grid over the
// hemisphere has the same shape and cost. Errors are relative, after a synthesis of known
// coefficients, in the largest norm.

#include <benchmark/benchmark.h>
#include <hshfit/bases/catalog.h>
#include <hshfit/projection/analysis.h>
#include <hshfit/quadrature/quadrature.h>
#include <libsharp/sharp_almhelpers.h>
#include <libsharp/sharp_cxx.h>
#include <libsharp/sharp_geomhelpers.h>

#include <cmath>
#include <complex>
#include <ctime>
#include <random>
#include <string>
#include <vector>

namespace {

using namespace hshfit;

constexpr std::size_t functions = 1024;

double cpuSeconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// A few distinct functions, repeated: their values do not change the work, but memory traffic
/// has to be that of 1024 functions.
struct Problem {
    std::string basisName;
    std::unique_ptr<Basis> basis;
    Analysis analysis;
    std::vector<double> exact, samples, out;

    Problem(const std::string& name, int degree)
        : basisName(name),
          basis(bases::make(name, degree + 1)),
          analysis(*basis, AnalysisGrid::gauss(static_cast<std::size_t>(degree + 1),
                                               static_cast<std::size_t>(2 * degree + 4) / 4 * 4,
                                               name == "sh")),
          out(functions * static_cast<std::size_t>(basis->slots())) {
        std::mt19937_64 random(1);
        std::normal_distribution<double> normal;
        exact.resize(static_cast<std::size_t>(basis->slots()));
        for (double& value : exact) value = normal(random);
        const std::vector<double> one = synthesised();
        for (std::size_t f = 0; f < functions; ++f)
            samples.insert(samples.end(), one.begin(), one.end());
    }

    std::vector<double> synthesised() const {
        const AnalysisGrid& grid = analysis.grid();
        const int order = basis->order();
        std::vector<double> values(grid.points());
        const std::size_t rings = grid.elevations.size();
        std::vector<double> theta(static_cast<std::size_t>(order) * rings);
        for (int m = 0; m < order; ++m) {
            basis->theta(m, grid.elevations, theta.data());
            std::vector<double> cosine(rings), sine(rings);
            for (int l = m; l < order; ++l) {
                for (std::size_t r = 0; r < rings; ++r) {
                    const double t = theta[static_cast<std::size_t>(l - m) * rings + r];
                    cosine[r] += t * exact[static_cast<std::size_t>(slotOf(l, m))];
                    sine[r] += m ? t * exact[static_cast<std::size_t>(slotOf(l, -m))] : 0;
                }
            }
            for (std::size_t r = 0; r < rings; ++r) {
                for (std::size_t j = 0; j < grid.azimuths; ++j) {
                    const double phi = (static_cast<double>(j) + 0.5) * 2 * pi /
                                       static_cast<double>(grid.azimuths);
                    const double norm = 1 / std::sqrt(m ? pi : 2 * pi);
                    values[r * grid.azimuths + j] +=
                        norm * (cosine[r] * std::cos(m * phi) + sine[r] * std::sin(m * phi));
                }
            }
        }
        return values;
    }

    double run() {
        const double start = cpuSeconds();
        analysis.run(samples.data(), functions, out.data());
        return cpuSeconds() - start;
    }

    double error() const {
        double most = 0, largest = 0;
        for (std::size_t k = 0; k < exact.size(); ++k) {
            most = std::max(most, std::abs(out[k] - exact[k]));
            largest = std::max(largest, std::abs(exact[k]));
        }
        return most / largest;
    }
};

/// libsharp's rings run from the north pole, with azimuths from any phi0: our grid, turned.
struct Sharp {
    sharp_geom_info* geometry = nullptr;
    sharp_alm_info* layout = nullptr;
    std::vector<std::complex<double>> alm;
    int degree;

    Sharp(int degreeIn, int azimuths) : degree(degreeIn) {
        const auto phi0 = pi / azimuths;
        sharp_make_gauss_geom_info(degree + 1, azimuths, phi0, 1, azimuths, &geometry);
        sharp_make_triangular_alm_info(degree, degree, 1, &layout);
        alm.resize(static_cast<std::size_t>(sharp_alm_count(layout)));
    }
    ~Sharp() {
        sharp_destroy_geom_info(geometry);
        sharp_destroy_alm_info(layout);
    }
    Sharp(const Sharp&) = delete;
    Sharp& operator=(const Sharp&) = delete;

    double run(const Problem& problem) {
        const double start = cpuSeconds();
        for (std::size_t f = 0; f < functions; ++f) {
            auto* map =
                const_cast<double*>(problem.samples.data()) + f * problem.analysis.grid().points();
            void *from = map, *to = alm.data();
            sharp_execute(SHARP_MAP2ALM, 0, &to, &from, geometry, layout, SHARP_DP, nullptr,
                          nullptr);
        }
        return cpuSeconds() - start;
    }

    /// The error against the same coefficients. libsharp's first ring is at the north pole, ours at
    /// the south pole: coefficients with odd l + m change sign. a_{l,m} are complex, with the
    /// Condon-Shortley phase.
    double error(const Problem& problem) const {
        double most = 0, largest = 0;
        for (int m = 0; m <= degree; ++m) {
            for (int l = m; l <= degree; ++l) {
                const auto a = alm[static_cast<std::size_t>(sharp_alm_index(layout, l, m))];
                const double flip = (l + m) % 2 ? -1 : 1, phase = m % 2 ? -1 : 1;
                const double scale = flip * phase * (m ? std::sqrt(2.0) : 1.0);
                const auto check = [&](double value, int slot) {
                    const double exact = problem.exact[static_cast<std::size_t>(slot)];
                    most = std::max(most, std::abs(value - exact));
                    largest = std::max(largest, std::abs(exact));
                };
                check(scale * a.real(), slotOf(l, m));
                if (m > 0) check(-scale * a.imag(), slotOf(l, -m));
            }
        }
        return most / largest;
    }
};

/// Both run in turns, so that they share the machine's state. The time is ours; `ratio` is ours
/// over libsharp's.
void againstSharp(benchmark::State& state, const char* name) {
    const int degree = static_cast<int>(state.range(0));
    Problem problem(name, degree);
    Problem sphere("sh", degree);
    Sharp sharp(degree, static_cast<int>(problem.analysis.grid().azimuths));
    std::vector<double> ratios;
    double sharpSeconds = 0;
    for (auto _ : state) {
        const double theirs = sharp.run(sphere), own = problem.run();
        state.SetIterationTime(own);
        sharpSeconds += theirs;
        ratios.push_back(own / theirs);
    }
    std::sort(ratios.begin(), ratios.end());
    state.counters["ratio"] = ratios[ratios.size() / 2];
    state.counters["sharp_seconds"] = sharpSeconds / static_cast<double>(ratios.size());
    state.counters["error"] = problem.error();
    state.counters["sharp_error"] = sharp.error(sphere);
    state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * functions));
}

BENCHMARK_CAPTURE(againstSharp, sh, "sh")
    ->Arg(9)
    ->Arg(32)
    ->Arg(64)
    ->Arg(128)
    ->UseManualTime()
    ->Iterations(7)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(againstSharp, hsh, "hsh")
    ->Arg(9)
    ->Arg(32)
    ->Arg(64)
    ->Arg(128)
    ->UseManualTime()
    ->Iterations(7)
    ->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
