// The limits of the machine on one core: the floors that docs/results/performance.md measures the
// library against.
//     fma      independent chains of a x + b in registers, on each instruction set: items are
//              floating-point operations, two for each lane and step
//     product  Eigen's matrix product (machine_product.h), items as above: what a projection
//              without folding would multiply, 1024 directions x 10,000 points x 49 functions,
//              and 512 x 512 x 512
//     memory   bytes written by memset, read and written by a copy, read by a sum, these two in
//              vectors (memcpy falls to a tenth where source and target differ by whole pages, as
//              large buffers do); in buffers that fit into the first and the second cache, and that
//              exceed the last

#define HWY_TARGET_INCLUDE "bench/machine_lanes.h"
#include <brdfs/lanes/each_target.h>

#include "machine_product.h"

#include "interleaved.h"

#include <benchmark/benchmark.h>
#include <hwy/targets.h>
#include <unistd.h>

#include <cstring>
#include <string>
#include <vector>

namespace {

HWY_EXPORT(fmaChainsDouble);
HWY_EXPORT(fmaChainsFloat);
HWY_EXPORT(sumOf);
HWY_EXPORT(copyOf);

void fmaDouble(benchmark::State& state, std::int64_t target) {
    hwy::SetSupportedTargetsForTest(target);
    double operations = 0;
    for (auto _ : state) operations += HWY_DYNAMIC_DISPATCH(fmaChainsDouble)();
    state.SetItemsProcessed(static_cast<std::int64_t>(operations));
    hwy::SetSupportedTargetsForTest(0);
}

void fmaFloat(benchmark::State& state, std::int64_t target) {
    hwy::SetSupportedTargetsForTest(target);
    double operations = 0;
    for (auto _ : state) operations += HWY_DYNAMIC_DISPATCH(fmaChainsFloat)();
    state.SetItemsProcessed(static_cast<std::int64_t>(operations));
    hwy::SetSupportedTargetsForTest(0);
}

struct Sizes {
    std::int64_t rows, inner, columns;
};

template <class Real>
void product(benchmark::State& state, const Sizes& sizes) {
    if (!productSupported()) return state.SkipWithError("no AVX2 and FMA on this machine");
    const auto count = [](std::int64_t a, std::int64_t b) {
        return static_cast<std::size_t>(a * b);
    };
    const std::vector<Real> left(count(sizes.rows, sizes.inner), Real(0.5));
    const std::vector<Real> right(count(sizes.inner, sizes.columns), Real(0.25));
    std::vector<Real> out(count(sizes.rows, sizes.columns));
    for (auto _ : state) {
        multiply(left.data(), right.data(), sizes.rows, sizes.inner, sizes.columns, out.data());
        benchmark::DoNotOptimize(out.data());
        benchmark::ClobberMemory();
    }
    state.SetItemsProcessed(state.iterations() * 2 * sizes.rows * sizes.inner * sizes.columns);
}

/// The size of a buffer, two of which fill half of the cache. If the system does not report its
/// caches, sizes of common machines are used.
std::size_t share(int name, std::size_t usual) {
    const long bytes = sysconf(name);
    return (bytes > 0 ? static_cast<std::size_t>(bytes) : usual) / 4;
}

void set(benchmark::State& state, std::size_t bytes) {
    std::vector<double> to(bytes / sizeof(double));
    int value = 0;
    for (auto _ : state) {
        std::memset(to.data(), value++ & 127, bytes);
        benchmark::DoNotOptimize(to.data());
        benchmark::ClobberMemory();
    }
    state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(bytes));
}

void copy(benchmark::State& state, std::size_t bytes) {
    std::vector<double> from(bytes / sizeof(double), 1.0), to(bytes / sizeof(double));
    for (auto _ : state) {
        HWY_DYNAMIC_DISPATCH(copyOf)(from.data(), from.size(), to.data());
        benchmark::DoNotOptimize(to.data());
        benchmark::ClobberMemory();
    }
    state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(2 * bytes));
}

void read(benchmark::State& state, std::size_t bytes) {
    const std::vector<double> from(bytes / sizeof(double), 1.0);
    for (auto _ : state) {
        benchmark::DoNotOptimize(HWY_DYNAMIC_DISPATCH(sumOf)(from.data(), from.size()));
        benchmark::ClobberMemory();
    }
    state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(bytes));
}

void add(const std::string& name, auto function) {
    benchmark::RegisterBenchmark(name.c_str(), function);
}

}  // namespace

int main(int argc, char** argv) {
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
        const std::string on = hwy::TargetName(target);
        add("fma/double@" + on, [=](auto& state) { fmaDouble(state, target); });
        add("fma/float@" + on, [=](auto& state) { fmaFloat(state, target); });
    }
    for (const Sizes& sizes : {Sizes{1024, 10'000, 49}, {512, 512, 512}}) {
        const std::string shape = std::to_string(sizes.rows) + "x" + std::to_string(sizes.inner) +
                                  "x" + std::to_string(sizes.columns);
        add("product/double/" + shape, [=](auto& state) { product<double>(state, sizes); });
        add("product/float/" + shape, [=](auto& state) { product<float>(state, sizes); });
    }
    const std::pair<const char*, std::size_t> places[] = {
        {"first", share(_SC_LEVEL1_DCACHE_SIZE, 1 << 15)},
        {"second", share(_SC_LEVEL2_CACHE_SIZE, 1 << 19)},
        {"memory", 16 * share(_SC_LEVEL3_CACHE_SIZE, 1 << 25)}};
    for (const auto& [place, bytes] : places) {
        const std::string in = std::string("/") + place;
        add("memset" + in, [bytes = bytes](auto& state) { set(state, bytes); });
        add("copy" + in, [bytes = bytes](auto& state) { copy(state, bytes); });
        add("sum" + in, [bytes = bytes](auto& state) { read(state, bytes); });
    }
    runInterleaved(argc, argv, 9, "0.02");
}
