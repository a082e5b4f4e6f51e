// Table 1 of Gautron et al. 2004 as a ratio: lighting 1,873 vertices, each with a frame and a
// coefficient set of its own, by RGB light in spherical harmonics of the world, on one core. The
// light is rotated into each frame, converted to the basis of the material, and multiplied.
//     sh         rotation and product
//     hsh        the light of each vertex is converted by C (Eq. 18)
//     hsh_folded C is in the material, whose sets are multiplied by its transpose once
// Light, frames and sets are random numbers: the work does not depend on them.

#include "interleaved.h"

#include <hshfit/bases/catalog.h>
#include <hshfit/coefficients/coefficients.h>
#include <hshfit/rotation/basis_change.h>
#include <hshfit/rotation/sh_rotation.h>
#include <hshfit/transfer/shading.h>

#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <vector>

namespace {

using namespace hshfit;

constexpr std::size_t vertices = 1873, channels = 3;

/// An element of C, or of its transpose.
struct Element {
    std::size_t to, from;
    float value;
};

std::vector<Element> elementsOf(const BasisChange& change) {
    std::vector<Element> elements;
    for (int m = 1 - change.toOrder(); m < change.toOrder(); ++m) {
        const std::vector<double> block = change.block(std::abs(m));
        const int first = std::abs(m), count = change.fromOrder() - first;
        for (int l = first; l < change.toOrder(); ++l) {
            for (int k = first; k < change.fromOrder(); ++k) {
                const double value =
                    block[static_cast<std::size_t>((l - first) * count + k - first)];
                if (std::abs(value) < 1e-12) continue;
                elements.push_back({static_cast<std::size_t>(slotOf(l, m)),
                                    static_cast<std::size_t>(slotOf(k, m)),
                                    static_cast<float>(value)});
            }
        }
    }
    return elements;
}

/// The vertices and the steps that the ways share.
struct Scene {
    int order;
    std::size_t slots;
    ShRotation rotation;
    std::vector<Element> change;
    std::vector<Rotation> frames;
    std::vector<double> world, turned;
    std::vector<float> sets, folded, light, converted, out;

    explicit Scene(int n)
        : order(n),
          slots(static_cast<std::size_t>(n) * static_cast<std::size_t>(n)),
          rotation(n),
          change(elementsOf(BasisChange(*bases::make("sh", n), *bases::make("hsh", n)))),
          sets(slots * vertices),
          folded(slots * vertices),
          light(channels * slots * vertices),
          converted(slots * vertices),
          out(channels * vertices) {
        std::mt19937 random(1);
        std::uniform_real_distribution<double> unit(-1, 1);
        std::vector<double> one(channels * slots);
        for (double& value : one) value = unit(random);
        for (std::size_t v = 0; v < vertices; ++v) {
            frames.push_back(
                Rotation::euler(pi * unit(random), pi * unit(random), pi * unit(random)));
            world.insert(world.end(), one.begin(), one.end());
        }
        turned.resize(world.size());
        for (float& value : sets) value = static_cast<float>(unit(random));
        for (const Element& c : change) {
            for (std::size_t v = 0; v < vertices; ++v)
                folded[c.from * vertices + v] += c.value * sets[c.to * vertices + v];
        }
    }

    /// The light of every vertex in its frame, slot by slot.
    void rotate() {
        rotation.rotate(frames, channels, world.data(), turned.data());
        constexpr std::size_t tile = 64;
        for (std::size_t c = 0; c < channels; ++c) {
            for (std::size_t first = 0; first < vertices; first += tile) {
                const std::size_t last = std::min(first + tile, vertices);
                for (std::size_t j = 0; j < slots; ++j) {
                    for (std::size_t v = first; v < last; ++v) {
                        light[(c * slots + j) * vertices + v] =
                            static_cast<float>(turned[(v * channels + c) * slots + j]);
                    }
                }
            }
        }
    }
    void multiply(const std::vector<float>& material) {
        for (std::size_t c = 0; c < channels; ++c) {
            shade(slots, material.data(), light.data() + c * slots * vertices, vertices,
                  out.data() + c * vertices);
        }
    }
    void convertAndMultiply() {
        for (std::size_t c = 0; c < channels; ++c) {
            const float* given = light.data() + c * slots * vertices;
            std::fill(converted.begin(), converted.end(), 0.0F);
            for (const Element& e : change) {
                float* to = converted.data() + e.to * vertices;
                const float* from = given + e.from * vertices;
                for (std::size_t v = 0; v < vertices; ++v) to[v] += e.value * from[v];
            }
            shade(slots, sets.data(), converted.data(), vertices, out.data() + c * vertices);
        }
    }
};

template <class Step>
void run(benchmark::State& state, Step step) {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    Scene scene(static_cast<int>(state.range(0)));
    // Both ways of HSH give the same sums.
    scene.rotate();
    scene.convertAndMultiply();
    const std::vector<float> expected = scene.out;
    scene.multiply(scene.folded);
    for (std::size_t k = 0; k < expected.size(); ++k) {
        if (std::abs(scene.out[k] - expected[k]) > 1e-3F) {
            state.SkipWithError("the two ways of HSH differ");
            return;
        }
    }
    for (auto _ : state) {
        scene.rotate();
        step(scene);
        benchmark::DoNotOptimize(scene.out.data());
    }
    state.counters["vertices"] = benchmark::Counter(
        static_cast<double>(state.iterations() * vertices), benchmark::Counter::kIsRate);
}

void sh(benchmark::State& state) {
    run(state, [](Scene& scene) { scene.multiply(scene.sets); });
}
void hsh(benchmark::State& state) {
    run(state, [](Scene& scene) { scene.convertAndMultiply(); });
}
void hshFolded(benchmark::State& state) {
    run(state, [](Scene& scene) { scene.multiply(scene.folded); });
}

void orders(benchmark::internal::Benchmark* which) {
    for (const int order : {2, 3, 5, 8, 10}) which->Arg(order);
}
BENCHMARK(sh)->Apply(orders);
BENCHMARK(hsh)->Apply(orders);
BENCHMARK(hshFolded)->Name("hsh_folded")->Apply(orders);

}  // namespace

int main(int argc, char** argv) {
    runInterleaved(argc, argv, 15, "0.02");
}
