// Exports of forms are read back as the coefficient files that they came from.

#include "../containers/container_samples.h"
#include "form_samples.h"

#include <hshfit/coefficient_files/coefficient_formats.h>
#include <hshfit/error.h>
#include <hshfit/gpu/forms/form_files.h>
#include <hshfit/gpu/forms/form_shader.h>
#include <hshfit/gpu/forms/form_table.h>
#include <hshfit/representation/named_arrays.h>

#include <gtest/gtest.h>

#include <set>

namespace hshfit::gpu {
namespace {

using samples::contentOf;
using samples::Folder;

std::unique_ptr<Brdf> nothingToOpen(const std::string& spec) {
    throw UsageError("opens " + spec);
}

std::vector<samples::FormSample> allSamples() {
    std::vector<samples::FormSample> all = samples::halfwaySamples();
    for (samples::FormSample& sample : samples::basisSamples()) all.push_back(std::move(sample));
    for (samples::FormSample& sample : samples::factoredSamples()) all.push_back(std::move(sample));
    return all;
}

std::vector<ExportedFile> exportForm(const std::string& folder, const FormPayload& payload) {
    std::vector<const Container*> chosen;
    for (const Container& container : containers::catalog())
        if (container.holds(payload.texels.number)) chosen.push_back(&container);
    FileSet files(folder, true);
    auto written = writeForm(payload, chosen, "sample", {}, nothingToOpen, files);
    files.commit();
    return written;
}

TEST(FormFiles, EveryContainerGivesTheCoefficientFileAgain) {
    for (const samples::FormSample& sample : allSamples()) {
        const Folder folder;
        const FormPayload payload = packForm(sample.form);
        const std::string before = representationToJson(sample.form);
        const std::vector<ExportedFile> files = exportForm(folder.path(), payload);
        const ImportedForm beside = readForm(folder / "sample.hsh.json", nothingToOpen);
        EXPECT_EQ(representationToJson(beside.payload.form), before) << sample.name;
        for (const ExportedFile& file : files) {
            EXPECT_TRUE(looksLikeForm(folder / file.path)) << file.path;
            const ImportedForm read = readForm(folder / file.path, nothingToOpen);
            // Parts for one layer are one part: an EXR like any other.
            const bool parts = file.container == "exr-parts";
            EXPECT_EQ(read.container, parts ? "exr" : file.container);
            EXPECT_EQ(representationToJson(read.payload.form), before)
                << sample.name << ", " << file.container;
            EXPECT_EQ(read.payload.texels.bytes, payload.texels.bytes);
        }
    }
}

TEST(FormPayload, TheNumberTypeIsTheSmallestThatHoldsTheFile) {
    const std::map<std::string, Number> wanted{{"12,6,3 rgb, float32", Number::float32},
                                               {"7,4,2 rgb, half", Number::float16},
                                               {"7,4,2 rgb, unorm16", Number::unorm16},
                                               {"7,4,2 rgb, unorm8", Number::unorm8}};
    std::size_t found = 0;
    for (const samples::FormSample& sample : samples::halfwaySamples()) {
        if (!wanted.contains(sample.name)) continue;
        EXPECT_EQ(packForm(sample.form).texels.number, wanted.at(sample.name)) << sample.name;
        ++found;
    }
    EXPECT_EQ(found, wanted.size());
}

TEST(FormPayload, EveryKeptNumberIsInTheStreamOnce) {
    for (const samples::FormSample& sample : allSamples()) {
        std::set<std::pair<std::uint32_t, std::uint32_t>> places;
        for (const StreamNumber& number : packForm(sample.form).stream) {
            if (number.array == StreamNumber::nothing) continue;
            EXPECT_TRUE(places.emplace(number.array, number.value).second) << sample.name;
        }
        // The lobe and the ceilings are numbers beside the arrays.
        std::size_t beside = 0;
        if (sample.form.as<HalfwayArray>()) {
            beside = 3 * sample.form.head.channels.count() + (sample.form.head.isotropic ? 2 : 4);
        }
        EXPECT_EQ(places.size(), sample.form.numbers() - beside);
    }
}

/// value = texel * scale + offset, for every type of texel and of array that it holds.
TEST(FormPayload, TexelsDecodeToTheValuesOfTheFile) {
    for (const samples::FormSample& sample : allSamples()) {
        for (const Number number :
             {Number::float32, Number::float16, Number::unorm16, Number::unorm8}) {
            const FormPayload payload = packForm(sample.form, number);
            const std::vector<double> texels = decode(payload.texels);
            for (std::size_t n = 0; n < payload.stream.size(); ++n) {
                if (payload.stream[n].array == StreamNumber::nothing) continue;
                const LaneScale lane = payload.scaleOf(payload.stream[n]);
                const double value = payload.valueOf(payload.stream[n]);
                ASSERT_NEAR(texels[n] * lane.scale + lane.offset, value, 1e-12)
                    << sample.name << ", " << numberName(number);
            }
        }
    }
}

TEST(FormPayload, RoundingToAnotherTypeIsRecordedAsAStep) {
    const Representation form = samples::halfwaySamples()[0].form;
    EXPECT_TRUE(packForm(form).form.steps.empty());
    const auto steps = packForm(form, Number::unorm8).form.steps;
    ASSERT_EQ(steps.size(), 1u);
    EXPECT_EQ(steps[0].what, "unorm8");
    EXPECT_GT(steps[0].change, 0);
}

/// Sidecars that lie: each change is refused with the name of the file.
TEST(FormFiles, ChangedSidecarsAreRefused) {
    const Folder folder;
    exportForm(folder.path(), packForm(samples::halfwaySamples()[1].form));
    const std::string path = folder / "sample.hsh.json", text = contentOf(path);
    const std::pair<const char*, const char*> changes[] = {
        {"\"form\": \"halfway\"", "\"form\": \"basis\""},
        {"\"form\": \"halfway\"", "\"form\": 3"},
        {"\"half\":7", "\"half\":6"},
        {"\"half\":7", "\"half\":1000000"},
        {"\"precision\":\"half\"", "\"precision\":\"unorm8\""},
        {"\"precision\":\"half\"", "\"precision\":\"quarter\""},
        {"\"numbers\":", "\"numbers\":1"},
        {"\"along\":0.3", "\"along\":-1"},
        {"\"across\":0.3", "\"across\":0.2"},
        {"\"width\":21", "\"width\":20"},
        {"\"head\":\"\"", "\"head\":\"AAAA\""},
        {"\"version\": 2", "\"version\": 3"},
        {"\"isotropic\":true", "\"isotropic\":false"},
    };
    for (const auto& [from, to] : changes) {
        std::string changed = text;
        const std::size_t at = changed.find(from);
        ASSERT_NE(at, std::string::npos) << from;
        changed.replace(at, std::string(from).size(), to);
        samples::put(path, changed);
        try {
            readForm(path, nothingToOpen);
            ADD_FAILURE() << "accepted: " << to;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find("sample"), std::string::npos) << error.what();
        }
    }
}

TEST(FormTable, FormsWithoutAShaderAreRefused) {
    Representation outgoing;
    outgoing.content = CoefficientArray{};
    EXPECT_FALSE(hasShader(outgoing));
    EXPECT_THROW(packForm(outgoing), UsageError);
    Representation split = samples::halfwaySamples()[0].form;
    EXPECT_TRUE(hasShader(split));
    split.added = "ggx";
    EXPECT_FALSE(hasShader(split));
    EXPECT_THROW(formShaderSource(Language::glsl, packForm(split), {}), UsageError);
    EXPECT_TRUE(hasShader(split, true));
}

TEST(FormShader, BlocksBeyondSixteenKibibytesAreRefused) {
    samples::FormSample large = samples::factoredSamples()[4];
    FormPayload payload = packForm(large.form);
    payload.stream.resize(4 * mostConstants);
    EXPECT_THROW(formShaderSource(Language::glsl, payload, {.storage = Storage::block}),
                 UsageError);
}

/// Arrays that claim more numbers than there are texels, and orders that no matrix goes with.
TEST(FormFiles, HugeClaimsAreRefusedBeforeMemoryIsAllocated) {
    const Folder folder;
    exportForm(folder.path(), packForm(samples::basisSamples()[0].form));
    const std::string path = folder / "sample.hsh.json", text = contentOf(path);
    const std::pair<const char*, const char*> changes[] = {
        {"\"order\":4", "\"order\":2000"},
        {"\"numbers\":", "\"numbers\":99"},
        {"\"shape\":[3,", "\"shape\":[3000000000,"},
    };
    for (const auto& [from, to] : changes) {
        std::string changed = text;
        const std::size_t at = changed.find(from);
        ASSERT_NE(at, std::string::npos) << from;
        changed.replace(at, std::string(from).size(), to);
        samples::put(path, changed);
        EXPECT_THROW(readForm(path, nothingToOpen), InputError) << to;
    }
}

}  // namespace
}  // namespace hshfit::gpu
