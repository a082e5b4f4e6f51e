// SPIR-V modules as their users take them: valid by spirv-val, with the documented interface by
// spirv-dis, and with the library's values, in double precision, on Vulkan.
#include "../forms/form_samples.h"
#include "../shaders/runners.h"
#include "../shaders/variants.h"

#include <hshfit/gpu/binaries/spirv_module.h>
#include <hshfit/gpu/vulkan/spirv.h>
#include <hshfit/representation/forms/represented_brdf.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <regex>
#include <set>

namespace hshfit::shaders {
namespace {

using gpu::ComputeResource;
using Kind = ComputeResource::Kind;
using Words = std::vector<std::uint32_t>;

/// wo and wi of every pair, each a vec4.
std::vector<float> pairNumbers(const Pairs& pairs) {
    std::vector<float> numbers;
    for (std::size_t k = 0; k < pairs.wo.size(); ++k) {
        for (const Direction& d : {pairs.wo[k], pairs.wi[k]})
            for (const double v : {d.x, d.y, d.z, -7.0}) numbers.push_back(static_cast<float>(v));
    }
    return numbers;
}

/// The values of a module for all pairs, [pair][channel]; `bound` is what the form reads.
std::vector<float> runModule(const Words& words, std::size_t channels,
                             std::vector<ComputeResource> bound) {
    validateSpirv(words);
    const auto device = vulkanDevice(true);
    const Pairs pairs = directionPairs();
    const std::size_t count = pairs.wo.size();
    bound.push_back({.binding = 2, .numbers = pairNumbers(pairs)});
    bound.push_back({.binding = 3, .count = count * channels});
    std::vector<float> found;
    {
        gpu::ComputeProgram program(*device, words, std::move(bound));
        // A group too many: its items lie beyond the pairs.
        program.run(static_cast<std::uint32_t>(count / gpu::spirvGroup + 1));
        found = program.read(3);
    }
    found.resize(count * channels);
    const std::vector<std::string> messages = device->messages();
    if (!messages.empty()) throw Refused(messages.front());
    return found;
}

std::set<std::string> bindingsOf(const std::string& listing) {
    std::set<std::string> found;
    const std::regex line(R"(OpDecorate \S+ Binding (\d+))");
    for (std::sregex_iterator each(listing.begin(), listing.end(), line), end; each != end; ++each)
        found.insert((*each)[1]);
    return found;
}

class SpirvModule : public testing::Test {
    void SetUp() override {
        if (!gpu::compilesGlsl()) GTEST_SKIP() << "built without Vulkan (libvulkan-dev)";
    }
};

TEST_F(SpirvModule, CoefficientsAreThoseOfTheLibrary) {
    for (Variant& variant : variants()) {
        const bool tabulated = variant.payload.basisTexels.has_value();
        const bool bytes = variant.payload.coefficients.number == gpu::Number::unorm8;
        const ShaderJob job = makeJob(std::move(variant.payload), 1);
        std::vector<ComputeResource> bound{
            {.binding = 0, .kind = Kind::sampledTexture, .texels = job.payload.coefficients}};
        if (tabulated)
            bound.push_back(
                {.binding = 1, .kind = Kind::sampledTexture, .texels = *job.payload.basisTexels});
        std::vector<float> found;
        std::string listing;
        try {
            const Words words = gpu::spirvModule(job.payload, "hsh");
            listing = disassembled(words);
            found = runModule(words, job.channels(), std::move(bound));
        } catch (const Missing& reason) {
            GTEST_SKIP() << reason.what();
        }
        const std::vector<double> all = reference(job);
        double worst = 0, most = 0;
        for (std::size_t i = 0; i < found.size(); ++i) {
            const double value =
                all[i / job.channels() * job.outputs() + job.channels() + i % job.channels()];
            const double d = std::abs(found[i] - value);
            worst = std::max(worst, d < 1e30 ? d : 1e30);
            most = std::max(most, value);
        }
        std::cout << fmt::format("{:<48} {:.1e}\n", variant.name, worst / most);
        // The tolerances of shader_proof_test.
        EXPECT_LE(worst / most, bytes ? 1e-2 : variant.noise ? 1e-5 : 2e-6) << variant.name;
        std::set<std::string> bindings{"0", "2", "3"};
        if (tabulated) bindings.insert("1");
        EXPECT_EQ(bindingsOf(listing), bindings) << variant.name;
    }
}

TEST_F(SpirvModule, FormsAreThoseOfTheLibrary) {
    std::vector<samples::FormSample> forms = samples::halfwaySamples();
    for (const auto& more : {samples::basisSamples(), samples::factoredSamples()})
        forms.insert(forms.end(), more.begin(), more.begin() + 2);
    std::size_t turn = 0;
    for (const samples::FormSample& sample : forms) {
        gpu::FormPayload payload = gpu::packForm(sample.form);
        if (!sample.form.added.empty()) continue;
        constexpr gpu::Storage all[] = {gpu::Storage::constants, gpu::Storage::block,
                                        gpu::Storage::texture};
        const gpu::Storage storage = all[turn++ % 3];
        std::vector<ComputeResource> bound;
        if (storage == gpu::Storage::texture)
            bound.push_back({.kind = Kind::sampledTexture, .texels = payload.texels});
        if (storage == gpu::Storage::block) {
            const std::vector<double> numbers = gpu::decode(payload.texels);
            bound.push_back({.kind = Kind::uniforms, .numbers = {numbers.begin(), numbers.end()}});
        }
        const auto brdf = reconstruct(payload.form, {});
        const std::size_t channels = brdf->channels().count();
        std::vector<float> found;
        try {
            const Words words = gpu::spirvModule(payload, {.prefix = "paint", .storage = storage});
            const std::set<std::string> bindings = bindingsOf(disassembled(words));
            EXPECT_EQ(bindings.contains("0"), storage != gpu::Storage::constants) << sample.name;
            found = runModule(words, channels, std::move(bound));
        } catch (const Missing& reason) {
            GTEST_SKIP() << reason.what();
        }
        const Pairs pairs = directionPairs();
        const bool cosine = payload.form.head.quantity == Quantity::brdfCosine;
        double worst = 0;
        std::vector<double> values(channels);
        for (std::size_t k = 0; k < pairs.wo.size(); ++k) {
            const Direction& wi = pairs.wi[k];
            brdf->eval(pairs.wo[k], {&wi.x, &wi.y, &wi.z, 1}, values.data());
            for (std::size_t c = 0; c < channels; ++c) {
                const double value = std::max(values[c], 0.0);
                double d = std::abs(found[k * channels + c] - value) / (1 + value);
                if (cosine) d *= std::max(wi.z, 0.0);
                worst = std::max(worst, d < 1e30 ? d : 1e30);
            }
        }
        std::cout << fmt::format("{:<40} {:<10} {:.1e}\n", sample.name, gpu::storageName(storage),
                                 worst);
        EXPECT_LE(worst, 1e-5) << sample.name;
    }
}

TEST_F(SpirvModule, HasOneComputeEntryWhoseGroupsAreSpecialised) {
    try {
        const Words words = gpu::spirvModule(gpu::packForm(samples::halfwaySamples().front().form),
                                             {.prefix = "paint"});
        const std::string listing = disassembled(words);
        const std::regex entry(R"x(OpEntryPoint (\w+) \S+ "(\w+)")x");
        const std::vector<std::smatch> entries(
            std::sregex_iterator(listing.begin(), listing.end(), entry), std::sregex_iterator());
        ASSERT_EQ(entries.size(), 1u) << listing;
        EXPECT_EQ(entries[0][1], "GLCompute");
        EXPECT_EQ(entries[0][2], "main");
        EXPECT_TRUE(std::regex_search(listing, std::regex(R"(OpDecorate \S+ SpecId 0)")));
        EXPECT_TRUE(std::regex_search(listing, std::regex(R"(OpSpecConstant %uint 64)")));
        EXPECT_EQ(bindingsOf(listing), (std::set<std::string>{"2", "3"}));
        // The bytes begin with the magic number, the lowest byte first (SPIR-V specification 2.3).
        EXPECT_EQ(gpu::spirvBytes(words).substr(0, 4), "\x03\x02\x23\x07");
        Words broken = words;
        broken[words.size() - 1] ^= 0x10000;
        EXPECT_THROW(validateSpirv(broken), Refused);
    } catch (const Missing& reason) {
        GTEST_SKIP() << reason.what();
    }
}

}  // namespace
}  // namespace hshfit::shaders
