// Shading by coefficients: 1,873 vertices (the teapot of Gautron et al. 2004), one isotropic
// material of order 10 in RGB by 32 elevations, light in the local frame of each vertex, one core.
// `frames` is the rate of frames. Views and light are random numbers: the work does not depend on
// them.

#include "interleaved.h"

#include <hshfit/bases/catalog.h>
#include <hshfit/transfer/shading.h>

#include <cmath>
#include <random>
#include <vector>

namespace {

using namespace hshfit;

constexpr std::size_t vertices = 1873, channels = 3;

struct Scene {
    Coefficients material;
    std::vector<float> z, cosine, sine, light, out;

    explicit Scene(int order) {
        material.basis = "hsh";
        material.order = order;
        material.quantity = Quantity::brdfCosine;
        material.channels = Channels::rgb();
        material.outgoing = OutgoingSet::elevations(32);
        material.isotropic = material.bilateral = true;
        std::mt19937 random(1);
        std::uniform_real_distribution<float> unit;
        material.values.resize(32 * channels * material.slots());
        for (double& value : material.values) value = unit(random);
        light.resize(channels * material.slots() * vertices);
        for (float& value : light) value = unit(random);
        for (std::size_t v = 0; v < vertices; ++v) {
            const float phi = 6.2831853f * unit(random);
            z.push_back(unit(random));
            cosine.push_back(std::cos(phi));
            sine.push_back(std::sin(phi));
        }
        out.resize(channels * vertices);
    }
    ShadingViews views() const { return {z.data(), cosine.data(), sine.data(), vertices}; }
};

void countFrames(benchmark::State& state) {
    state.counters["frames"] =
        benchmark::Counter(static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

/// Interpolated by elevation and turned by azimuth.
void table(benchmark::State& state) {
    Scene scene(static_cast<int>(state.range(0)));
    const ShadingTable shading(scene.material);
    for (auto _ : state) {
        shading.shade(scene.views(), scene.light.data(), scene.out.data());
        benchmark::DoNotOptimize(scene.out.data());
    }
    countFrames(state);
}

/// The same, vertex by vertex in double precision, by the lookup of the library.
void plain(benchmark::State& state) {
    Scene scene(static_cast<int>(state.range(0)));
    const int order = scene.material.order;
    const std::size_t slots = scene.material.slots();
    for (auto _ : state) {
        for (std::size_t v = 0; v < vertices; ++v) {
            const double side = std::sqrt(1 - static_cast<double>(scene.z[v]) * scene.z[v]);
            const OutgoingLookup found =
                lookUp(scene.material.outgoing,
                       {side * scene.cosine[v], side * scene.sine[v], scene.z[v]});
            for (std::size_t channel = 0; channel < channels; ++channel) {
                const float* light = scene.light.data() + channel * slots * vertices + v;
                double sum = 0;
                for (int m = 0; m < order; ++m) {
                    const double c = std::cos(m * found.turn), s = std::sin(m * found.turn);
                    for (int l = m; l < order; ++l) {
                        double value = 0;
                        for (int k = 0; k < found.count; ++k) {
                            value += found.weight[k] *
                                     scene.material.at(found.index[k], channel)[slotOf(l, m)];
                        }
                        sum += value * (c * light[slotOf(l, m) * vertices] +
                                        s * light[slotOf(l, -m) * vertices]);
                    }
                }
                scene.out[channel * vertices + v] = static_cast<float>(sum);
            }
        }
        benchmark::DoNotOptimize(scene.out.data());
    }
    countFrames(state);
}

/// Dot products alone, with one coefficient set for all vertices.
void dots(benchmark::State& state) {
    Scene scene(static_cast<int>(state.range(0)));
    const std::size_t slots = scene.material.slots();
    const std::vector<float> set(slots, 0.5f);
    for (auto _ : state) {
        for (std::size_t channel = 0; channel < channels; ++channel) {
            shade(set, scene.light.data() + channel * slots * vertices, vertices,
                  scene.out.data() + channel * vertices);
        }
        benchmark::DoNotOptimize(scene.out.data());
    }
    countFrames(state);
}

BENCHMARK(table)->Arg(3)->Arg(5)->Arg(10);
BENCHMARK(plain)->Arg(10);
BENCHMARK(dots)->Arg(10);

}  // namespace

int main(int argc, char** argv) {
    runInterleaved(argc, argv, 5, "0.1");
}
