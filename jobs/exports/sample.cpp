#include "sample.h"

#include <jobs/common/clock.h>
#include <jobs/source/source.h>
#include "proposal.h"

#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>
#include <hshfit/stop_request.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

namespace hshfit::jobs {
namespace {

constexpr std::array<std::pair<std::string_view, SampleMethod>, 5> methods{
    {{"auto", SampleMethod::best},
     {"table", SampleMethod::table},
     {"proposal", SampleMethod::proposal},
     {"stored", SampleMethod::stored},
     {"cosine", SampleMethod::cosine}}};

SamplerOptions optionsOf(SampleMethod method, const std::optional<gpu::ProposalRecord>& stored) {
    SamplerOptions options{
        .known = method == SampleMethod::best,
        .proposal = method == SampleMethod::best || method == SampleMethod::proposal,
        .table = method == SampleMethod::best || method == SampleMethod::table};
    if (stored) options.fitted = stored->proposal;
    return options;
}

/// The stored proposal alone is a mixture of one part.
std::unique_ptr<MixtureSampler> samplerFor(const Brdf& brdf, const std::string& spec,
                                           SampleMethod method,
                                           const std::optional<gpu::ProposalRecord>& stored) {
    if (method != SampleMethod::stored) return makeSampler(brdf, optionsOf(method, stored));
    if (!stored)
        throw UsageError(
            fmt::format("{}: keeps no proposal; sidecars of exports with a shader do", spec));
    return std::make_unique<MixtureSampler>(SamplerList{proposalSampler(stored->proposal)},
                                            std::vector<MixtureRow>{{{1.0}, true}});
}

SampleRow rowAt(const Brdf& brdf, const MixtureSampler& sampler, const Direction& wo,
                const SampleOptions& options) {
    gpu::ProposalRow row = efficiencyRow(brdf, sampler, wo, {options.trials, options.seed});
    return {std::move(row.efficiency), std::move(row.albedo), sampler.row(wo).shares};
}

void draw(const Brdf& brdf, const MixtureSampler& sampler, const SampleOptions& options,
          Sampled& result) {
    UniformNumbers numbers(options.seed);
    const auto start = Clock::now();
    for (std::size_t k = 0; k < options.count; ++k) {
        stopIfRequested();
        const Sample s = sampler.sample(options.outgoing, numbers.next());
        result.drawn.push_back({s.wi, s.pdf, {}});
    }
    if (options.count > 0)
        result.nanosecondsPerSample =
            secondsSince(start) * 1e9 / static_cast<double>(options.count);
    for (DrawnDirection& one : result.drawn) {
        stopIfRequested();
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
    std::vector<std::string_view> names;
    for (const auto& [known, method] : methods) {
        if (known == name) return method;
        names.push_back(known);
    }
    throw UsageError(fmt::format("unknown method '{}'; known: {}", name, fmt::join(names, ", ")));
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
    const auto stored = storedProposal(spec);
    const auto start = Clock::now();
    const auto sampler = samplerFor(*brdf, spec, options.method, stored);
    const auto drawsProposal = [](const auto& part) { return part->name() == "proposal"; };
    result.stored = stored && std::ranges::any_of(sampler->parts(), drawsProposal);
    result.buildSeconds = secondsSince(start);
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
