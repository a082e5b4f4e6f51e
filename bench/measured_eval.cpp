// The time for one RGB value of a measured BRDF, on one thread: batches of one outgoing direction
// and a grid over all incoming ones, for 110 outgoing elevations. The MERL file is a GGX lobe; the
// RGL files are synthetic, of the sizes of the isotropic RGL files, and of an anisotropic one with
// five azimuths of a quarter of the circle. `rglScalar` is RglBrdf::evalScalar, without vectors.

#include "bench_folder.h"

#include <brdfs/catalog.h>
#include <brdfs/measured/merl_writer.h>
#include <brdfs/measured/rgl.h>

#include <benchmark/benchmark.h>
#include <brdfs/tensor_writer.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace {

using hshfit::Direction;

const BenchFolder& folder() {
    static const BenchFolder only;
    return only;
}

std::string merlPath() {
    const std::string path = folder().path / "ggx.binary";
    if (!std::filesystem::exists(path)) {
        hshfit::brdfs::writeMerl(*hshfit::brdfs::open("ggx:alpha=0.1"), path, {});
    }
    return path;
}

std::string rglPath(bool isotropic = true) {
    const std::string path = folder().path / (isotropic ? "isotropic.bsdf" : "anisotropic.bsdf");
    hshfit::test::RglShape shape{.theta = {},
                                 .normalRows = 128,
                                 .normalColumns = 128,
                                 .colourRows = 32,
                                 .colourColumns = 32};
    for (int i = 0; i < 8; ++i) shape.theta.push_back(1.57F * static_cast<float>(i) / 7);
    if (!isotropic) {
        shape.phi.clear();
        for (int i = 0; i < 5; ++i)
            shape.phi.push_back(static_cast<float>(-hshfit::pi + i * hshfit::pi / 8));
    }
    const std::string bytes = hshfit::test::tensorFile(hshfit::test::rglFields(shape));
    std::ofstream(path, std::ios::binary)
        .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return path;
}

/// wi over the whole hemisphere, or around one direction, where the cells stay in the cache.
enum class Incoming { everywhere, lobe };

void evaluate(benchmark::State& state, const std::string& spec,
              Incoming incoming = Incoming::everywhere, bool scalar = false) {
    const auto brdf = hshfit::brdfs::open(spec);
    const auto* rgl = dynamic_cast<const hshfit::brdfs::RglBrdf*>(brdf.get());
    constexpr int elevations = 150, azimuths = 200, outgoing = 110;
    std::vector<double> x, y, z;
    for (int i = 0; i < elevations; ++i) {
        for (int k = 0; k < azimuths; ++k) {
            double theta = (i + 0.5) / elevations * hshfit::pi / 2;
            double phi = (k + 0.5) / azimuths * 2 * hshfit::pi;
            if (incoming == Incoming::lobe) {
                theta = 0.5 + theta / 16;
                phi /= 32;
            }
            const Direction wi = hshfit::directionFromAngles(theta, phi);
            x.push_back(wi.x);
            y.push_back(wi.y);
            z.push_back(wi.z);
        }
    }
    std::vector<double> out(3 * x.size());
    for (auto _ : state) {
        for (int i = 0; i < outgoing; ++i) {
            const Direction wo =
                hshfit::directionFromAngles((i + 0.3) / outgoing * hshfit::pi / 2, 0);
            const hshfit::DirectionBatch wi{x.data(), y.data(), z.data(), x.size()};
            if (scalar)
                rgl->evalScalar(wo, wi, out.data());
            else
                brdf->eval(wo, wi, out.data());
            benchmark::DoNotOptimize(out.data());
        }
    }
    brdf->checkIntact();
    const double values = static_cast<double>(x.size()) * outgoing;
    state.counters["per_rgb_value"] = benchmark::Counter(
        values, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void merlLinear(benchmark::State& state) {
    evaluate(state, merlPath());
}
void merlLinearInALobe(benchmark::State& state) {
    evaluate(state, merlPath(), Incoming::lobe);
}
void merlNearest(benchmark::State& state) {
    evaluate(state, merlPath() + ":interpolation=nearest");
}
void rgl(benchmark::State& state) {
    evaluate(state, rglPath());
}
void rglScalar(benchmark::State& state) {
    evaluate(state, rglPath(), Incoming::everywhere, true);
}
void rglAnisotropic(benchmark::State& state) {
    evaluate(state, rglPath(false));
}
void rglAnisotropicScalar(benchmark::State& state) {
    evaluate(state, rglPath(false), Incoming::everywhere, true);
}

BENCHMARK(merlLinear)->Unit(benchmark::kMillisecond);
BENCHMARK(merlLinearInALobe)->Unit(benchmark::kMillisecond);
BENCHMARK(merlNearest)->Unit(benchmark::kMillisecond);
BENCHMARK(rgl)->Unit(benchmark::kMillisecond);
BENCHMARK(rglScalar)->Unit(benchmark::kMillisecond);
BENCHMARK(rglAnisotropic)->Unit(benchmark::kMillisecond);
BENCHMARK(rglAnisotropicScalar)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
