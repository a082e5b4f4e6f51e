// The speed of reading binary files from the page cache: open one, count every stored value
// (the census of `info`), close it. The files are synthetic and of the sizes of real ones, but
// for MIT's, which has a sixth of the size. Pictures are compressed; their bytes are those of
// the decompressed numbers.

#include "bench_folder.h"

#include <brdfs/catalog.h>
#include <brdfs/measured/gridded/slice_writer.h>
#include <brdfs/measured/measured_brdf.h>
#include <brdfs/measured/merl_writer.h>

#include <benchmark/benchmark.h>
#include <brdfs/tensor_writer.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using hshfit::brdfs::MeasuredBrdf;

std::string fileNamed(const std::string& name) {
    static const BenchFolder folder;
    return folder.path / name;
}

template <class Number>
void append(std::ofstream& file, const std::vector<Number>& numbers) {
    file.write(reinterpret_cast<const char*>(numbers.data()),
               static_cast<std::streamsize>(numbers.size() * sizeof(Number)));
}

/// Opens and counts; `bytes` of numbers, or as many as the file has if 0.
void read(benchmark::State& state, const std::string& path, std::uintmax_t bytes = 0) {
    if (bytes == 0) bytes = std::filesystem::file_size(path);
    std::uint64_t values = 0;
    for (auto _ : state) {
        const auto brdf = hshfit::brdfs::open(path);
        const auto* measured = dynamic_cast<const MeasuredBrdf*>(brdf.get());
        if (!measured) throw std::logic_error(path + " is not a measured BRDF");
        values += measured->census().values;
        brdf->checkIntact();
    }
    benchmark::DoNotOptimize(values);
    state.SetBytesProcessed(static_cast<std::int64_t>(bytes) * state.iterations());
}

void merl(benchmark::State& state) {
    const std::string path = fileNamed("ggx.binary");
    hshfit::brdfs::writeMerl(*hshfit::brdfs::open("ggx:alpha=0.1"), path, {.force = true});
    read(state, path);
}

// Anisotropic, of the sizes of RGL's anisotropic RGB files.
void rgl(benchmark::State& state) {
    const std::string path = fileNamed("synthetic.bsdf");
    hshfit::test::RglShape shape{.phi = {},
                                 .theta = {},
                                 .normalRows = 128,
                                 .normalColumns = 128,
                                 .colourRows = 32,
                                 .colourColumns = 32};
    for (int i = 0; i < 9; ++i) {
        shape.phi.push_back(1.5707964F * static_cast<float>(i) / 8);
    }
    for (int i = 0; i < 8; ++i) shape.theta.push_back(1.57F * static_cast<float>(i) / 7);
    const std::string bytes = hshfit::test::tensorFile(hshfit::test::rglFields(shape));
    std::ofstream(path, std::ios::binary)
        .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    read(state, path);
}

void utia(benchmark::State& state) {
    const std::string path = fileNamed("table.bin");
    std::vector<double> values(3 * 288 * 288);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<double>(i % 1000);
    std::ofstream file(path, std::ios::binary);
    append(file, values);
    file.close();
    read(state, path);
}

void mit(benchmark::State& state) {
    const std::string path = fileNamed("table.dat");
    std::ofstream file(path, std::ios::binary);
    append(file, std::vector<std::int32_t>{45, 45, 30, 90, 0, 0, 1, 0, 0, 0, 3, 0, 0, 0, 0, 0});
    std::vector<float> plane(45 * 45 * 30 * 90);
    for (std::size_t i = 0; i < plane.size(); ++i) plane[i] = static_cast<float>(i % 1000) - 50;
    for (int c = 0; c < 3; ++c) append(file, plane);
    file.close();
    read(state, path);
}

void merlSlice(benchmark::State& state) {
    const std::string path = fileNamed("table.slice");
    std::ofstream file(path, std::ios::binary);
    append(file, std::vector<float>(90 * 90 * 3, 0.25F));
    file.close();
    read(state, path);
}

void slicePicture(benchmark::State& state) {
    const std::string path = fileNamed("slices.exr");
    hshfit::brdfs::writeSlices(*hshfit::brdfs::open("ggx:alpha=0.1,F0=0.9/0.5/0.2"), path, {},
                               {.force = true});
    read(state, path, 512 * 512 * 3 * sizeof(float));
}

BENCHMARK(merl)->Unit(benchmark::kMillisecond);
BENCHMARK(rgl)->Unit(benchmark::kMillisecond);
BENCHMARK(utia)->Unit(benchmark::kMillisecond);
BENCHMARK(mit)->Unit(benchmark::kMillisecond);
BENCHMARK(merlSlice)->Unit(benchmark::kMillisecond);
BENCHMARK(slicePicture)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
