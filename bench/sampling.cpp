// Directions drawn after a material, with their densities: the samplers of the library against the
// cosine, and against a table on a regular grid of angles for each of 90 elevations.

#include <benchmark/benchmark.h>
#include <hshfit/sampling/axis_lobes.h>
#include <hshfit/sampling/efficiency.h>
#include <hshfit/sampling/make_sampler.h>

#include <brdfs/catalog.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

namespace {

using namespace hshfit;

constexpr const char* material = "ggx:alpha=.1,F0=.9";

/// f cos(theta_i) on a regular grid of theta_i and phi, by cumulative sums: the brute way.
class RegularTable final : public Sampler {
public:
    static constexpr std::size_t elevations = 90, rows = 90, columns = 180;

    explicit RegularTable(const Brdf& brdf) : cumulative_(elevations * rows * columns) {
        for (std::size_t e = 0; e < elevations; ++e) {
            const Direction wo = directionFromAngles((static_cast<double>(e) + .5) * step, 0);
            double sum = 0;
            for (std::size_t k = 0; k < rows * columns; ++k) {
                const double theta = (static_cast<double>(k / columns) + .5) * step;
                const double phi = (static_cast<double>(k % columns) + .5) * 2 * step;
                const Direction wi = directionFromAngles(theta, phi);
                sum += evaluate(brdf, wi, wo)[0] * wi.z * std::sin(theta);
                cumulative_[e * rows * columns + k] = sum;
            }
            for (std::size_t k = 0; k < rows * columns; ++k)
                cumulative_[e * rows * columns + k] /= sum;
        }
    }
    std::string_view name() const override { return "regular table"; }
    Sample sample(const Direction& wo, const Uniforms& u) const override {
        const double* all = tableOf(wo);
        const std::size_t k = static_cast<std::size_t>(std::min<std::ptrdiff_t>(
            std::upper_bound(all, all + rows * columns, u[2]) - all, rows * columns - 1));
        const double low = std::cos(static_cast<double>(k / columns) * step);
        const double high = std::cos(static_cast<double>(k / columns + 1) * step);
        const double z = std::max(1e-12, std::lerp(low, high, u[0]));
        const double phi = azimuth(wo) + (static_cast<double>(k % columns) + u[1]) * 2 * step;
        const double s = std::sqrt(1 - z * z);
        const Direction wi{s * std::cos(phi), s * std::sin(phi), z};
        return {wi, pdf(wo, wi)};
    }
    double pdf(const Direction& wo, const Direction& wi) const override {
        double phi = azimuth(wi) - azimuth(wo);
        phi -= 2 * pi * std::floor(phi / (2 * pi));
        const auto row = std::min(rows - 1, static_cast<std::size_t>(polarAngle(wi) / step));
        const auto column = std::min(columns - 1, static_cast<std::size_t>(phi / (2 * step)));
        const std::size_t k = row * columns + column;
        const double* all = tableOf(wo);
        const double mass = all[k] - (k > 0 ? all[k - 1] : 0);
        const double low = static_cast<double>(row) * step;
        return mass / ((std::cos(low) - std::cos(low + step)) * 2 * step);
    }

private:
    static constexpr double step = pi / 2 / 90;

    const double* tableOf(const Direction& wo) const {
        const auto e = std::min(elevations - 1, static_cast<std::size_t>(polarAngle(wo) / step));
        return cumulative_.data() + e * rows * columns;
    }
    std::vector<double> cumulative_;
};

std::shared_ptr<const Sampler> made(const std::string& name) {
    static std::map<std::string, std::shared_ptr<const Sampler>> all;
    static const auto brdf = brdfs::open(material);
    std::shared_ptr<const Sampler>& sampler = all[name];
    if (sampler) return sampler;
    if (name == "cosine") return sampler = cosineSampler();
    if (name == "regular") return sampler = std::make_shared<RegularTable>(*brdf);
    if (name == "table") return sampler = tabulate(*brdf);
    if (name == "proposal") return sampler = proposalSampler(fitProposal(*brdf));
    const bool own = name == "own";
    return sampler = makeSampler(*brdf, {.known = own});
}

/// One direction and its density. The counters are the efficiency, variance of f cos / pdf over the
/// square of its mean, at 45 degrees.
void draw(benchmark::State& state, const std::string& name) {
    const auto sampler = made(name);
    const Direction wo = directionFromAngles(radians(45), .3);
    const auto brdf = brdfs::open(material);
    UniformNumbers numbers(1);
    std::vector<Uniforms> u(4096);
    for (Uniforms& one : u) one = numbers.next();
    std::size_t k = 0;
    for (auto _ : state) benchmark::DoNotOptimize(sampler->sample(wo, u[k++ % u.size()]).pdf);
    const Efficiency found = efficiencyAt(*brdf, *sampler, wo, 20000);
    state.counters["variance"] = found.variance;
    state.counters["largest"] = found.largest;
    state.SetItemsProcessed(state.iterations());
}

BENCHMARK_CAPTURE(draw, cosine, "cosine");
BENCHMARK_CAPTURE(draw, own, "own");
BENCHMARK_CAPTURE(draw, proposal, "proposal");
BENCHMARK_CAPTURE(draw, table, "table");
BENCHMARK_CAPTURE(draw, fitted_and_table, "fitted");
BENCHMARK_CAPTURE(draw, regular_table, "regular");

}  // namespace

BENCHMARK_MAIN();
