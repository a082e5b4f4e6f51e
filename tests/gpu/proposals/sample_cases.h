#pragma once

#include "../shaders/shader_job.h"

#include <hshfit/brdf/brdf.h>
#include <hshfit/gpu/forms/form_payload.h>
#include <hshfit/gpu/forms/library_shader.h>
#include <hshfit/gpu/proposals/proposal_shader.h>
#include <hshfit/sampling/sampler.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::shaders {

/// A coefficient file of some form, exported with a proposal: coefficients per outgoing direction
/// or, if there is one, a form with a shader of its own.
struct SampleCase {
    std::string name;
    gpu::Payload payload = {};
    std::optional<gpu::FormPayload> form = {};
    /// In their place a material of a library, by the shader of all of them.
    std::optional<gpu::SharedSums> library = {};
    std::size_t material = 0;
    std::unique_ptr<Brdf> brdf = {};  ///< in double precision, what the shader evaluates to
    gpu::ProposalRecord record = {};
    std::shared_ptr<const Sampler> sampler = {};

    bool cosine() const { return payload.head.quantity == Quantity::brdfCosine && !form; }
};

/// Every form, isotropic and not, with lobes from wide to narrow, mirror and retro.
std::vector<SampleCase> sampleCases();

/// Materials of one library, matte and glossy, one with a retro lobe: the functions of its shader
/// as constants, and looked up in a table.
std::vector<SampleCase> librarySampleCases();

/// wo, and in place of wi the three numbers that a direction is drawn with, which single precision
/// holds exactly.
ShaderJob sampleJob(const SampleCase& one, std::vector<Direction> wo, std::vector<Direction> u);

/// A program that writes for every pair: the direction drawn, its density, the density of the
/// numbers taken as a direction, and PREFIX_eval at the direction drawn.
std::string sampleProgram(gpu::Language language, const ShaderJob& job, const std::string& snippet);
std::string sampleSnippet(gpu::Language language, const SampleCase& one);

/// Numbers in [0, 1) that single precision holds.
std::vector<Direction> randomNumbers(std::size_t count, std::uint64_t seed);

/// The integral of max(f, 0) cos(theta_i), per channel, by `side` x `side` midpoints of polar
/// coordinates about the mirror direction.
std::vector<double> albedoOf(const Brdf& brdf, const Direction& wo, int side = 300);

/// The jobs of a case: pairs of directions all over, random numbers with directions all over, then
/// random numbers with each of sampleElevations().
std::vector<ShaderJob> sampleJobs(const SampleCase& one);
std::vector<Direction> sampleElevations();

/// Whether single precision may choose another lobe than double precision does.
bool nearAChoice(const SampleCase& one, const Direction& wo, double u);

}  // namespace hshfit::shaders
