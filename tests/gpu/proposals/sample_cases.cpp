#include "sample_cases.h"

#include "../shaders/slang_rules.h"

#include <hshfit/coefficients/reconstruction.h>
#include <hshfit/gpu/forms/form_shader.h>
#include <hshfit/representation/forms/form.h>
#include <hshfit/representation/forms/represented_brdf.h>
#include <lib/formula_brdf.h>
#include <lib/sampling/sampling_laws.h>

#include <brdfs/catalog.h>

#include <kainjow/mustache.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace hshfit::shaders {
namespace {

std::unique_ptr<Brdf> open(const std::string& spec) {
    if (spec != "retro") return brdfs::open(spec);
    return std::make_unique<test::FormulaBrdf>(
        [](const Direction& wi, const Direction& wo) {
            return 0.1 + 0.5 * std::exp(20 * (dot(wi, wo) - 1));
        },
        test::FormulaBrdf::Predicate{},
        Laws{.nonNegative = true, .reciprocal = true, .isotropic = true, .mirrorSymmetric = true});
}

struct Asked {
    std::string name, spec;
    Form form;
};

SampleCase caseOf(const Asked& asked) {
    const Representation form = represent(*open(asked.spec), asked.form, open,
                                          {.tolerance = 3e-2, .maxEvaluations = 1 << 18});
    SampleCase one{.name = asked.name};
    if (form.kind() == Representation::Kind::outgoing) {
        one.payload = gpu::pack(decoded(form), {.number = gpu::Number::float32});
        one.brdf = std::make_unique<Reconstruction>(gpu::unpack(one.payload));
    } else {
        one.form = gpu::packForm(form);
        one.payload.head = one.form->form.head;
        one.payload.coefficients = one.form->texels;
        one.brdf = reconstruct(one.form->form, open);
    }
    one.record.proposal = fitProposal(*one.brdf, {.elevations = 8});
    one.sampler = proposalSampler(one.record.proposal);
    return one;
}

std::string textOf(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) throw std::runtime_error("cannot read " + path);
    return {std::istreambuf_iterator<char>(file), {}};
}

struct Words {
    const char *wrapper, *real, *vector;
};
Words wordsOf(gpu::Language language) {
    switch (language) {
        case gpu::Language::glslEs:
            return {"glsl_es", "float", "vec3"};
        case gpu::Language::glsl:
            return {"glsl", "float", "vec3"};
        case gpu::Language::hlsl:
        case gpu::Language::slang:
            return {"hlsl", "float", "float3"};
        case gpu::Language::wgsl:
            return {"wgsl", "f32", "vec3<f32>"};
        case gpu::Language::metal:
            return {"metal", "float", "float3"};
        case gpu::Language::osl:
            break;
    }
    return {"osl", "float", "vector"};
}

}  // namespace

std::vector<SampleCase> sampleCases() {
    using Kind = Representation::Kind;
    const Asked all[] = {
        {"outgoing", "ggx:alpha=.3,F0=.9/.6/.3", {.order = 6, .outgoing = "16"}},
        {"outgoing, map, f cos",
         "ward:ax=.25,ay=.5,kd=.1/.2/.3",
         {.order = 5, .quantity = Quantity::brdfCosine, .outgoing = "12x12"}},
        {"halfway, narrow",
         "ggx:alpha=.04,F0=.9/.6/.3",
         {.kind = Kind::halfway, .halfway = {8, 4, 1}}},
        {"halfway, anisotropic",
         "ward:ax=.1,ay=.4,kd=.2,ks=.5",
         {.kind = Kind::halfway, .halfway = {6, 3, 3}}},
        {"halfway, retro", "retro", {.kind = Kind::halfway, .halfway = {6, 6, 2}}},
        {"basis", "oren-nayar:kd=.8/.5/.2,sigma=.6", {.kind = Kind::basis, .order = 5}},
        {"basis, white", "lambert:kd=1", {.kind = Kind::basis, .order = 1}},
    };
    std::vector<SampleCase> cases;
    for (const Asked& asked : all) cases.push_back(caseOf(asked));
    return cases;
}

ShaderJob sampleJob(const SampleCase& one, std::vector<Direction> wo, std::vector<Direction> u) {
    ShaderJob job{
        one.payload, {std::move(wo), std::move(u)}, {.order = 0, .colours = 0, .values = {}}};
    if (one.form) job.form = "constants";
    job.sampling = true;
    return job;
}

std::string sampleSnippet(gpu::Language language, const SampleCase& one) {
    const std::string snippet =
        one.form ? gpu::formShaderSource(language, *one.form, {.storage = gpu::Storage::constants})
                 : gpu::shaderSource(language, one.payload, {.environmentOrder = 0});
    return snippet + gpu::proposalSource(language, one.record, {.cosine = one.cosine()});
}

std::string sampleProgram(gpu::Language language, const ShaderJob& job,
                          const std::string& snippet) {
    const bool grey = job.payload.head.channels.kind == Channels::Kind::grey;
    const Words words = wordsOf(language);
    kainjow::mustache::data page;
    page.set("snippet", language == gpu::Language::slang ? moduleAsHlsl(snippet) : snippet);
    page.set("type", grey ? words.real : words.vector);
    page.set("of", grey ? "" : "[i]");
    page.set("sampled", job.form.empty());
    page.set("channels", std::to_string(job.channels()));
    page.set("outputs", std::to_string(job.outputs()));
    kainjow::mustache::mustache wrapper(textOf(std::string(HSHFIT_SOURCE) +
                                               "/tests/gpu/proposals/wrappers/" + words.wrapper +
                                               ".mustache"));
    wrapper.set_custom_escape([](const std::string& s) { return s; });
    return wrapper.render(page);
}

std::vector<Direction> randomNumbers(std::size_t count, std::uint64_t seed) {
    UniformNumbers numbers(seed);
    const auto single = [](double value) {
        return std::min(static_cast<double>(static_cast<float>(value)), 1 - std::ldexp(1, -24));
    };
    std::vector<Direction> all;
    for (std::size_t k = 0; k < count; ++k) {
        const Uniforms u = numbers.next();
        all.push_back({single(u[0]), single(u[1]), single(u[2])});
    }
    return all;
}

std::vector<Direction> sampleElevations() {
    std::vector<Direction> all;
    for (const double theta : {0., 50., 82.}) {
        const Direction d = directionFromAngles(radians(theta), 0.7);
        const auto single = [](double v) { return static_cast<double>(static_cast<float>(v)); };
        all.push_back({single(d.x), single(d.y), single(d.z)});
    }
    return all;
}

std::vector<ShaderJob> sampleJobs(const SampleCase& one) {
    const Pairs pairs = directionPairs();
    const std::size_t count = pairs.wo.size();
    std::vector<ShaderJob> jobs{sampleJob(one, pairs.wo, pairs.wi),
                                sampleJob(one, pairs.wo, randomNumbers(count, 3))};
    std::uint64_t seed = 10;
    for (const char c : one.name) seed = (31 * seed + static_cast<unsigned char>(c)) % 1000003;
    for (const Direction& wo : sampleElevations())
        jobs.push_back(
            sampleJob(one, std::vector<Direction>(count, wo), randomNumbers(count, ++seed)));
    return jobs;
}

bool nearAChoice(const SampleCase& one, const Direction& wo, double u) {
    const ProposalMix mix = mixAt(one.record.proposal, wo);
    return std::abs(u - mix.share[0]) < 1e-5 || std::abs(u - mix.share[0] - mix.share[1]) < 1e-5;
}

std::vector<double> albedoOf(const Brdf& brdf, const Direction& wo, int n) {
    const test::MirrorChart chart{wo};
    std::vector<double> albedo(brdf.channels().count(), 0.0);
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const auto [wi, solidAngle] = chart.at((i + .5) / n, (j + .5) / n);
            const std::vector<double> f = evaluate(brdf, wi, wo);
            for (std::size_t c = 0; c < f.size(); ++c)
                albedo[c] += std::max(f[c], 0.0) * wi.z * solidAngle / (n * n);
        }
    return albedo;
}

}  // namespace hshfit::shaders
