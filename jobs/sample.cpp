#include "sample.h"

#include "source.h"

#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>
#include <hshfit/projection/albedo.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <iterator>
#include <ranges>
#include <utility>

namespace hshfit::jobs {
namespace {

constexpr std::array<std::pair<std::string_view, SampleMethod>, 4> methods{
    {{"auto", SampleMethod::best},
     {"table", SampleMethod::table},
     {"proposal", SampleMethod::proposal},
     {"cosine", SampleMethod::cosine}}};

SamplerOptions optionsOf(SampleMethod method) {
    return {.known = method == SampleMethod::best,
            .proposal = method == SampleMethod::best || method == SampleMethod::proposal,
            .table = method == SampleMethod::best || method == SampleMethod::table};
}

double secondsOf(const std::chrono::steady_clock::time_point& start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

SampleRow rowAt(const Brdf& brdf, const MixtureSampler& sampler, const Direction& wo,
                const SampleOptions& options) {
    SampleRow row;
    row.efficiency = efficiencyAt(brdf, sampler, wo, options.trials, options.seed);
    row.shares = sampler.row(wo).shares;
    const AlbedoEstimate found =
        estimateAlbedo(brdf, wo, {.tolerance = 1e-4, .maxEvaluations = std::size_t{1} << 22});
    if (found.converged) row.albedo = found.values;
    return row;
}

void draw(const Brdf& brdf, const MixtureSampler& sampler, const SampleOptions& options,
          Sampled& result) {
    UniformNumbers numbers(options.seed);
    const auto start = std::chrono::steady_clock::now();
    for (std::size_t k = 0; k < options.count; ++k) {
        const Sample s = sampler.sample(options.outgoing, numbers.next());
        result.drawn.push_back({s.wi, s.pdf, {}});
    }
    if (options.count > 0)
        result.nanosecondsPerSample = secondsOf(start) * 1e9 / static_cast<double>(options.count);
    for (DrawnDirection& one : result.drawn) {
        one.weights = evaluate(brdf, one.wi, options.outgoing);
        for (double& weight : one.weights) weight *= one.wi.z / one.pdf;
    }
}

std::string csvOf(const Sampled& done) {
    std::string csv = "wi_x,wi_y,wi_z,pdf";
    for (const std::string& name : done.channels) csv += ",weight_" + name;
    csv += "\n";
    for (const DrawnDirection& one : done.drawn)
        fmt::format_to(std::back_inserter(csv), "{},{},{},{},{}\n", one.wi.x, one.wi.y, one.wi.z,
                       one.pdf, fmt::join(one.weights, ","));
    return csv;
}

}  // namespace

SampleMethod sampleMethod(const std::string& name) {
    for (const auto& [known, method] : methods)
        if (known == name) return method;
    throw UsageError(fmt::format("unknown method '{}'; known: {}", name,
                                 fmt::join(methods | std::views::keys, ", ")));
}

std::string sampleMethodName(SampleMethod method) {
    for (const auto& [name, known] : methods)
        if (known == method) return std::string(name);
    return {};
}

Sampled sample(const std::string& spec, const std::string& output, const SampleOptions& options) {
    // The cosine of 90 degrees is 6e-17 in double precision.
    if (!(options.outgoing.z > 1e-15))
        throw UsageError(
            "an outgoing direction at or below the horizon reflects nothing; give one "
            "with theta below 90 degrees");
    const auto brdf = openSource(spec);
    Sampled result;
    result.brdf = brdf->name();
    result.channels = brdf->channels().names();
    const auto start = std::chrono::steady_clock::now();
    const auto sampler = makeSampler(*brdf, optionsOf(options.method));
    result.buildSeconds = secondsOf(start);
    for (const auto& part : sampler->parts()) result.parts.emplace_back(part->name());
    result.reflects = sampler->reflects(options.outgoing);
    draw(*brdf, *sampler, options, result);
    result.here = rowAt(*brdf, *sampler, options.outgoing, options);
    result.rows.resize(options.elevations);
    tbb::parallel_for(std::size_t{0}, options.elevations, [&](std::size_t k) {
        const double last = std::max(1.0, static_cast<double>(options.elevations) - 1);
        const double theta = radians(89 * static_cast<double>(k) / last);
        const Direction wo = directionFromAngles(theta, azimuth(options.outgoing));
        result.rows[k] = rowAt(*brdf, *sampler, wo, options);
    });
    requireReadable(*brdf);
    if (!output.empty()) writeFile(output, csvOf(result));
    return result;
}

}  // namespace hshfit::jobs
