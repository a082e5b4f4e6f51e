#pragma once

#include <benchmark/benchmark.h>

#include <string>
#include <vector>

/// Runs the registered benchmarks in short repetitions that take turns, so that other load of
/// the machine affects all of them, and reports their medians. Flags of the command line take
/// precedence.
inline void runInterleaved(int argc, char** argv, int repetitions, const std::string& minTime) {
    std::vector<std::string> all{argv[0], "--benchmark_enable_random_interleaving=true",
                                 "--benchmark_repetitions=" + std::to_string(repetitions),
                                 "--benchmark_min_time=" + minTime,
                                 "--benchmark_report_aggregates_only=true"};
    all.insert(all.end(), argv + 1, argv + argc);
    std::vector<char*> arguments;
    for (std::string& argument : all) arguments.push_back(argument.data());
    int count = static_cast<int>(arguments.size());
    benchmark::Initialize(&count, arguments.data());
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
}
