#include "sample_cases.h"

#include "../forms/library_sums.h"
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

constexpr const char* libraryMaterials[] = {"lambert:kd=.3/.2/.1", "ggx:alpha=.2,F0=.9/.6/.3",
                                            "ggx:alpha=.1,F0=.05,kd=.4/.3/.1"};

/// All of them in a basis of three components.
const material_library::Library& library() {
    namespace ml = material_library;
    static const ml::Library made = [] {
        const ml::LogSpace space;
        std::vector<ml::Measured> measured;
        for (const char* spec : libraryMaterials)
            measured.push_back(
                space.project(*open(spec), "m" + std::to_string(measured.size()), spec));
        return ml::learn(space, std::move(measured), {}, {.components = 3, .bytes = 60},
                         {.log = 10, .maximum = 10, .flip = 10});
    }();
    return made;
}

/// Sums of the library, with a table or without.
const gpu::SharedSums& sharedSums(bool table) {
    static const gpu::SharedSums constants = constantSums(library()),
                                 tabled = gpu::tabledSums(constants, {40, 23, 18});
    return table ? tabled : constants;
}

/// `sample`, `pdf` and `eval` of one material, as the programs call them.
std::string callsOf(gpu::Language language, const SampleCase& one) {
    const std::string m = std::to_string(one.material), u = "u1, u2, u3";
    if (language == gpu::Language::wgsl)
        return "\nfn hsh_sample(wo: vec3<f32>, u1: f32, u2: f32, u3: f32) -> vec3<f32> { return "
               "hsh_material_sample(" +
               m + ", wo, " + u +
               "); }\n"
               "fn hsh_pdf(wo: vec3<f32>, wi: vec3<f32>) -> f32 { return hsh_material_pdf(" +
               m +
               ", wo, wi); }\n"
               "fn hsh_eval(wo: vec3<f32>, wi: vec3<f32>) -> vec3<f32> { return hsh_material(" +
               m + ", wo, wi); }\n";
    const bool metal = language == gpu::Language::metal;
    const std::string v = wordsOf(language).vector, texture = metal ? "coefficients, " : "",
                      table = metal && one.library->table ? "basis, linear, " : "";
    // As C++, textures of Metal are arguments that the program makes of its input.
    const std::string first =
        metal ? "const texture2d_array<float> coefficients{&stub::job.coefficients}; " : "";
    const std::string second =
        table.empty() ? ""
                      : "const texture2d_array<float> basis{&stub::job.basis}; sampler linear; ";
    const std::string eval = "hsh_eval(" + v + " wo, " + v + " wi)";
    const std::string begin = metal ? "\ninline " : "\n";
    return begin + v + " hsh_sample(" + v + " wo, float u1, float u2, float u3) { " + first +
           "return hsh_material_sample(" + texture + m + ", wo, " + u + "); }" + begin +
           "float hsh_pdf(" + v + " wo, " + v + " wi) { " + first + "return hsh_material_pdf(" +
           texture + m + ", wo, wi); }" + begin + v + " " + eval + " { " + first + second +
           "return hsh_material(" + texture + table + m + ", wo, wi); }\n";
}

}  // namespace

std::vector<SampleCase> librarySampleCases() {
    constexpr std::size_t rows = 6;
    std::vector<SampleCase> cases;
    for (const bool table : {false, true}) {
        gpu::SharedSums sums = sharedSums(table);
        const std::size_t first = cases.size();
        sums.further = rows;
        for (std::size_t m = 0; m < sums.count(); ++m) {
            SampleCase one{.name = std::string(table ? "table, " : "constants, ") +
                                   libraryMaterials[m]};
            one.material = m;
            one.payload.head.channels = Channels::rgb();
            const material_library::Material& material = library().materials[m];
            if (table)
                one.brdf = std::make_unique<gpu::TabledBrdf>(sharedSums(true), m);
            else
                one.brdf = open(library(), material, material.name);
            one.record.proposal = fitProposal(*one.brdf, {.elevations = rows});
            // Any density will do for the first: one with a retro lobe.
            if (m == 0)
                for (Proposal::Row& row : one.record.proposal.rows)
                    row = {ProposalLobe{60, 180, 180, 0}, ProposalLobe{50, 140, 140, 1}};
            one.sampler = proposalSampler(one.record.proposal);
            const std::vector<double> texels = gpu::proposalTexels(one.record.proposal);
            sums.furtherTexels.insert(sums.furtherTexels.end(), texels.begin(), texels.end());
            cases.push_back(std::move(one));
        }
        for (std::size_t k = first; k < cases.size(); ++k) {
            cases[k].library = sums;
            cases[k].payload.coefficients = gpu::materialTexels(sums);
            if (table) cases[k].payload.basisTexels = sums.table->texels();
        }
    }
    return cases;
}

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
    if (one.library) job.form = "texture";
    job.sampling = true;
    return job;
}

std::string sampleSnippet(gpu::Language language, const SampleCase& one) {
    if (one.library)
        return gpu::libraryShaderSource(language, *one.library, "hsh") +
               gpu::materialProposalSource(language, {.first = one.library->stride(),
                                                      .rows = one.record.proposal.rows.size()}) +
               callsOf(language, one);
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
