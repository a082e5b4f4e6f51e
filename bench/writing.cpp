// The time to write and read back the result of the default job (32x32 outgoing directions, HSH
// of order 7, f cos) against that of its projection: one thread, CPU time of the process, the
// steps in turns, medians. `json_write` and the like are seconds; `json_ratio` and `exr_ratio`
// the time of writing over that of the projection of the same turn.

#include "bench_folder.h"

#include <benchmark/benchmark.h>
#include <brdfs/catalog.h>
#include <hshfit/bases/catalog.h>
#include <hshfit/coefficient_files/coefficient_file.h>
#include <hshfit/projection/projection.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <string>
#include <vector>

namespace {

using namespace hshfit;

double cpuSeconds() {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

template <class Step>
double secondsOf(Step step) {
    const double start = cpuSeconds();
    step();
    return cpuSeconds() - start;
}

double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, middle);
    return *middle;
}

/// One form of the coefficient file: times of every turn, and the error after reading it back.
struct FileForm {
    std::string name, path;
    std::vector<double> write = {}, read = {}, ratio = {};
    double error = 0;

    void turn(const Coefficients& made, double projectionSeconds) {
        Coefficients back;
        write.push_back(secondsOf([&] { writeCoefficients(made, path); }));
        read.push_back(secondsOf([&] { back = readCoefficients(path); }));
        ratio.push_back(write.back() / projectionSeconds);
        double largest = 0, most = 0;
        for (std::size_t k = 0; k < made.values.size(); ++k) {
            largest = std::max(largest, std::abs(made.values[k]));
            most = std::max(most, std::abs(made.values[k] - back.values.at(k)));
        }
        error = most / largest;
    }

    void report(benchmark::UserCounters& counters) const {
        counters[name + "_write"] = median(write);
        counters[name + "_read"] = median(read);
        counters[name + "_ratio"] = median(ratio);
        counters[name + "_error"] = error;
        counters[name + "_bytes"] = static_cast<double>(std::filesystem::file_size(path));
    }
};

/// The time of an iteration is that of the projection.
void defaultJob(benchmark::State& state, const std::string& spec) {
    const tbb::global_control oneThread(tbb::global_control::max_allowed_parallelism, 1);
    const BenchFolder folder;
    std::array forms{FileForm{.name = "json", .path = (folder.path / "job.json").string()},
                     FileForm{.name = "exr", .path = (folder.path / "job.exr").string()}};
    const auto brdf = brdfs::open(spec);
    const auto basis = bases::make("hsh", 7);
    const OutgoingSet outgoing = OutgoingSet::parse("32x32");
    const std::array<const Basis*, 1> bases{basis.get()};
    std::vector<double> projecting;
    for (auto _ : state) {
        std::vector<Projection> made;
        projecting.push_back(secondsOf(
            [&] { made = project(*brdf, bases, outgoing, {.quantity = Quantity::brdfCosine}); }));
        for (FileForm& form : forms) form.turn(made[0].coefficients, projecting.back());
        state.SetIterationTime(projecting.back());
    }
    state.counters["projection"] = median(projecting);
    for (const FileForm& form : forms) form.report(state.counters);
}

void job(const char* name, const char* spec) {
    benchmark::RegisterBenchmark(name, defaultJob, std::string(spec))
        ->UseManualTime()
        ->Iterations(21)
        ->Unit(benchmark::kMillisecond);
}

}  // namespace

int main(int argc, char** argv) {
    job("defaultJob/ward", "ward:kd=0,ks=1,ax=0.2,ay=0.5");
    job("defaultJob/ggx_rgb", "ggx:alpha=0.3,F0=0.9/0.6/0.3");
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
}
