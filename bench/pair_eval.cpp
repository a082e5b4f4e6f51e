// f for pairs of directions, from every form of a coefficient file, against the multiply-adds of
// the network with which Sztrajman et al. (2021) represent an isotropic material: 6-21-21-3, 630
// weights without biases, evaluated in batch by Eigen.

#include "network.h"

#include "interleaved.h"

#include <benchmark/benchmark.h>
#include <hshfit/representation/forms/form.h>
#include <hshfit/representation/forms/pair_evaluators.h>

#include <brdfs/catalog.h>

#include <cmath>
#include <map>
#include <random>
#include <string>
#include <vector>

namespace {

using namespace hshfit;

constexpr std::size_t pairCount = 4096;
/// Coloured and isotropic materials, like most measured ones.
constexpr const char* material = "phong:kd=.3/.2/.1,ks=.2/.3/.4,exponent=12";
constexpr std::size_t channels = 3;

struct Directions {
    std::vector<double> x, y, z;

    explicit Directions(unsigned seed) {
        std::mt19937_64 random(seed);
        std::uniform_real_distribution<double> uniform;
        for (std::size_t k = 0; k < pairCount; ++k) {
            const Direction d =
                directionFromAngles(std::acos(1 - uniform(random)), 2 * pi * uniform(random));
            x.push_back(d.x);
            y.push_back(d.y);
            z.push_back(d.z);
        }
    }
    DirectionBatch batch() const { return {x.data(), y.data(), z.data(), z.size()}; }
    DirectionBatch one(std::size_t k) const { return {&x[k], &y[k], &z[k], 1}; }
};

const Directions& incoming() {
    static const Directions instance(1);
    return instance;
}
const Directions& outgoing() {
    static const Directions instance(2);
    return instance;
}

/// Evaluators are cached, so that repetitions time the evaluation only.
const PairEvaluator& evaluatorOf(const Form& form) {
    static std::map<std::string, std::unique_ptr<PairEvaluator>> made;
    std::unique_ptr<PairEvaluator>& evaluator = made[optionsOf(form)];
    if (!evaluator) {
        const auto brdf = brdfs::open(material);
        const BrdfOpener open = [](const std::string& spec) { return brdfs::open(spec); };
        evaluator = pairEvaluator(represent(*brdf, form, open), open);
    }
    return *evaluator;
}

void batch(benchmark::State& state, const Form& form) {
    const PairEvaluator& evaluator = evaluatorOf(form);
    std::vector<float> out(channels * pairCount);
    for (auto _ : state) {
        evaluator.evaluate(incoming().batch(), outgoing().batch(), out.data());
        benchmark::DoNotOptimize(out.data());
        benchmark::ClobberMemory();
    }
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(pairCount));
}

void single(benchmark::State& state, const Form& form) {
    const PairEvaluator& evaluator = evaluatorOf(form);
    std::vector<float> out(channels);
    std::size_t k = 0;
    for (auto _ : state) {
        evaluator.evaluate(incoming().one(k), outgoing().one(k), out.data());
        benchmark::DoNotOptimize(out.data());
        k = (k + 1) % pairCount;
    }
    state.SetItemsProcessed(state.iterations());
}

void network(benchmark::State& state) {
    const Network net(static_cast<std::size_t>(state.range(0)));
    std::vector<float> in(Network::inputs * pairCount, 0.5F), out(channels * pairCount);
    if (!Network::supported()) return state.SkipWithError("no AVX2 on this machine");
    for (auto _ : state) {
        net.evaluate(in.data(), pairCount, out.data());
        benchmark::DoNotOptimize(out.data());
        benchmark::ClobberMemory();
    }
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(pairCount));
}

/// Isotropic, RGB; orders 7 unless the name says otherwise.
std::map<std::string, Form> formsTimed() {
    Form sets;
    sets.outgoing = "16";
    Form both;
    both.kind = Representation::Kind::basis;
    Form halfway;
    halfway.kind = Representation::Kind::halfway;
    std::map<std::string, Form> all{{"outgoing16", sets}, {"basis", both}, {"halfway", halfway}};
    for (const char* basis : {"zernike", "makhotkin"}) {
        sets.basis = both.basis = basis;
        all.emplace(std::string("outgoing16_") + basis, sets);
        all.emplace(std::string("basis_") + basis, both);
    }
    sets.basis = "hsh";
    sets.rank = 2;
    all.emplace("outgoing16_rank2", sets);
    sets.rank = 0;
    sets.order = 10;
    all.emplace("outgoing16_order10", sets);
    return all;
}

}  // namespace

int main(int argc, char** argv) {
    for (const int block : {64, 256, 1024, 4096}) {
        benchmark::RegisterBenchmark("network", network)->Arg(block);
    }
    for (const auto& [name, form] : formsTimed()) {
        benchmark::RegisterBenchmark(("batch/" + name).c_str(), batch, form);
        benchmark::RegisterBenchmark(("single/" + name).c_str(), single, form);
    }
    runInterleaved(argc, argv, 9, "0.02");
}
