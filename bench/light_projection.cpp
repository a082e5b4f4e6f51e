// Coefficients of a 2048 x 1024 latitude-longitude picture, R, G and B, on one thread:
// order 10 against one pass over its pixels (their sum, with the vectors of this processor);
// order 300 against libsharp's map2alm of the three channels on the same rings (Fejér weights,
// which take pixels for points; ours integrates them). Both sides run in turns; `ratio` is the
// median of ours over theirs.

#include <benchmark/benchmark.h>
#include <hshfit/light/internal/picture_spectra.h>
#include <hshfit/light/latlong_projection.h>
#include <libsharp/sharp_almhelpers.h>
#include <libsharp/sharp_cxx.h>
#include <libsharp/sharp_geomhelpers.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <complex>
#include <ctime>
#include <functional>
#include <random>
#include <vector>

namespace {

using namespace hshfit;

constexpr std::size_t width = 2048, height = 1024;

double cpuSeconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}
double timed(const std::function<void()>& work) {
    const double start = cpuSeconds();
    work();
    return cpuSeconds() - start;
}

std::vector<float> picture() {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> value(0, 2);
    std::vector<float> rgb(3 * width * height);
    for (float& each : rgb) each = value(random);
    return rgb;
}

void inTurns(benchmark::State& state, const std::function<void()>& own,
             const std::function<void()>& other) {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    std::vector<double> ratios;
    double others = 0;
    own();
    other();
    for (auto _ : state) {
        const double theirs = timed(other), ours = timed(own);
        state.SetIterationTime(ours);
        others += theirs;
        ratios.push_back(ours / theirs);
    }
    std::sort(ratios.begin(), ratios.end());
    state.counters["ratio"] = ratios[ratios.size() / 2];
    state.counters["other_seconds"] = others / static_cast<double>(ratios.size());
}

void project(const std::vector<float>& rgb, int order, std::vector<double>& out) {
    LatlongProjection projection(order, width, height);
    projection.addRows(rgb.data(), height);
    out.resize(3 * static_cast<std::size_t>(order) * static_cast<std::size_t>(order));
    projection.coefficients(0, out.data());
    benchmark::DoNotOptimize(out.data());
}

void againstOnePass(benchmark::State& state) {
    const std::vector<float> rgb = picture();
    std::vector<double> out;
    inTurns(
        state, [&] { project(rgb, static_cast<int>(state.range(0)), out); },
        [&] {
            double sum = 0;
            for (std::size_t row = 0; row < height; ++row)
                sum += sumPictureRow(rgb.data() + row * 3 * width, width);
            benchmark::DoNotOptimize(sum);
        });
}

void againstSharp(benchmark::State& state) {
    const std::vector<float> rgb = picture();
    const auto order = static_cast<int>(state.range(0));
    std::vector<double> out;
    std::vector<std::vector<double>> maps(3, std::vector<double>(width * height));
    for (std::size_t k = 0; k < width * height; ++k)
        for (std::size_t c = 0; c < 3; ++c) maps[c][k] = rgb[3 * k + c];
    sharp_geom_info* geometry = nullptr;
    sharp_alm_info* layout = nullptr;
    sharp_make_fejer1_geom_info(height, width, 0, 1, width, &geometry);
    sharp_make_triangular_alm_info(order - 1, order - 1, 1, &layout);
    std::vector<std::complex<double>> alm(static_cast<std::size_t>(sharp_alm_count(layout)));
    inTurns(
        state, [&] { project(rgb, order, out); },
        [&] {
            for (std::vector<double>& map : maps) {
                void *from = map.data(), *to = alm.data();
                sharp_execute(SHARP_MAP2ALM, 0, &to, &from, geometry, layout, SHARP_DP, nullptr,
                              nullptr);
            }
            benchmark::DoNotOptimize(alm.data());
        });
    sharp_destroy_geom_info(geometry);
    sharp_destroy_alm_info(layout);
}

BENCHMARK(againstOnePass)->Arg(10)->UseManualTime()->Iterations(31)->Unit(benchmark::kMillisecond);
BENCHMARK(againstSharp)
    ->Arg(10)
    ->Arg(100)
    ->Arg(300)
    ->UseManualTime()
    ->Iterations(9)
    ->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
