// Writing a map of 2048 x 2048 materials, order-4 HSH over 8 elevations in float16 with all levels
// (2.86 GB), from parameters in memory: one parameter on which two lobes depend, as ggx with maps
// of kd, ks and alpha. On all threads; items are texels of level 0.
// - kernel: coefficients in float32, row after row over the same memory.
// - encoded: the bytes of all levels, into memory that is used again: the same work as `file`
//   without the file.
// - disk: those bytes, prepared once, past the page cache (0) or through it (1).
// - file: the whole, past the page cache or through it.

#include "bench_folder.h"

#include <hshfit/bases/catalog.h>
#include <hshfit/each_in_parallel.h>
#include <hshfit/material_maps/internal/tile_work.h>
#include <hshfit/material_maps/lobe_texels.h>
#include <hshfit/material_maps/map_writer.h>

#include <benchmark/benchmark.h>
#include <tbb/enumerable_thread_specific.h>

#include <cmath>
#include <fstream>

namespace {

using namespace hshfit;

constexpr std::size_t side = 2048, bandRows = 64;

/// Lobes that are smooth in a parameter: what they are does not matter to the clock.
LobeFunction lobes(const TexelLayout& layout) {
    LobeFunction function{.axes = {{.name = "alpha", .low = 0.1, .high = 0.9}},
                          .lobes = 2,
                          .length = layout.shape(),
                          .weights = std::vector<double>(layout.shape(), 1.0)};
    function.at = [length = layout.shape()](std::span<const double> p) {
        std::vector<double> values;
        for (std::size_t k = 0; k < 2 * length; ++k)
            values.push_back(std::cos(0.1 * static_cast<double>(k) + p[0]) * std::exp(-p[0]));
        return values;
    };
    return function;
}

class Rows final : public ParameterRows {
public:
    std::size_t width() const override { return side; }
    std::size_t height() const override { return side; }
    std::vector<TexelBlock> read(std::size_t top, std::size_t bottom) override {
        std::vector<TexelBlock> rows;
        for (std::size_t row = top; row < bottom; ++row) {
            TexelBlock block{.count = side};
            for (std::size_t k = 0; k < 6 * side; ++k)
                block.weights.push_back(static_cast<float>((k * 37 + row * 11) % 256) / 255);
            for (std::size_t k = 0; k < side; ++k)
                block.places.push_back(0.1F + static_cast<float>((k * 7 + row * 3) % 200) / 250);
            rows.push_back(std::move(block));
        }
        return rows;
    }
};

struct Map {
    std::unique_ptr<Basis> basis = bases::make("hsh", 4);
    TexelLayout layout = texelLayout(*basis, OutgoingSet::elevations(8), 3, true);
    LobeGrid grid{lobes(layout)};
    Rows rows;
    LobeTexels texels{rows, grid, layout, false};
    PlainEncoder encoder{layout, gpu::Number::float16};
    std::vector<LevelSize> sizes = levelSizes(side, side);
};

void report(benchmark::State& state, std::size_t bytes) {
    state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * side * side));
    state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * bytes));
}

void kernel(benchmark::State& state) {
    Map map;
    const auto band = map.texels.band(0, bandRows);
    tbb::enumerable_thread_specific<std::vector<float>> rows(64 * map.layout.floats());
    for (auto _ : state) {
        eachInParallel(side * side / 64 / bandRows, [&](std::size_t column) {
            for (std::size_t row = 0; row < bandRows; ++row)
                band->texels(row, column % (side / 64) * 64, 64, rows.local().data());
            benchmark::DoNotOptimize(rows.local().data());
        });
    }
    report(state, side * side * map.layout.floats() * sizeof(float));
}

void encoded(benchmark::State& state) {
    Map map;
    const auto band = map.texels.band(0, bandRows);
    constexpr std::size_t levels = 7, texelBytes = 8;
    std::vector<EncodedLevel> bytes(levels);
    std::size_t total = 0;
    for (std::size_t level = 0; level < levels; ++level) {
        bytes[level].width = side >> level;
        bytes[level].rows = bandRows >> level;
        bytes[level].texelBytes = texelBytes;
        bytes[level].reserve(map.layout.layers());
        total += bytes[level].pitch() * map.layout.layers();
    }
    std::vector<float> errors(side * bandRows);
    tbb::enumerable_thread_specific<TileWork> tiles(
        [&] { return TileWork(map.encoder, map.layout.floats(), levels); });
    for (auto _ : state) {
        for (std::size_t top = 0; top < side; top += bandRows) {
            eachInParallel(side / TileWork::side, [&](std::size_t k) {
                tiles.local().make(*band,
                                   {.rows = bandRows, .column = k * TileWork::side, .columns = 64},
                                   {.levels = bytes, .errors = errors.data()});
            });
        }
    }
    report(state, total * (side / bandRows));
}

/// A new file for all levels.
LevelFile fileOf(const Map& map, const BenchFolder& folder, bool pastPageCache) {
    const std::string path = (folder.path / "map.ktx2").string();
    std::filesystem::remove(path);
    std::ofstream(path).close();
    return {path, gpu::Number::float16, map.layout.layers(), map.sizes,
            LevelFileOptions{.pastPageCache = pastPageCache}};
}

void disk(benchmark::State& state) {
    Map map;
    const BenchFolder folder;
    PageBuffer bytes;
    const std::size_t band = bandRows * side * map.layout.layers() * 8;
    bytes.reserve(band);
    std::fill_n(bytes.data(), band, std::byte{42});
    std::size_t total = 0;
    for (auto _ : state) {
        state.PauseTiming();
        LevelFile file = fileOf(map, folder, state.range(0) == 0);
        state.ResumeTiming();
        file.begin();
        for (std::size_t level = 0; level < map.sizes.size(); ++level) {
            const std::size_t rows = std::min(bandRows, map.sizes[level].height);
            const std::size_t size = rows * map.sizes[level].width * file.bytesOfTexel();
            for (std::size_t top = 0; top < map.sizes[level].height; top += rows)
                file.write(level, top, rows, bytes.first(size));
        }
        total = file.bytes();
    }
    report(state, total);
}

void file(benchmark::State& state) {
    Map map;
    const BenchFolder folder;
    Processes alone;
    const BandPlan plan = planBands(map.sizes, 512, std::size_t{1} << 30);
    std::size_t total = 0;
    for (auto _ : state) {
        state.PauseTiming();
        LevelFile file = fileOf(map, folder, state.range(0) == 0);
        state.ResumeTiming();
        writeMap(map.texels, map.encoder, file, plan, alone);
        total = file.bytes();
    }
    report(state, total);
}

BENCHMARK(kernel)->UseRealTime()->MeasureProcessCPUTime()->Unit(benchmark::kMillisecond);
BENCHMARK(encoded)->UseRealTime()->MeasureProcessCPUTime()->Unit(benchmark::kMillisecond);
BENCHMARK(disk)->DenseRange(0, 1)->UseRealTime()->MeasureProcessCPUTime()->Unit(
    benchmark::kMillisecond);
BENCHMARK(file)->DenseRange(0, 1)->UseRealTime()->MeasureProcessCPUTime()->Unit(
    benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
