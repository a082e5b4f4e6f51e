// A MERL-layout table of all valid cells fitted with a Lambert term and one lobe: reading and
// weighting the cells, and the fit itself. CPU time is that of all threads.
#include <brdfs/catalog.h>
#include <brdfs/fit/fit.h>
#include <brdfs/rows/spec.h>

#include <benchmark/benchmark.h>
#include <unistd.h>

#include <filesystem>
#include <memory>
#include <string>

namespace {

using namespace hshfit;
using namespace hshfit::brdfs;

/// A table of a BRDF that none of the fitted models is, in a file that goes with the program.
class Table {
public:
    Table()
        : path_(std::filesystem::temp_directory_path() /
                ("hshfit-bench-fit-" + std::to_string(::getpid()) + ".binary")) {
        const auto brdf =
            open("lambert:kd=.2/.1/.05 + abc:A=20,B=900,C=.9,ior=1.4,variant=microfacet");
        for (const Writer& writer : writers())
            if (writer.name == "merl")
                writer.write(*brdf, path_, parseParameters("merl", writer.parameters, ""), {});
    }
    ~Table() { std::filesystem::remove(path_); }
    const std::string& path() const { return path_; }

private:
    std::string path_;
};

const std::string& tablePath() {
    static const Table table;
    return table.path();
}

void gather(benchmark::State& state) {
    const auto brdf = open(tablePath());
    for (auto _ : state) benchmark::DoNotOptimize(gatherSamples(*brdf, {}).size());
}
BENCHMARK(gather)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

void fitTable(benchmark::State& state, const std::string& model, std::size_t most) {
    const FitSamples samples = gatherSamples(*open(tablePath()), {.most = most});
    double loss = 0;
    for (auto _ : state) loss = fit(samples, {.model = model}).loss;
    state.counters["cells"] = static_cast<double>(samples.size());
    state.counters["rms"] = loss;
}
BENCHMARK_CAPTURE(fitTable, ggx, "lambert+ggx", 0)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(fitTable, ggx_100000, "lambert+ggx", 100000)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(fitTable, ward, "lambert+ward", 0)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(fitTable, beckmann, "lambert+beckmann", 0)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(fitTable, blinn_phong_by_differences, "lambert+blinn-phong:normalized=true", 0)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();

}  // namespace

BENCHMARK_MAIN();
