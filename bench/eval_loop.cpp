// f at a million pairs in memory, one at a time on one thread: the loop that bench/python_eval
// compares the Python module with.

#include <benchmark/benchmark.h>
#include <hshfit/brdf/uniform.h>

#include <brdfs/catalog.h>

#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace {

using namespace hshfit;

constexpr std::size_t count = 1000000;

std::vector<Direction> directions(std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::vector<Direction> found;
    for (std::size_t k = 0; k < count; ++k)
        found.push_back(
            directionFromAngles(std::acos(1 - uniform(random)), 2 * pi * uniform(random)));
    return found;
}

void loop(benchmark::State& state, const std::string& spec) {
    static const std::vector<Direction> wi = directions(1), wo = directions(2);
    const auto brdf = brdfs::open(spec);
    const std::size_t channels = brdf->channels().count();
    std::vector<double> values(count * channels);
    for (auto _ : state) {
        for (std::size_t k = 0; k < count; ++k)
            brdf->eval(wo[k], {&wi[k].x, &wi[k].y, &wi[k].z, 1}, values.data() + k * channels);
        benchmark::DoNotOptimize(values.data());
        benchmark::ClobberMemory();
    }
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(count));
}

}  // namespace

// The names are the specifications, which bench/python_eval reads.
int main(int argc, char** argv) {
    for (const char* spec : {"lambert", "phong:kd=.3/.2/.1,exponent=12", "ggx:alpha=0.3",
                             "disney:roughness=0.4", "preset:hsh-ward"})
        benchmark::RegisterBenchmark(spec, loop, spec)->Unit(benchmark::kMillisecond);
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}
