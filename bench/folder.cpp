// A folder of ten materials through the program itself, `project FOLDER -o DIR`, with one thread
// and with two: wall time, in turns. The program writes MERL-layout files of GGX from rough to
// glossy, so that the last file is not the quickest.

#include "bench_folder.h"

#include <benchmark/benchmark.h>
#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

constexpr int materials = 10;

bool run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), HSHFIT_PROGRAM);
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    pid_t child = 0;
    const int failed = posix_spawn(&child, HSHFIT_PROGRAM, &actions, nullptr, argv.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    int status = 0;
    return !failed && waitpid(child, &status, 0) == child && WIFEXITED(status) &&
           WEXITSTATUS(status) == 0;
}

bool prepare(const fs::path& folder) {
    for (int i = 0; i < materials; ++i) {
        const std::string alpha = std::to_string(0.6 - 0.05 * i);
        const fs::path file = folder / ("ggx-" + std::to_string(i) + ".binary");
        if (!fs::exists(file) && !run({"convert", "ggx:alpha=" + alpha, file, "--quiet"}))
            return false;
    }
    return true;
}

double seconds(const fs::path& inputs, const fs::path& outputs, int threads, bool& ok) {
    const auto start = std::chrono::steady_clock::now();
    ok = run({"project", inputs, "-o", outputs, "--threads", std::to_string(threads), "--quiet"});
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void folderOfTen(benchmark::State& state) {
    const BenchFolder folder;
    const fs::path inputs = folder.path / "in", outputs = folder.path / "out";
    fs::create_directory(inputs);
    if (!prepare(inputs)) return state.SkipWithError("the program could not write the materials");
    std::vector<double> ratios, ones;
    for (auto _ : state) {
        bool ok = true, okToo = true;
        const double one = seconds(inputs, outputs, 1, ok);
        const double two = seconds(inputs, outputs, 2, okToo);
        if (!ok || !okToo) return state.SkipWithError("the projection failed");
        state.SetIterationTime(two);
        ones.push_back(one);
        ratios.push_back(one / two);
    }
    std::sort(ratios.begin(), ratios.end());
    std::sort(ones.begin(), ones.end());
    state.counters["materials"] = materials;
    state.counters["one_thread_s"] = ones[ones.size() / 2];
    state.counters["speedup"] = ratios[ratios.size() / 2];
    state.counters["speedup_least"] = ratios.front();
    state.counters["speedup_most"] = ratios.back();
}

BENCHMARK(folderOfTen)->UseManualTime()->Iterations(5)->Unit(benchmark::kSecond);

}  // namespace

BENCHMARK_MAIN();
