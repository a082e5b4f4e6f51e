// Rotation of coefficients of spherical harmonics on one core.
//     batch/…  10,000 vectors of order 10, each under a rotation of its own: the library on each
//              instruction set, the textbook recurrence (ivanic_ruedenberg.h), and as many
//              multiply-adds in registers as the products of the bands' matrices and the vectors
//              have (the sum of (2l+1)^2), which leaves out the making of the matrices; a copy of
//              the 8 MB, which exceed the second cache; as many rotations of vectors that do not
//     one/…    one vector of order 300: the library with and without the making of its tables, and
//              rotate_alm of HEALPix
// `error` is the largest difference from the library's direct route, relative to the vector's norm.

#define HWY_TARGET_INCLUDE "bench/machine_lanes.h"
#include <brdfs/lanes/each_target.h>

#include "interleaved.h"
#include "ivanic_ruedenberg.h"

#include <alm_powspec_tools.h>
#include <benchmark/benchmark.h>
#include <hshfit/rotation/band_matrix.h>
#include <hshfit/rotation/sh_rotation.h>
#include <hwy/targets.h>
#include <omp.h>
#include <tbb/global_control.h>

#include <alm.h>
#include <xcomplex.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

namespace {

using namespace hshfit;

HWY_EXPORT(fmaChainsDouble);

constexpr int batchOrder = 10, oneOrder = 300;
constexpr std::size_t batchCount = 10'000;

struct Batch {
    std::vector<Rotation> rotations;
    std::vector<double> in, out;

    Batch(std::size_t count, int order)
        : in(count * static_cast<std::size_t>(order * order)), out(in.size()) {
        std::mt19937_64 engine(1);
        std::normal_distribution<double> normal;
        for (std::size_t k = 0; k < count; ++k)
            rotations.push_back(Rotation::fromQuaternion(normal(engine), normal(engine),
                                                         normal(engine), normal(engine)));
        for (double& value : in) value = normal(engine);
    }

    /// The error of the first vector.
    double error(int order) const {
        double worst = 0, norm = 0;
        for (int l = 0; l < order; ++l) {
            const std::vector<double> d = bandMatrix(l, rotations[0]);
            const int width = 2 * l + 1;
            for (int i = 0; i < width; ++i) {
                double sum = 0;
                for (int j = 0; j < width; ++j)
                    sum += d[static_cast<std::size_t>(i * width + j)] *
                           in[static_cast<std::size_t>(l * l + j)];
                worst = std::max(worst, std::abs(sum - out[static_cast<std::size_t>(l * l + i)]));
                norm += sum * sum;
            }
        }
        return worst / std::sqrt(norm);
    }
};

void batchByLibrary(benchmark::State& state, std::int64_t target) {
    hwy::SetSupportedTargetsForTest(target);
    Batch batch(batchCount, batchOrder);
    const ShRotation rotate(batchOrder);
    for (auto _ : state) {
        rotate.rotate(batch.rotations, 1, batch.in.data(), batch.out.data());
        benchmark::ClobberMemory();
    }
    state.counters["error"] = batch.error(batchOrder);
    hwy::SetSupportedTargetsForTest(0);
}

/// The input is rotated again and again; rotations keep its size.
void batchInPlace(benchmark::State& state) {
    Batch batch(batchCount, batchOrder);
    const ShRotation rotate(batchOrder);
    for (auto _ : state) {
        rotate.rotate(batch.rotations, 1, batch.in.data(), batch.in.data());
        benchmark::ClobberMemory();
    }
}

/// The same number of rotations of 200 vectors, which stay in the second cache.
void batchInCache(benchmark::State& state) {
    Batch batch(200, batchOrder);
    const ShRotation rotate(batchOrder);
    for (auto _ : state) {
        for (std::size_t done = 0; done < batchCount; done += 200)
            rotate.rotate(batch.rotations, 1, batch.in.data(), batch.out.data());
        benchmark::ClobberMemory();
    }
}

void batchCopy(benchmark::State& state) {
    Batch batch(batchCount, batchOrder);
    for (auto _ : state) {
        std::memcpy(batch.out.data(), batch.in.data(), batch.in.size() * sizeof(double));
        benchmark::DoNotOptimize(batch.out.data());
        benchmark::ClobberMemory();
    }
}

void batchByTextbook(benchmark::State& state) {
    Batch batch(batchCount, batchOrder);
    IvanicRuedenberg peer;
    for (auto _ : state) {
        for (std::size_t k = 0; k < batchCount; ++k)
            peer.rotate(batch.rotations[k], batchOrder, &batch.in[k * 100], &batch.out[k * 100]);
        benchmark::ClobberMemory();
    }
    state.counters["error"] = batch.error(batchOrder);
}

void batchMultiplyAdds(benchmark::State& state, std::int64_t target) {
    hwy::SetSupportedTargetsForTest(target);
    double wanted = 0;
    for (int l = 0; l < batchOrder; ++l) wanted += 2.0 * (2 * l + 1) * (2 * l + 1) * batchCount;
    double operations = 0;  // counted over all iterations: calls are coarse
    for (auto _ : state)
        for (double left = wanted; left > 0;) {
            const double done = HWY_DYNAMIC_DISPATCH(fmaChainsDouble)();
            left -= done;
            operations += done;
        }
    state.counters["surplus"] = operations / (wanted * static_cast<double>(state.iterations())) - 1;
    hwy::SetSupportedTargetsForTest(0);
}

void oneByLibrary(benchmark::State& state, bool tables) {
    Batch one(1, oneOrder);
    ShRotation rotate(oneOrder);
    for (auto _ : state) {
        if (tables) rotate = ShRotation(oneOrder);
        rotate.rotate(one.rotations, 1, one.in.data(), one.out.data());
        benchmark::ClobberMemory();
    }
    state.counters["error"] = one.error(oneOrder);
}

/// HEALPix keeps complex coefficients of m >= 0 with the Condon-Shortley sign.
void oneByHealpix(benchmark::State& state) {
    Batch one(1, oneOrder);
    Alm<xcomplex<double>> from(oneOrder - 1, oneOrder - 1);
    for (int l = 0; l < oneOrder; ++l)
        for (int m = 0; m <= l; ++m) {
            const double* at = &one.in[static_cast<std::size_t>(l * (l + 1))];
            const double scale = (m % 2 == 0 ? 1 : -1) / std::sqrt(2.0);
            from(l, m) = m == 0 ? xcomplex<double>(at[0], 0)
                                : xcomplex<double>(scale * at[m], -scale * at[-m]);
        }
    const Rotation::Turns t = one.rotations[0].turns();
    const double psi = std::atan2(t.sinGamma, t.cosGamma), theta = std::atan2(t.sinBeta, t.cosBeta),
                 phi = std::atan2(t.sinAlpha, t.cosAlpha);
    Alm<xcomplex<double>> alm = from;
    for (auto _ : state) {
        alm = from;
        rotate_alm(alm, psi, theta, phi);
        benchmark::ClobberMemory();
    }
    for (int l = 0; l < oneOrder; ++l)
        for (int m = 0; m <= l; ++m) {
            double* at = &one.out[static_cast<std::size_t>(l * (l + 1))];
            const double scale = (m % 2 == 0 ? 1 : -1) * std::sqrt(2.0);
            at[m] = m == 0 ? alm(l, 0).real() : scale * alm(l, m).real();
            if (m > 0) at[-m] = -scale * alm(l, m).imag();
        }
    state.counters["error"] = one.error(oneOrder);
}

void add(const std::string& name, auto function) {
    benchmark::RegisterBenchmark(name.c_str(), function)->Unit(benchmark::kMillisecond);
}

}  // namespace

int main(int argc, char** argv) {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    omp_set_num_threads(1);
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
        const std::string on = hwy::TargetName(target);
        add("batch/library@" + on, [=](auto& state) { batchByLibrary(state, target); });
        add("batch/multiply-adds@" + on, [=](auto& state) { batchMultiplyAdds(state, target); });
    }
    add("batch/in place", batchInPlace);
    add("batch/in cache", batchInCache);
    add("batch/copy", batchCopy);
    add("batch/textbook", batchByTextbook);
    add("one/library", [](auto& state) { oneByLibrary(state, false); });
    add("one/library with tables", [](auto& state) { oneByLibrary(state, true); });
    add("one/healpix", oneByHealpix);
    runInterleaved(argc, argv, 9, "0.05");
}
