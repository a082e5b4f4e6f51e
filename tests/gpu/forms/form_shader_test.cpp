#include "../shaders/runners.h"
#include "form_samples.h"

#include <hshfit/gpu/forms/form_shader.h>
#include <hshfit/representation/forms/represented_brdf.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>

namespace hshfit::shaders {
namespace {

using gpu::Language;
using gpu::Storage;
using samples::FormSample;

std::unique_ptr<Brdf> constantBrdf();

std::unique_ptr<Brdf> onlyTheConstant(const std::string& spec) {
    if (spec == "constant") return constantBrdf();
    throw std::runtime_error("opens " + spec);
}

ShaderJob jobOf(const gpu::FormPayload& payload, Storage storage) {
    ShaderJob job{{}, directionPairs(), {.order = 0, .colours = 0, .values = {}}};
    job.payload.head = payload.form.head;
    job.payload.coefficients = payload.texels;
    job.form = gpu::storageName(storage);
    return job;
}

/// f of the library in double precision, [pair][channel].
std::vector<double> expected(const gpu::FormPayload& payload, const Pairs& pairs) {
    const auto brdf = reconstruct(payload.form, onlyTheConstant);
    const std::size_t channels = brdf->channels().count();
    std::vector<double> values(pairs.wo.size() * channels);
    for (std::size_t k = 0; k < pairs.wo.size(); ++k) {
        const Direction& wi = pairs.wi[k];
        brdf->eval(pairs.wo[k], {&wi.x, &wi.y, &wi.z, 1}, values.data() + k * channels);
    }
    for (double& value : values) value = std::max(value, 0.0);
    return values;
}

/// Relative to 1 + |f|: the form keeps ln(1 + f), which single precision rounds. Where f
/// cos(theta_i) was projected, f cos(theta_i) is compared.
Wanted wantedOf(const std::vector<double>& expected, const ShaderJob& job) {
    const bool cosine = job.payload.head.quantity == Quantity::brdfCosine;
    std::vector<double> scales;
    for (std::size_t i = 0; i < expected.size(); ++i) {
        const double f = expected[i];
        const double factor = cosine && f != 0 ? job.pairs.wi[i / job.channels()].z : 1;
        scales.push_back((1 + std::abs(f)) / factor);
    }
    return writtenTwice(job, expected, scales);
}

bool takes(Language language, const gpu::FormPayload& payload, Storage storage) {
    const bool integers = storage == Storage::texture && isNormalised(payload.texels.number);
    if (language != Language::osl) return true;
    return storage == Storage::constants || (storage == Storage::texture && !integers);
}

/// `kind` is the one that shaders are kept under.
void prove(const char* kind, Language language, const std::vector<FormSample>& samples,
           Run runner = {}) {
    if (!runner) runner = runnerOf(language);
    std::size_t index = static_cast<std::size_t>(language);
    for (const FormSample& sample : samples) {
        gpu::FormPayload payload = gpu::packForm(sample.form);
        if (!sample.form.added.empty())
            payload.constant.assign(payload.form.head.channels.count(), 0.25);
        const Storage all[] = {Storage::constants, Storage::block, Storage::texture};
        const std::vector<double> values = expected(payload, directionPairs());
        // One or two of the three take turns; compilers need most of the time.
        const std::size_t turn = index++;
        for (const Storage storage : all) {
            const bool left = (static_cast<std::size_t>(storage) + turn) % 2 == 0;
            if (!takes(language, payload, storage) || left) continue;
            const ShaderJob job = jobOf(payload, storage);
            std::vector<float> found;
            try {
                found = runner(
                    job, wrapped(language, job,
                                 gpu::formShaderSource(language, payload, {.storage = storage})));
            } catch (const Missing& reason) {
                GTEST_SKIP() << reason.what();
            } catch (const Refused& reason) {
                FAIL() << sample.name << ", " << job.form << ": " << reason.what();
            }
            const Wanted wanted = wantedOf(values, job);
            const double difference = largestDifference(wanted, found);
            std::cout << fmt::format("{:<40} {:<10} {:.1e}\n", sample.name, job.form, difference);
            const Bounds bounds{1e-5, 1e-5};
            EXPECT_LE(difference, bounds.here()) << sample.name << ", " << job.form;
            keepLast(kind, language, sample.name + ", " + job.form, wanted, bounds);
        }
    }
}

TEST(BasisShader, GlslOnVulkan) {
    prove("basis", Language::glsl, samples::basisSamples());
}
TEST(BasisShader, HlslOnVulkan) {
    prove("basis", Language::hlsl, samples::basisSamples());
}
TEST(BasisShader, SlangOnVulkan) {
    prove("basis", Language::slang, samples::basisSamples());
}
TEST(BasisShader, WgslOnVulkan) {
    prove("basis", Language::wgsl, samples::basisSamples());
}
TEST(BasisShader, GlslOnOpenGl) {
    prove("basis", Language::glsl, samples::basisSamples(), runOpenGl);
}
TEST(BasisShader, GlslEsOnOpenGlEs) {
    prove("basis", Language::glslEs, samples::basisSamples());
}
TEST(BasisShader, MetalAsCpp) {
    prove("basis", Language::metal, samples::basisSamples());
}
TEST(BasisShader, OslAsCpp) {
    prove("basis", Language::osl, samples::basisSamples());
}

TEST(FactoredShader, GlslOnVulkan) {
    prove("basis in factors", Language::glsl, samples::factoredSamples());
}
TEST(FactoredShader, HlslOnVulkan) {
    prove("basis in factors", Language::hlsl, samples::factoredSamples());
}
TEST(FactoredShader, SlangOnVulkan) {
    prove("basis in factors", Language::slang, samples::factoredSamples());
}
TEST(FactoredShader, WgslOnVulkan) {
    prove("basis in factors", Language::wgsl, samples::factoredSamples());
}
TEST(FactoredShader, GlslOnOpenGl) {
    prove("basis in factors", Language::glsl, samples::factoredSamples(), runOpenGl);
}
TEST(FactoredShader, GlslEsOnOpenGlEs) {
    prove("basis in factors", Language::glslEs, samples::factoredSamples());
}
TEST(FactoredShader, MetalAsCpp) {
    prove("basis in factors", Language::metal, samples::factoredSamples());
}
TEST(FactoredShader, OslAsCpp) {
    prove("basis in factors", Language::osl, samples::factoredSamples());
}

/// f = 0.25 in every channel, for the tests of what a form adds.
class Constant final : public Brdf {
public:
    std::string name() const override { return "constant"; }
    const Channels& channels() const override { return channels_; }
    const Laws& laws() const override { return laws_; }
    void eval(const Direction& wo, DirectionBatch wi, double* out) const override {
        for (std::size_t k = 0; k < wi.count; ++k) out[k] = wo.z > 0 && wi.z[k] > 0 ? 0.25 : 0;
    }

private:
    Channels channels_ = Channels::grey();
    Laws laws_;
};

std::unique_ptr<Brdf> constantBrdf() {
    return std::make_unique<Constant>();
}

/// Forms of which a Lambert term was split off.
TEST(SplitShader, AddsTheConstantInEveryLanguage) {
    std::vector<FormSample> all{samples::halfwaySamples()[1], samples::halfwaySamples()[13],
                                samples::basisSamples()[1], samples::basisSamples()[4]};
    for (FormSample& sample : all) sample.form.added = "constant";
    for (const Language language : {Language::glsl, Language::hlsl, Language::wgsl,
                                    Language::glslEs, Language::metal, Language::osl})
        prove("with a Lambert term", language, all);
}

class HalfwayShader : public testing::Test {
protected:
    const std::vector<FormSample> samples = samples::halfwaySamples();
};

TEST_F(HalfwayShader, GlslOnVulkan) {
    prove("halfway", Language::glsl, samples);
}
TEST_F(HalfwayShader, HlslOnVulkan) {
    prove("halfway", Language::hlsl, samples);
}
TEST_F(HalfwayShader, SlangOnVulkan) {
    prove("halfway", Language::slang, samples);
}
TEST_F(HalfwayShader, WgslOnVulkan) {
    prove("halfway", Language::wgsl, samples);
}
TEST_F(HalfwayShader, GlslOnOpenGl) {
    prove("halfway", Language::glsl, samples, runOpenGl);
}
TEST_F(HalfwayShader, GlslEsOnOpenGlEs) {
    prove("halfway", Language::glslEs, samples);
}
TEST_F(HalfwayShader, MetalAsCpp) {
    prove("halfway", Language::metal, samples);
}
TEST_F(HalfwayShader, OslAsCpp) {
    prove("halfway", Language::osl, samples);
}

}  // namespace
}  // namespace hshfit::shaders
