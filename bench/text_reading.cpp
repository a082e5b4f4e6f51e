// Numbers of a text file: our reader against one stream extraction per number, on the same bytes.
// The bytes are rows as Cornell's goniometer files have them.

#include <brdfs/measured/scattered/cornell.h>
#include <brdfs/measured/text_reader.h>

#include <benchmark/benchmark.h>

#include <cstdio>
#include <random>
#include <sstream>
#include <string>
#include <vector>

namespace {

/// 35 columns of 6 decimals as in Cornell's files, or 4 of 15 as ALTA writes them, or of 32 as in
/// one of its files.
std::string rows(int columns, int decimals, std::size_t bytes) {
    std::mt19937_64 engine(1);
    std::uniform_real_distribution<double> uniform;
    std::string text;
    char number[64];
    while (text.size() < bytes) {
        for (int column = 0; column < columns; ++column) {
            std::snprintf(number, sizeof number, "%s%.*f", column ? " " : "", decimals,
                          uniform(engine));
            text += number;
        }
        text += "\n";
    }
    return text;
}

constexpr std::size_t size = 8 << 20;

const std::string& theRows(benchmark::State& state) {
    static const std::string wide = rows(35, 6, size), narrow = rows(4, 15, size),
                             longer = rows(4, 32, size);
    return state.range(1) == 6 ? wide : (state.range(1) == 15 ? narrow : longer);
}

void setBytes(benchmark::State& state, const std::string& text) {
    state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * text.size()));
}

/// One extraction per number from one stream.
void streamExtraction(benchmark::State& state) {
    const std::string& text = theRows(state);
    for (auto _ : state) {
        std::istringstream stream(text);
        double sum = 0;
        for (double value; stream >> value;) sum += value;
        benchmark::DoNotOptimize(sum);
    }
    setBytes(state, text);
}

/// ALTA's way of reading: lines from a stream, a stream of each line, one extraction per number.
void streamPerLine(benchmark::State& state) {
    const std::string& text = theRows(state);
    for (auto _ : state) {
        std::istringstream stream(text);
        double sum = 0;
        for (std::string line; std::getline(stream, line);) {
            std::stringstream numbers(line);
            for (double value; numbers >> value;) sum += value;
        }
        benchmark::DoNotOptimize(sum);
    }
    setBytes(state, text);
}

void textReader(benchmark::State& state) {
    const std::string& text = theRows(state);
    for (auto _ : state) {
        hshfit::brdfs::TextReader reader(text, "memory");
        double sum = 0;
        while (reader.next()) {
            for (double value; reader.takeNumber(value);) sum += value;
        }
        benchmark::DoNotOptimize(sum);
    }
    setBytes(state, text);
}

/// The whole reader: numbers, checks, directions, census.
void cornellReader(benchmark::State& state) {
    std::string text = "31\n";
    for (int nm = 400; nm <= 700; nm += 10) text += std::to_string(nm) + " ";
    text += "\n" + theRows(state);
    for (auto _ : state) {
        benchmark::DoNotOptimize(hshfit::brdfs::readCornell(text, "memory").size());
    }
    setBytes(state, text);
}

BENCHMARK(streamExtraction)
    ->Args({35, 6})
    ->Args({4, 15})
    ->Args({4, 32})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(streamPerLine)
    ->Args({35, 6})
    ->Args({4, 15})
    ->Args({4, 32})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(textReader)->Args({35, 6})->Args({4, 15})->Args({4, 32})->Unit(benchmark::kMillisecond);
BENCHMARK(cornellReader)->Args({35, 6})->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
