// From an isotropic MERL-layout file to a coefficient file with the program itself: 32 x 32
// outgoing directions, or 16 elevations, x RGB, HSH of order 7, one thread. CPU time and peak
// memory are the kernel's, process start included. The program writes the file, too, which is
// then in the page cache.

#include <benchmark/benchmark.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

struct Cost {
    double cpuSeconds = 0;
    double peakMegabytes = 0;
    bool ok = false;
};

double seconds(const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

/// Runs the program. The kernel counts this process's peak memory for a child too, until the
/// child has started; this process therefore has to stay small.
Cost run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), HSHFIT_PROGRAM);
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    pid_t child = 0;
    if (posix_spawn(&child, HSHFIT_PROGRAM, nullptr, nullptr, argv.data(), environ) != 0) return {};
    int status = 0;
    rusage usage{};
    if (wait4(child, &status, 0, &usage) != child) return {};
    return {.cpuSeconds = seconds(usage.ru_utime) + seconds(usage.ru_stime),
            .peakMegabytes = 1024e-6 * static_cast<double>(usage.ru_maxrss),
            .ok = WIFEXITED(status) && WEXITSTATUS(status) == 0};
}

/// A folder for the files of this run, removed at the end.
struct Folder {
    fs::path path;
    Folder() {
        std::string name = (fs::temp_directory_path() / "hshfit-bench-XXXXXX").string();
        if (!mkdtemp(name.data())) std::abort();
        path = name;
    }
    ~Folder() {
        std::error_code ignored;
        fs::remove_all(path, ignored);
    }
};

void project(benchmark::State& state, const char* output, std::vector<std::string> options) {
    static const Folder folder;
    const fs::path file = folder.path / "ggx.binary";
    if (!fs::exists(file) && !run({"convert", "ggx:alpha=0.3", file, "--quiet"}).ok)
        return state.SkipWithError("the program could not write a MERL-layout file");
    std::vector<std::string> arguments = {"project",   file,  "-o",      folder.path / output,
                                          "--basis",   "hsh", "--order", "7",
                                          "--threads", "1",   "--quiet"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    double peak = 0;
    std::vector<double> times;
    for (auto _ : state) {
        const Cost cost = run(arguments);
        if (!cost.ok) return state.SkipWithError("the projection failed");
        state.SetIterationTime(cost.cpuSeconds);
        times.push_back(cost.cpuSeconds);
        peak = std::max(peak, cost.peakMegabytes);
    }
    std::sort(times.begin(), times.end());
    state.counters["median_s"] = times[times.size() / 2];
    // The program without work: the time of loading and linking.
    const Cost start = run({"project", "--help"});
    state.counters["start_s"] = start.cpuSeconds;
    state.counters["peak_mb"] = peak;
    state.counters["file_mb"] = 1e-6 * static_cast<double>(fs::file_size(file));
}

BENCHMARK_CAPTURE(project, brdf_json, "out.json", {})->UseManualTime()->Unit(benchmark::kSecond);
BENCHMARK_CAPTURE(project, brdf_exr, "out.exr", {})->UseManualTime()->Unit(benchmark::kSecond);
BENCHMARK_CAPTURE(project, elevations_json, "elevations.json", {"--outgoing", "16"})
    ->UseManualTime()
    ->Unit(benchmark::kSecond);
BENCHMARK_CAPTURE(project, cosine_json, "cosine.json", {"--cosine"})
    ->UseManualTime()
    ->Unit(benchmark::kSecond);

}  // namespace

BENCHMARK_MAIN();
