// The projection against a straightforward Monte Carlo projection at equal error, in one process on
// one thread: the anisotropic Ward BRDF of the HSH paper, f cos, 32 x 32 outgoing directions, HSH
// of order 7.
//
// Monte Carlo draws uniform directions over the hemisphere and evaluates every basis function per
// sample as printed in Gautron et al. 2004, Eqs. 3-9, with the normalisation tabulated beforehand.
// The second, stronger Monte Carlo shares one set of directions and basis values, from this
// library's batch evaluation, between all outgoing directions. Their errors are measured at a fixed
// number of samples on a subset of the outgoing directions and extrapolated by 1/sqrt(N).

#include <benchmark/benchmark.h>
#include <brdfs/catalog.h>
#include <hshfit/bases/catalog.h>
#include <hshfit/projection/projection.h>
#include <tbb/global_control.h>

#include <array>
#include <cmath>
#include <ctime>
#include <memory>
#include <random>
#include <vector>

namespace {

using namespace hshfit;

constexpr int order = 7;
constexpr int slots = order * order;
constexpr std::size_t samples = 1 << 16;
/// Every 17th of the 1024 outgoing directions, which covers both rows and columns.
constexpr std::size_t stride = 17;

/// CPU seconds of this process: other programs on the machine do not count.
double cpuSeconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

struct Problem {
    std::unique_ptr<Brdf> brdf = brdfs::open("ward:kd=0,ks=1,ax=0.2,ay=0.5");
    std::unique_ptr<Basis> basis = bases::make("hsh", order);
    OutgoingSet outgoing = OutgoingSet::parabolic(32, 32);
    Coefficients reference = projected(1e-9).coefficients;

    Projection projected(double tolerance) const {
        const Basis* one[] = {basis.get()};
        ProjectionOptions options;
        options.quantity = Quantity::brdfCosine;
        options.tolerance = tolerance;
        return project(*brdf, one, outgoing, options)[0];
    }
};

const Problem& problem() {
    static const Problem instance;
    return instance;
}

/// Sums squared differences from the reference with the directions' solid angles.
class RelativeError {
public:
    void add(std::size_t outgoing, const double* values) {
        const double* exact = problem().reference.at(outgoing, 0);
        const double weight = problem().outgoing.solidAngles[outgoing];
        for (int k = 0; k < slots; ++k) {
            difference_ += weight * (values[k] - exact[k]) * (values[k] - exact[k]);
            norm_ += weight * exact[k] * exact[k];
        }
    }
    double value() const { return std::sqrt(difference_ / norm_); }

private:
    double difference_ = 0, norm_ = 0;
};

struct Directions {
    std::vector<double> x, y, z;

    Directions(std::size_t count, std::mt19937_64& random) : x(count), y(count), z(count) {
        std::uniform_real_distribution<double> uniform;
        for (std::size_t k = 0; k < count; ++k) {
            const double mu = 1 - uniform(random);
            const double phi = 2 * pi * uniform(random);
            x[k] = std::sqrt(1 - mu * mu) * std::cos(phi);
            y[k] = std::sqrt(1 - mu * mu) * std::sin(phi);
            z[k] = mu;
        }
    }
    DirectionBatch batch() const { return {x.data(), y.data(), z.data(), z.size()}; }
};

/// Eq. 3-9: K_l^m with its factor sqrt(2) for m != 0, without the Condon-Shortley phase.
std::array<double, slots> normalisation() {
    std::array<double, slots> k{};
    for (int l = 0; l < order; ++l)
        for (int m = -l; m <= l; ++m)
            k[slotOf(l, m)] =
                std::sqrt((m == 0 ? 1 : 2) * (2 * l + 1) * std::tgamma(l - std::abs(m) + 1) /
                          (2 * pi * std::tgamma(l + std::abs(m) + 1)));
    return k;
}

/// H_l^m(theta, phi) = K P_l^m(2 cos(theta) - 1) {cos(m phi), sin(|m| phi)}.
double textbookBasis(int l, int m, double mu, double phi, double k) {
    const int absM = std::abs(m);
    const double azimuthPart = m < 0 ? std::sin(absM * phi) : std::cos(absM * phi);
    return k * std::assoc_legendre(l, absM, 2 * mu - 1) * azimuthPart;
}

void textbookMonteCarlo(const Direction& wo, std::mt19937_64& random, double* coefficients) {
    static const std::array<double, slots> k = normalisation();
    const Directions wi(samples, random);
    std::vector<double> f(samples);
    problem().brdf->eval(wo, wi.batch(), f.data());
    for (std::size_t s = 0; s < samples; ++s) {
        const double phi = std::atan2(wi.y[s], wi.x[s]);
        const double value = f[s] * wi.z[s] * (2 * pi / samples);
        for (int l = 0; l < order; ++l)
            for (int m = -l; m <= l; ++m) {
                const int slot = slotOf(l, m);
                coefficients[slot] += value * textbookBasis(l, m, wi.z[s], phi, k[slot]);
            }
    }
}

/// The time of Monte Carlo for all outgoing directions, and its error then.
struct MonteCarlo {
    double seconds = 0, error = 0;
    /// Seconds to an error, by 1/sqrt(N).
    double secondsTo(double wanted) const { return seconds * (error / wanted) * (error / wanted); }
};

template <class Estimate>
MonteCarlo measure(double sharedSeconds, Estimate estimate) {
    RelativeError error;
    double seconds = 0;
    std::size_t count = 0;
    for (std::size_t o = 0; o < problem().outgoing.size(); o += stride, ++count) {
        std::array<double, slots> coefficients{};
        const double start = cpuSeconds();
        estimate(problem().outgoing.directions[o], coefficients.data());
        seconds += cpuSeconds() - start;
        error.add(o, coefficients.data());
    }
    const double all = static_cast<double>(problem().outgoing.size()) / static_cast<double>(count);
    return {sharedSeconds + seconds * all, error.value()};
}

const MonteCarlo& textbook() {
    static const MonteCarlo result = [] {
        std::mt19937_64 random(1);
        return measure(0, [&](const Direction& wo, double* coefficients) {
            textbookMonteCarlo(wo, random, coefficients);
        });
    }();
    return result;
}

const MonteCarlo& shared() {
    static const MonteCarlo result = [] {
        const double start = cpuSeconds();
        std::mt19937_64 random(2);
        const Directions wi(samples, random);
        std::vector<double> basis(samples * slots), f(samples);
        problem().basis->evaluate(wi.batch(), basis.data());
        return measure(cpuSeconds() - start, [&](const Direction& wo, double* coefficients) {
            problem().brdf->eval(wo, wi.batch(), f.data());
            for (std::size_t s = 0; s < samples; ++s) {
                const double value = f[s] * wi.z[s] * (2 * pi / samples);
                for (int k = 0; k < slots; ++k)
                    coefficients[k] += value * basis[s * slots + static_cast<std::size_t>(k)];
            }
        });
    }();
    return result;
}

void monteCarlo(benchmark::State& state, const MonteCarlo& (*run)()) {
    for (auto _ : state) state.SetIterationTime(run().seconds);
    state.counters["samples"] = samples;
    state.counters["error"] = run().error;
}

void projection(benchmark::State& state, double tolerance) {
    problem();
    double seconds = 0;
    Projection result;
    for (auto _ : state) {
        const double start = cpuSeconds();
        result = problem().projected(tolerance);
        const double taken = cpuSeconds() - start;
        seconds += taken;
        state.SetIterationTime(taken);
    }
    seconds /= static_cast<double>(state.iterations());
    RelativeError error;
    for (std::size_t o = 0; o < problem().outgoing.size(); o += stride)
        error.add(o, result.coefficients.at(o, 0));
    state.counters["tolerance"] = tolerance;
    state.counters["error"] = error.value();
    state.counters["evaluations"] = static_cast<double>(result.evaluations);
    // At the error that the projection reached, and, less favourable to it, at the one asked for.
    state.counters["textbook_ratio_reached"] = textbook().secondsTo(error.value()) / seconds;
    state.counters["textbook_ratio_asked"] = textbook().secondsTo(tolerance) / seconds;
    state.counters["shared_ratio_reached"] = shared().secondsTo(error.value()) / seconds;
    state.counters["shared_ratio_asked"] = shared().secondsTo(tolerance) / seconds;
    // The same directions with 10,000 samples each, for any error.
    constexpr double usual = 10000;
    state.counters["textbook_ratio_usual"] = textbook().seconds * (usual / samples) / seconds;
    state.counters["textbook_error_usual"] = textbook().error * std::sqrt(samples / usual);
    // Its evaluations at the error that the projection reached.
    const double ratio = textbook().error / error.value();
    state.counters["evaluations_share"] =
        static_cast<double>(result.evaluations) /
        (static_cast<double>(samples * problem().outgoing.size()) * ratio * ratio);
}

BENCHMARK_CAPTURE(monteCarlo, textbook, textbook)
    ->UseManualTime()
    ->Iterations(1)
    ->Unit(benchmark::kSecond);
BENCHMARK_CAPTURE(monteCarlo, shared, shared)
    ->UseManualTime()
    ->Iterations(1)
    ->Unit(benchmark::kSecond);
BENCHMARK_CAPTURE(projection, 1e-2, 1e-2)->UseManualTime()->Unit(benchmark::kSecond);
BENCHMARK_CAPTURE(projection, 1e-3, 1e-3)->UseManualTime()->Unit(benchmark::kSecond);
BENCHMARK_CAPTURE(projection, 1e-6, 1e-6)->UseManualTime()->Unit(benchmark::kSecond);

}  // namespace

int main(int argc, char** argv) {
    const tbb::global_control oneThread(tbb::global_control::max_allowed_parallelism, 1);
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
}
