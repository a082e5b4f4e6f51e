// The parts of a projection's time and their growth, on one thread unless stated. CPU time of
// the process. "floor" is the bare BRDF, timed within the projection by a wrapper that passes
// every call on, plus the product alone: the sums that turn values into coefficients, at the
// speed of this library's own matrix product.

#include "bench_folder.h"
#include "interleaved.h"

#include <benchmark/benchmark.h>
#include <brdfs/catalog.h>
#include <hshfit/bases/catalog.h>
#include <hshfit/projection/lane_products.h>
#include <hshfit/projection/projection.h>
#include <hshfit/quadrature/azimuth_tables.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <memory>
#include <string>
#include <vector>

namespace {

using namespace hshfit;

double cpuSeconds() {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double threadSeconds() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Counts the time that a BRDF takes. For one thread.
class Timed : public Brdf {
public:
    explicit Timed(const std::string& spec) : brdf_(brdfs::open(spec)) {}
    std::string name() const override { return brdf_->name(); }
    const Channels& channels() const override { return brdf_->channels(); }
    const Laws& laws() const override { return brdf_->laws(); }
    std::vector<Lobe> lobes(const Direction& wo) const override { return brdf_->lobes(wo); }
    std::vector<double> kinks(const Direction& wo) const override { return brdf_->kinks(wo); }
    double defaultTolerance() const override { return brdf_->defaultTolerance(); }
    void eval(const Direction& wo, DirectionBatch wi, double* out) const override {
        const double start = threadSeconds();
        brdf_->eval(wo, wi, out);
        seconds += threadSeconds() - start;
        ++calls;
    }
    mutable double seconds = 0;
    mutable std::size_t calls = 0;

private:
    std::unique_ptr<Brdf> brdf_;
};

/// The time for reading the clock twice, to be subtracted.
double clockSeconds() {
    constexpr int many = 2000;
    const double start = threadSeconds();
    for (int i = 0; i < many; ++i) benchmark::DoNotOptimize(threadSeconds());
    return (threadSeconds() - start) / many;
}

std::vector<std::unique_ptr<Basis>> makeBases(const std::string& names, int order) {
    std::vector<std::unique_ptr<Basis>> made;
    for (const bases::Entry* entry : bases::select(names))
        made.push_back(bases::make(entry->name, std::min(order, entry->maxOrder)));
    return made;
}

struct Job {
    std::string spec, bases = "hsh", outgoing = "32x32";
    int order = 7;
    Quantity quantity = Quantity::brdfCosine;
    double tolerance = 0;
};

/// Seconds for each value that the product alone takes: 16 rings of 128 azimuths, times azimuth
/// functions of the order.
double productSeconds(int order) {
    constexpr std::size_t rings = 16, quadrant = 32, rounds = 2000;
    AzimuthTable table;
    table.fill(order, {4 * quadrant}, 0, quadrant);
    const AzimuthColumns columns(order);
    const std::vector<double> values(rings * 4 * quadrant, 0.5);
    std::vector<double> out(rings * columns.all());
    const double start = threadSeconds();
    for (std::size_t i = 0; i < rounds; ++i) {
        const double *from = values.data(), *rows = table.rows.data();
        double* to = out.data();
        for (const std::size_t kind : {columns.c0, columns.c1, columns.s1, columns.s0}) {
            addProducts({from, rings, quadrant}, {rows, kind, columns.all()}, quadrant, to,
                        columns.all());
            from += rings * quadrant;
            rows += kind;
            to += kind;
        }
        benchmark::DoNotOptimize(out.data());
        benchmark::ClobberMemory();
    }
    return (threadSeconds() - start) / static_cast<double>(rounds * values.size());
}

std::vector<Projection> run(const Brdf& brdf, const Job& job) {
    const auto owned = makeBases(job.bases, job.order);
    std::vector<const Basis*> bases;
    for (const auto& basis : owned) bases.push_back(basis.get());
    ProjectionOptions options;
    options.quantity = job.quantity;
    options.tolerance = job.tolerance;
    options.maxEvaluations = std::size_t{1} << 32;
    return project(brdf, bases, OutgoingSet::parse(job.outgoing), options);
}

void measure(benchmark::State& state, const Job& job) {
    const tbb::global_control oneThread(tbb::global_control::max_allowed_parallelism, 1);
    const auto brdf = brdfs::open(job.spec);
    std::size_t evaluations = 0;
    double error = 0;
    for (auto _ : state) {
        const double start = cpuSeconds();
        const std::vector<Projection> result = run(*brdf, job);
        state.SetIterationTime(cpuSeconds() - start);
        evaluations = result[0].evaluations;
        error = result[0].coefficients.error;
    }
    state.counters["evaluations"] = static_cast<double>(evaluations);
    state.counters["error"] = error;
}

/// The time for each evaluation, in the BRDF, in the product alone, and in all but the BRDF.
void floorShare(benchmark::State& state, const Job& job) {
    const tbb::global_control oneThread(tbb::global_control::max_allowed_parallelism, 1);
    const Timed brdf(job.spec);
    const double product = productSeconds(job.order);
    const double clock = clockSeconds();
    double all = 0, bare = 0;
    std::size_t evaluations = 0;
    for (auto _ : state) {
        brdf.seconds = 0;
        brdf.calls = 0;
        const double start = cpuSeconds();
        evaluations = run(brdf, job)[0].evaluations;
        const double lost = clock * static_cast<double>(brdf.calls);
        const double taken = cpuSeconds() - start - 2 * lost;
        state.SetIterationTime(taken);
        all += taken;
        bare += brdf.seconds - lost;
    }
    const double rounds = static_cast<double>(state.iterations());
    const double n = static_cast<double>(evaluations);
    state.counters["evaluations"] = n;
    state.counters["brdf_share"] = bare / all;
    state.counters["brdf_ns"] = bare / rounds / n * 1e9;
    state.counters["product_ns"] = product * 1e9;
    state.counters["rest_ns"] = (all - bare) / rounds / n * 1e9;
    state.counters["over_floor"] = all / (bare + rounds * n * product);
}

constexpr const char* ward = "ward:kd=0,ks=1,ax=0.2,ay=0.5";

/// The least time for a projection on a fixed grid: the bare BRDF at 10,000 directions for each of
/// 1024 outgoing ones, and the product of these values with 49 functions, each alone, from the
/// caches.
void fixedGrid(benchmark::State& state, const std::string& spec) {
    constexpr std::size_t outgoing = 1024, points = 10000, functions = 49, together = 8;
    constexpr std::size_t columns = (functions + laneGroup - 1) / laneGroup * laneGroup;
    const auto brdf = brdfs::open(spec);
    const OutgoingSet set = OutgoingSet::parse("32x32");
    std::vector<double> x, y, z;
    for (std::size_t k = 0; k < points; ++k) {
        const double golden = 2.399963229728653;
        const Direction wi = directionFromAngles(std::acos((static_cast<double>(k) + 0.5) / points),
                                                 golden * static_cast<double>(k));
        x.push_back(wi.x), y.push_back(wi.y), z.push_back(wi.z);
    }
    std::vector<double> values(together * points), table(points * columns, 0.5),
        out(together * columns);
    double bare = 0, product = 0;
    for (auto _ : state) {
        const double start = threadSeconds();
        for (std::size_t k = 0; k < outgoing; ++k)
            brdf->eval(set.directions[k], {x.data(), y.data(), z.data(), points},
                       values.data() + k % together * points);
        const double middle = threadSeconds();
        for (std::size_t k = 0; k < outgoing; k += together)
            addProducts({values.data(), together, points}, {table.data(), columns, columns}, points,
                        out.data(), columns);
        benchmark::DoNotOptimize(out.data());
        const double end = threadSeconds();
        bare += middle - start;
        product += end - middle;
        state.SetIterationTime(end - start);
    }
    const double rounds = static_cast<double>(state.iterations());
    state.counters["brdf_ms"] = bare / rounds * 1e3;
    state.counters["product_ms"] = product / rounds * 1e3;
}

void byOrder(benchmark::State& state) {
    // One outgoing direction, the grid that the order needs: a tolerance that the second level
    // meets.
    measure(state, {.spec = ward,
                    .outgoing = "45,20",
                    .order = static_cast<int>(state.range(0)),
                    .tolerance = 1e-2});
}
BENCHMARK(byOrder)->RangeMultiplier(2)->Range(4, 256)->UseManualTime()->Unit(
    benchmark::kMillisecond);

void byDirections(benchmark::State& state) {
    const std::string side = std::to_string(state.range(0));
    measure(state, {.spec = ward, .outgoing = side + "x" + side});
}
BENCHMARK(byDirections)
    ->RangeMultiplier(2)
    ->Range(4, 64)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

void byChannels(benchmark::State& state) {
    const bool rgb = state.range(0) == 3;
    measure(state, {.spec = rgb ? "ggx:alpha=0.3,F0=0.9/0.6/0.3" : "ggx:alpha=0.3,F0=0.6"});
}
BENCHMARK(byChannels)->Arg(1)->Arg(3)->UseManualTime()->Unit(benchmark::kMillisecond);

void byTolerance(benchmark::State& state) {
    measure(state,
            {.spec = ward, .tolerance = std::pow(10.0, -static_cast<double>(state.range(0)))});
}
BENCHMARK(byTolerance)->DenseRange(1, 9)->UseManualTime()->Unit(benchmark::kMillisecond);

/// Order 12 on 16x16 directions, as `report` does by default: HSH alone, then with the others.
void byBases(benchmark::State& state) {
    const std::vector<std::string> names = {"hsh", "hsh,zernike", "hsh,zernike,sh",
                                            "hsh,zernike,sh,esh"};
    measure(state, {.spec = ward,
                    .bases = names[static_cast<std::size_t>(state.range(0)) - 1],
                    .outgoing = "16x16",
                    .order = 12});
}
BENCHMARK(byBases)->DenseRange(1, 4)->UseManualTime()->Unit(benchmark::kMillisecond);

BENCHMARK_CAPTURE(floorShare, ward, Job{.spec = ward})
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(floorShare, ggx, Job{.spec = "ggx:alpha=0.3"})
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(floorShare, lambert, Job{.spec = "lambert", .tolerance = 1e-6})
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

BENCHMARK_CAPTURE(fixedGrid, ward, ward)->UseManualTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(fixedGrid, ggx, std::string("ggx:alpha=0.3"))
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

/// A full-size MERL-layout file that is in the page cache, from opening it to coefficients: RGB,
/// order 7, the tables' own tolerance.
void merl(benchmark::State& state, const std::string& outgoing) {
    static const BenchFolder folder;
    const std::string path = (folder.path / "ggx.binary").string();
    if (!std::filesystem::exists(path)) {
        const auto writer = std::ranges::find(brdfs::writers(), "merl", &brdfs::Writer::name);
        writer->write(*brdfs::open("ggx:alpha=0.3,F0=0.9"), path, {}, {});
    }
    measure(state, {.spec = path, .outgoing = outgoing, .quantity = Quantity::brdf});
}
BENCHMARK_CAPTURE(merl, 16, "16")->UseManualTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(merl, 32x32, "32x32")->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace

int main(int argc, char** argv) {
    runInterleaved(argc, argv, 7, "0.1");
}
