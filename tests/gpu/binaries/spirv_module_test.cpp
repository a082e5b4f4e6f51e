// SPIR-V modules as their users take them: valid by spirv-val, with the documented interface by
// spirv-dis, and with the library's values, in double precision, on Vulkan.
#include "../forms/form_samples.h"
#include "../shaders/runners.h"
#include "../shaders/variants.h"
#include "bound_module.h"

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
using Words = std::vector<std::uint32_t>;

/// The values of the module of `eval` for all pairs, [pair][channel]; `bound` is what the form
/// reads.
std::vector<float> runModule(const gpu::SpirvModule& module, std::size_t channels,
                             std::vector<ComputeResource> bound) {
    validateSpirv(module.words);
    EXPECT_EQ(listedBindings(disassembled(module.words)),
              statedBindings(gpu::moduleText(module, "a.spv")));
    const Pairs pairs = directionPairs();
    std::vector<float> found = runHere(boundModule(module.words, itemNumbers({pairs.wo, pairs.wi}),
                                                   pairs.wo.size(), channels, std::move(bound)));
    found.resize(pairs.wo.size() * channels);
    return found;
}

/// The bindings without what is said of each.
std::set<std::string> bindingsOf(const Words& words) {
    std::set<std::string> found;
    for (const std::string& line : listedBindings(disassembled(words)))
        found.insert(line.substr(2, line.find(' ') - 2));
    return found;
}

class SpirvModule : public testing::Test {
    void SetUp() override {
        if (!gpu::compilesGlsl()) GTEST_SKIP() << "built without Vulkan (libvulkan-dev)";
    }
};

TEST_F(SpirvModule, CoefficientsGiveThoseOfTheLibrary) {
    for (Variant& variant : variants()) {
        const bool tabulated = variant.payload.basisTexels.has_value();
        const bool bytes = variant.payload.coefficients.number == gpu::Number::unorm8;
        const ShaderJob job = makeJob(std::move(variant.payload), 1);
        std::vector<float> found;
        std::set<std::string> bound;
        try {
            const gpu::SpirvModule module = gpu::spirvModules(job.payload, "hsh").front();
            bound = bindingsOf(module.words);
            found = runModule(module, job.channels(), boundTo(job.payload));
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
        EXPECT_EQ(bound, bindings) << variant.name;
    }
}

TEST_F(SpirvModule, FormsGiveThoseOfTheLibraryOnVulkan) {
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
        const auto brdf = reconstruct(payload.form, {});
        const std::size_t channels = brdf->channels().count();
        std::vector<float> found;
        try {
            const gpu::SpirvModule module =
                gpu::spirvModules(payload, {.prefix = "paint", .storage = storage}).front();
            EXPECT_EQ(bindingsOf(module.words).contains("0"), storage != gpu::Storage::constants)
                << sample.name;
            found = runModule(module, channels, boundTo(payload, storage));
        } catch (const Missing& reason) {
            GTEST_SKIP() << reason.what();
        }
        const Pairs pairs = directionPairs();
        const bool cosine = payload.form.head.quantity == Quantity::brdfCosine;
        Wanted wanted;
        std::vector<double> values(channels);
        for (std::size_t k = 0; k < pairs.wo.size(); ++k) {
            const Direction& wi = pairs.wi[k];
            brdf->eval(pairs.wo[k], {&wi.x, &wi.y, &wi.z, 1}, values.data());
            const double share = cosine ? std::max(wi.z, 1e-6) : 1;
            for (const double value : values) {
                wanted.values.push_back(std::max(value, 0.0));
                wanted.scales.push_back((1 + wanted.values.back()) / share);
            }
        }
        const double worst = largestDifference(wanted, found);
        std::cout << fmt::format("{:<40} {:<10} {:.1e}\n", sample.name, gpu::storageName(storage),
                                 worst);
        const Bounds bounds{1e-5, 5e-5};
        EXPECT_LE(worst, bounds.here()) << sample.name;
        keepLast("modules", gpu::Language::glsl,
                 sample.name + ", " + std::string(gpu::storageName(storage)), wanted, bounds);
    }
}

TEST_F(SpirvModule, HasOneComputeEntryWhoseGroupsAreSpecialised) {
    try {
        const Words words = gpu::spirvModules(gpu::packForm(samples::halfwaySamples().front().form),
                                              {.prefix = "paint"})
                                .front()
                                .words;
        const std::string listing = disassembled(words);
        const std::regex entry(R"x(OpEntryPoint (\w+) \S+ "(\w+)")x");
        const std::vector<std::smatch> entries(
            std::sregex_iterator(listing.begin(), listing.end(), entry), std::sregex_iterator());
        ASSERT_EQ(entries.size(), 1u) << listing;
        EXPECT_EQ(entries[0][1], "GLCompute");
        EXPECT_EQ(entries[0][2], "main");
        EXPECT_TRUE(std::regex_search(listing, std::regex(R"(OpDecorate \S+ SpecId 0)")));
        EXPECT_TRUE(std::regex_search(listing, std::regex(R"(OpSpecConstant %uint 64)")));
        EXPECT_EQ(bindingsOf(words), (std::set<std::string>{"2", "3"}));
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
