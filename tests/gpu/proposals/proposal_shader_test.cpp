// sample and pdf of the snippets, in every language and for every form, against the library.

#include "../binaries/bound_module.h"
#include "../shaders/runners.h"
#include "sample_cases.h"

#include <hshfit/error.h>
#include <hshfit/gpu/vulkan/spirv.h>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <lib/sampling/sampling_laws.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <tuple>
#include <vector>

namespace hshfit::shaders {
namespace {

using gpu::ComputeResource;
using gpu::Language;

constexpr std::size_t perJob = Pairs::side * Pairs::side;

const std::vector<SampleCase>& cases() {
    static const std::vector<SampleCase> all = sampleCases();
    return all;
}

const std::vector<SampleCase>& libraryCases() {
    static const std::vector<SampleCase> all = librarySampleCases();
    return all;
}

/// Some outputs of each invocation.
Wanted columnsOf(const Wanted& wanted, std::size_t outputs, const std::vector<std::size_t>& kept) {
    Wanted part;
    for (std::size_t k = 0; k < wanted.values.size(); k += outputs)
        for (const std::size_t i : kept) {
            part.values.push_back(wanted.values[k + i]);
            part.scales.push_back(wanted.scales[k + i]);
        }
    return part;
}

/// Runners of compute shaders take all jobs at once.
std::vector<std::vector<float>> runAll(const std::vector<ShaderJob>& jobs,
                                       const std::string& source, const Run& runner,
                                       bool together) {
    std::vector<std::vector<float>> found;
    if (!together) {
        for (const ShaderJob& job : jobs) found.push_back(runner(job, source));
        return found;
    }
    ShaderJob all = jobs.front();
    for (std::size_t k = 1; k < jobs.size(); ++k) {
        const Pairs& pairs = jobs[k].pairs;
        all.pairs.wo.insert(all.pairs.wo.end(), pairs.wo.begin(), pairs.wo.end());
        all.pairs.wi.insert(all.pairs.wi.end(), pairs.wi.begin(), pairs.wi.end());
    }
    const std::vector<float> outputs = runner(all, source);
    const std::size_t size = perJob * all.outputs();
    for (std::size_t k = 0; k < jobs.size(); ++k)
        found.emplace_back(outputs.begin() + static_cast<std::ptrdiff_t>(k * size),
                           outputs.begin() + static_cast<std::ptrdiff_t>((k + 1) * size));
    return found;
}

/// The outputs of a shader for one pair.
struct Written {
    Direction wi;
    double pdf, other;
    const float* f;

    Written(const ShaderJob& job, const std::vector<float>& found, std::size_t k)
        : f(found.data() + k * job.outputs() + 5) {
        const auto at = [&](std::size_t i) {
            return static_cast<double>(found[k * job.outputs() + i]);
        };
        wi = {at(0), at(1), at(2)};
        pdf = at(3);
        other = at(4);
    }
};

double apart(double found, double expected) {
    if (found == expected) return 0;
    const double difference = std::abs(found / expected - 1);
    return difference < 1e30 ? difference : 1e30;  // a NaN counts as infinitely far
}

struct Agreement {
    double wi = 0, pdf = 0, other = 0;
};

/// Directions of the same numbers, and the library's density at the shader's direction.
void compareDraws(const SampleCase& one, const ShaderJob& job, const std::vector<float>& found,
                  Agreement& worst) {
    for (std::size_t k = 0; k < perJob; ++k) {
        const Direction &wo = job.pairs.wo[k], &u = job.pairs.wi[k];
        const Written w(job, found, k);
        if (wo.z <= 0) {
            EXPECT_EQ(w.wi.x * w.wi.x + w.wi.y * w.wi.y + w.wi.z * w.wi.z + w.pdf, 0);
            continue;
        }
        worst.pdf = std::max(worst.pdf, apart(w.pdf, one.sampler->pdf(wo, w.wi)));
        if (nearAChoice(one, wo, u.z)) continue;
        const Direction wi = one.sampler->sample(wo, {u.x, u.y, u.z}).wi;
        for (const double d : {wi.x - w.wi.x, wi.y - w.wi.y, wi.z - w.wi.z})
            worst.wi = std::max(worst.wi, std::abs(d) < 1e30 ? std::abs(d) : 1e30);
    }
}

void comparePairs(const SampleCase& one, const ShaderJob& job, const std::vector<float>& found,
                  Agreement& worst) {
    for (std::size_t k = 0; k < perJob; ++k)
        worst.other =
            std::max(worst.other, apart(Written(job, found, k).other,
                                        one.sampler->pdf(job.pairs.wo[k], job.pairs.wi[k])));
}

/// The expected outputs of all jobs: the library's densities of the pairs, and the directions that
/// it draws with the same numbers. Densities of drawn directions and values are not compared here.
Wanted wantedOf(const SampleCase& one, const std::vector<ShaderJob>& jobs) {
    Wanted wanted;
    for (std::size_t j = 0; j < jobs.size(); ++j) {
        for (std::size_t k = 0; k < perJob; ++k) {
            const Direction &wo = jobs[j].pairs.wo[k], &u = jobs[j].pairs.wi[k];
            std::vector<double> values(jobs[j].outputs(), std::nan("")), scales(values.size(), 1.0);
            if (j == 0) {
                values[4] = one.sampler->pdf(wo, u);
                if (values[4] > 0) scales[4] = values[4];
            } else if (wo.z <= 0 || !nearAChoice(one, wo, u.z)) {
                const Direction wi =
                    wo.z > 0 ? one.sampler->sample(wo, {u.x, u.y, u.z}).wi : Direction{0, 0, 0};
                std::tie(values[0], values[1], values[2]) = std::tie(wi.x, wi.y, wi.z);
            }
            wanted.values.insert(wanted.values.end(), values.begin(), values.end());
            wanted.scales.insert(wanted.scales.end(), scales.begin(), scales.end());
        }
    }
    return wanted;
}

/// Mean and standard error.
struct Mean {
    double count = 0, sum = 0, squares = 0;
    void add(double value) { ++count, sum += value, squares += value * value; }
    double mean() const { return sum / count; }
    double error() const {
        return std::sqrt(std::max(0.0, squares / count - mean() * mean()) / count);
    }
};

struct Laws {
    double probability = 1, albedo = 0;  ///< least p-value; largest distance in standard errors
};

/// Samples at one outgoing direction follow the density, which integrates to 1, and give the albedo
/// and the integral of another density.
void checkElevation(const SampleCase& one, const ShaderJob& job, const std::vector<float>& found,
                    Laws& laws) {
    const Direction wo = job.pairs.wo.front();
    std::vector<Direction> drawn, placing;
    UniformNumbers numbers(77);
    const std::size_t channels = job.channels();
    std::vector<Mean> albedo(channels);
    Mean cosine;
    for (std::size_t k = 0; k < perJob; ++k) {
        const Written w(job, found, k);
        ASSERT_GT(w.pdf, 0);
        ASSERT_GT(w.wi.z, 0);
        ASSERT_NEAR(dot(w.wi, w.wi), 1, 1e-6);
        drawn.push_back(w.wi);
        if (k % 2 == 0) placing.push_back(one.sampler->sample(wo, numbers.next()).wi);
        for (std::size_t c = 0; c < channels; ++c)
            albedo[c].add(static_cast<double>(w.f[c]) * (one.cosine() ? 1 : w.wi.z) / w.pdf);
        cosine.add(w.wi.z / pi / w.pdf);
    }
    const test::Partition partition(*one.sampler, wo, placing, 20000);
    EXPECT_NEAR(partition.integral(), 1, 2e-3);
    laws.probability = std::min(laws.probability, partition.chiSquare(drawn).probability);
    EXPECT_NEAR(cosine.mean(), 1, 4 * cosine.error() + 1e-6);
    const std::vector<double> expected = albedoOf(*one.brdf, wo);
    for (std::size_t c = 0; c < channels; ++c) {
        const double error = std::max(albedo[c].error(), 1e-4 * expected[c]);
        laws.albedo = std::max(laws.albedo, std::abs(albedo[c].mean() - expected[c]) / error);
    }
}

constexpr Bounds samplingBounds{1e-5, 5e-5};

/// The outputs of a case's program, by the modules of `sample` and `pdf`.
std::vector<float> runModules(const SampleCase& one, const ShaderJob& all) {
    const std::vector<gpu::SpirvModule> modules =
        one.form ? gpu::spirvModules(*one.form, {.storage = gpu::Storage::constants}, one.record)
                 : gpu::spirvModules(one.payload, "hsh", one.record);
    const std::size_t count = all.pairs.wo.size(), outputs = all.outputs();
    const std::vector<float> items = itemNumbers({all.pairs.wo, all.pairs.wi});
    std::vector<float> together(count * outputs);
    for (const gpu::SpirvModule& module : modules) {
        validateSpirv(module.words);
        EXPECT_EQ(listedBindings(disassembled(module.words)),
                  statedBindings(gpu::moduleText(module, "a.spv")));
        if (module.function == "eval") continue;
        std::vector<std::size_t> columns{4};
        if (module.function == "sample") {
            columns = {0, 1, 2, 3};
            for (std::size_t c = 5; c < outputs; ++c) columns.push_back(c);
        }
        const bool reads = module.function == "sample" && !one.form;
        const std::vector<float> found =
            runHere(boundModule(module.words, items, count, columns.size(),
                                reads ? boundTo(one.payload) : std::vector<ComputeResource>{}));
        for (std::size_t k = 0; k < count; ++k)
            for (std::size_t i = 0; i < columns.size(); ++i)
                together[k * outputs + columns[i]] = found[k * columns.size() + i];
        keepLast("modules, sampling", Language::glsl, one.name + ", " + module.function,
                 columnsOf(wantedOf(one, sampleJobs(one)), outputs, columns), samplingBounds);
    }
    return together;
}

void prove(Language language, Run runner = {}, const std::vector<SampleCase>& proved = cases(),
           bool modules = false) {
    const bool together = language != Language::glslEs;
    if (!runner) runner = runnerOf(language);
    for (const SampleCase& one : proved) {
        SCOPED_TRACE(one.name);
        const std::vector<ShaderJob> jobs = sampleJobs(one);
        if (modules)
            runner = [&](const ShaderJob& job, const std::string&) { return runModules(one, job); };
        std::vector<std::vector<float>> found;
        try {
            found = runAll(jobs, sampleProgram(language, jobs[0], sampleSnippet(language, one)),
                           runner, together);
        } catch (const Missing& reason) {
            GTEST_SKIP() << reason.what();
        } catch (const Refused& reason) {
            FAIL() << one.name << ": " << reason.what();
        }
        if (together && !modules)
            keepLast("sampling", language, one.name, wantedOf(one, jobs), samplingBounds);
        Agreement worst;
        comparePairs(one, jobs[0], found[0], worst);
        compareDraws(one, jobs[1], found[1], worst);
        Laws laws;
        for (std::size_t k = 2; k < jobs.size(); ++k) {
            compareDraws(one, jobs[k], found[k], worst);
            checkElevation(one, jobs[k], found[k], laws);
        }
        std::cout << fmt::format(
            "{:<24} wi {:.1e}  pdf {:.1e}, of pairs {:.1e}  chi-square p {:.3f}  albedo {:.1f} "
            "standard errors\n",
            one.name, worst.wi, worst.pdf, worst.other, laws.probability, laws.albedo);
        EXPECT_LE(worst.wi, samplingBounds.here());
        EXPECT_LE(worst.pdf, samplingBounds.here());
        EXPECT_LE(worst.other, samplingBounds.here());
        EXPECT_GT(laws.probability, test::sidak(proved.size() * sampleElevations().size() * 7));
        EXPECT_LE(laws.albedo, 4);
    }
}

TEST(ProposalShader, GlslOnVulkan) {
    prove(Language::glsl);
}
TEST(ProposalShader, HlslOnVulkan) {
    prove(Language::hlsl);
}
TEST(ProposalShader, SlangOnVulkan) {
    prove(Language::slang);
}
TEST(ProposalShader, WgslOnVulkan) {
    prove(Language::wgsl);
}
TEST(ProposalShader, SpirvModulesOnVulkan) {
    if (!gpu::compilesGlsl()) GTEST_SKIP() << "built without Vulkan (libvulkan-dev)";
    prove(Language::glsl, {}, cases(), true);
}
TEST(ProposalShader, GlslOnOpenGl) {
    prove(Language::glsl, runOpenGl);
}
TEST(ProposalShader, GlslEsOnOpenGlEs) {
    prove(Language::glslEs);
}
TEST(ProposalShader, MetalAsCpp) {
    prove(Language::metal);
}
TEST(ProposalShader, OslAsCpp) {
    prove(Language::osl);
}

TEST(LibraryProposalShader, GlslOnVulkan) {
    prove(Language::glsl, {}, libraryCases());
}
TEST(LibraryProposalShader, HlslOnVulkan) {
    prove(Language::hlsl, {}, libraryCases());
}
TEST(LibraryProposalShader, SlangOnVulkan) {
    prove(Language::slang, {}, libraryCases());
}
TEST(LibraryProposalShader, WgslOnVulkan) {
    prove(Language::wgsl, {}, libraryCases());
}
TEST(LibraryProposalShader, GlslEsOnOpenGlEs) {
    prove(Language::glslEs, {}, libraryCases());
}
TEST(LibraryProposalShader, MetalAsCpp) {
    prove(Language::metal, {}, libraryCases());
}
TEST(LibraryProposalShader, OslHasNone) {
    EXPECT_THROW(gpu::materialProposalSource(Language::osl, {.first = 3, .rows = 6}), UsageError);
}
TEST(LibraryProposalShader, TexelsOfAnisotropicProposalsAreRefused) {
    const Proposal proposal{{{ProposalLobe{60, 180, 90, 0}, ProposalLobe{}}}};
    EXPECT_THROW(gpu::proposalTexels(proposal), UsageError);
}

/// A fault in the text of `sample` is seen by the chi-square test.
TEST(ProposalShader, AWrongConstantFailsTheChiSquareTest) {
    const SampleCase& one = cases().front();
    const std::vector<ShaderJob> jobs = sampleJobs(one);
    std::string snippet = sampleSnippet(Language::metal, one);
    const std::string right = "(1.0 - u2) * (1.0 + cz)", wrong = "(1.0 - 0.8 * u2) * (1.0 + cz)";
    ASSERT_NE(snippet.find(right), std::string::npos);
    snippet.replace(snippet.find(right), right.size(), wrong);
    std::vector<float> found;
    try {
        found = runStub(jobs[3], sampleProgram(Language::metal, jobs[3], snippet));
    } catch (const Missing& reason) {
        GTEST_SKIP() << reason.what();
    }
    std::vector<Direction> drawn;
    for (std::size_t k = 0; k < perJob; ++k) drawn.push_back(Written(jobs[3], found, k).wi);
    const test::Partition partition(*one.sampler, jobs[3].pairs.wo.front(), drawn, 20000);
    EXPECT_LT(partition.chiSquare(drawn).probability, 1e-9);
}

}  // namespace
}  // namespace hshfit::shaders
