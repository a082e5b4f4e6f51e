// Products of coefficient vectors: the tensor of triple products and its number of entries, one
// product by the tensor, by an exact grid, and the transfer matrix of a factor.

#include "interleaved.h"

#include <hshfit/bases/catalog.h>
#include <hshfit/transfer/products.h>
#include <hshfit/transfer/triple_products.h>

#include <random>
#include <string>
#include <vector>

namespace {

using namespace hshfit;

std::vector<double> randomVector(std::size_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    std::vector<double> values(count);
    for (double& value : values) value = normal(random);
    return values;
}

struct Problem {
    std::unique_ptr<Basis> basis;
    std::vector<double> a, b;

    Problem(const benchmark::State& state, const char* name)
        : basis(bases::make(name, static_cast<int>(state.range(0)))),
          a(randomVector(static_cast<std::size_t>(basis->slots()), 1)),
          b(randomVector(a.size(), 2)) {}
};

void tensor(benchmark::State& state, const char* name) {
    const Problem problem(state, name);
    std::size_t entries = 0;
    for (auto _ : state) entries = TripleProducts(*problem.basis).entries().size();
    state.counters["entries"] = static_cast<double>(entries);
}

void byTensor(benchmark::State& state, const char* name) {
    const Problem problem(state, name);
    const TripleProducts products(*problem.basis);
    std::vector<double> out(problem.a.size());
    for (auto _ : state) {
        products.multiply(problem.a, problem.b, out.data());
        benchmark::DoNotOptimize(out.data());
    }
}

void byGrid(benchmark::State& state, const char* name) {
    const Problem problem(state, name);
    double truncation = 0;
    for (auto _ : state) {
        truncation =
            multiplied(*problem.basis, *problem.basis, problem.a, *problem.basis, problem.b)
                .truncation;
    }
    state.counters["truncation"] = truncation;
}

void matrix(benchmark::State& state, const char* name) {
    const Problem problem(state, name);
    for (auto _ : state) {
        benchmark::DoNotOptimize(transferMatrix(*problem.basis, *problem.basis, problem.a));
    }
}

void registerAll() {
    const std::pair<const char*, void (*)(benchmark::State&, const char*)> functions[] = {
        {"tensor", tensor}, {"byTensor", byTensor}, {"byGrid", byGrid}, {"matrix", matrix}};
    for (const auto& [name, function] : functions) {
        for (const char* basis : {"sh", "hsh"}) {
            const auto call = function;
            auto* added = benchmark::RegisterBenchmark(
                (std::string(name) + "/" + basis).c_str(),
                [call, basis](benchmark::State& state) { call(state, basis); });
            for (const int order : {5, 10, 20}) added->Arg(order)->Unit(benchmark::kMicrosecond);
        }
    }
}

}  // namespace

int main(int argc, char** argv) {
    registerAll();
    runInterleaved(argc, argv, 3, "0.05");
}
