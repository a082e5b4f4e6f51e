// Every container of the table, for every number type that it holds and every kind of payload:
// what is read is what was written, to the bit.

#include "container_samples.h"

#include <hshfit/error.h>
#include <hshfit/files/checksum.h>

#include <algorithm>
#include <cstring>
#include <set>

#include <gtest/gtest.h>

namespace hshfit::gpu {
namespace {

using samples::Folder;
using test::exportTo;
using test::Sample;
using test::samplePayloads;

void expectSameTexels(const Texels& a, const Texels& b) {
    EXPECT_EQ(a.width, b.width);
    EXPECT_EQ(a.height, b.height);
    EXPECT_EQ(a.layers, b.layers);
    EXPECT_EQ(a.number, b.number);
    EXPECT_TRUE(a.bytes == b.bytes);
    ASSERT_EQ(a.scales.size(), b.scales.size());
    for (std::size_t i = 0; i < a.scales.size(); ++i) {
        EXPECT_EQ(a.scales[i].scale, b.scales[i].scale);
        EXPECT_EQ(a.scales[i].offset, b.scales[i].offset);
    }
}

void expectSame(const Payload& a, const Payload& b) {
    EXPECT_EQ(a.head.basis, b.head.basis);
    EXPECT_EQ(a.head.order, b.head.order);
    EXPECT_EQ(a.head.condonShortley, b.head.condonShortley);
    EXPECT_EQ(a.head.quantity, b.head.quantity);
    EXPECT_EQ(a.head.channels.kind, b.head.channels.kind);
    EXPECT_EQ(a.head.channels.wavelengths, b.head.channels.wavelengths);
    EXPECT_EQ(a.head.isotropic, b.head.isotropic);
    EXPECT_EQ(a.head.bilateral, b.head.bilateral);
    EXPECT_EQ(a.head.reciprocal, b.head.reciprocal);
    EXPECT_EQ(a.head.outgoing.map, b.head.outgoing.map);
    ASSERT_EQ(a.head.outgoing.size(), b.head.outgoing.size());
    for (std::size_t i = 0; i < a.head.outgoing.size(); ++i) {
        EXPECT_EQ(a.head.outgoing.directions[i].x, b.head.outgoing.directions[i].x);
        EXPECT_EQ(a.head.outgoing.directions[i].y, b.head.outgoing.directions[i].y);
        EXPECT_EQ(a.head.outgoing.directions[i].z, b.head.outgoing.directions[i].z);
    }
    EXPECT_EQ(a.head.energy.finite, b.head.energy.finite);
    EXPECT_EQ(a.head.energy.reason, b.head.energy.reason);
    EXPECT_EQ(a.head.error, b.head.error);
    EXPECT_EQ(a.head.source, b.head.source);
    EXPECT_EQ(a.head.generator, b.head.generator);
    EXPECT_EQ(a.packing, b.packing);
    EXPECT_EQ(a.slots, b.slots);
    EXPECT_EQ(a.toChannels, b.toChannels);
    ASSERT_EQ(a.stored.size(), b.stored.size());
    for (std::size_t i = 0; i < a.stored.size(); ++i) {
        EXPECT_EQ(a.stored[i].name, b.stored[i].name);
        EXPECT_EQ(a.stored[i].slots, b.stored[i].slots);
        EXPECT_EQ(a.stored[i].firstLayer, b.stored[i].firstLayer);
    }
    expectSameTexels(a.coefficients, b.coefficients);
}

TEST(Containers, TableIsWhole) {
    std::set<std::string_view> names, suffixes;
    for (const Container& container : containers::catalog()) {
        EXPECT_TRUE(names.insert(container.name).second);
        EXPECT_TRUE(suffixes.insert(container.suffix).second);
        EXPECT_FALSE(container.summary.empty());
        EXPECT_TRUE(container.holds(Number::float16)) << container.name;
        EXPECT_EQ(container.holdsSidecar, container.sidecar != nullptr) << container.name;
        EXPECT_EQ(&findContainer(container.name), &container);
    }
    EXPECT_THROW(findContainer("png"), UsageError);
}

// With a folder per file, so that nothing comes from a neighbour.
TEST(Containers, EveryFileOfEveryPayloadReadsBack) {
    std::size_t imported = 0;
    for (const Number number : test::numbers) {
        for (const Sample& sample : samplePayloads(number)) {
            SCOPED_TRACE(sample.what + ", " + numberName(number));
            const Folder folder;
            const auto written = exportTo(folder.path(), sample.payload);
            const ImportedPayload beside = readPayload(folder / "sample.hsh.json");
            expectSame(beside.payload, sample.payload);
            EXPECT_GE(beside.tests, 64U);
            EXPECT_EQ(beside.testDifference, 0);
            EXPECT_EQ(beside.payload.basisTexels.has_value(),
                      sample.payload.basisTexels.has_value());
            if (beside.payload.basisTexels && sample.payload.basisTexels) {
                expectSameTexels(*beside.payload.basisTexels, *sample.payload.basisTexels);
            }
            for (const ExportedFile& file : written) {
                SCOPED_TRACE(file.path);
                const Container& container = findContainer(file.container);
                const Folder alone;
                std::filesystem::copy(folder / file.path, alone / file.path);
                EXPECT_EQ(samples::contentOf(alone / file.path).size(), file.bytes);
                EXPECT_EQ(sha256(samples::contentOf(alone / file.path)), file.sha256);
                if (!container.holdsSidecar) {
                    EXPECT_FALSE(looksLikePayload(alone / file.path));
                    EXPECT_THROW(readPayload(alone / file.path), InputError);
                    std::filesystem::copy(folder / "sample.hsh.json", alone / "sample.hsh.json");
                }
                EXPECT_TRUE(looksLikePayload(alone / file.path));
                if (file.role == Role::basis) {
                    EXPECT_THROW(readPayload(alone / file.path), InputError);
                    continue;
                }
                const ImportedPayload read = readPayload(alone / file.path);
                expectSame(read.payload, sample.payload);
                EXPECT_EQ(read.container, file.container);
                EXPECT_EQ(read.file, alone / file.path);
                ++imported;
            }
        }
    }
    std::size_t held = 0;
    for (const Container& container : containers::catalog()) held += 10 * container.numbers.size();
    EXPECT_EQ(imported, held) << "10 payloads, in each container, of each number that it holds";
}

TEST(Containers, AreByteIdenticalFromRunToRun) {
    const Payload payload = samplePayloads(Number::float16).back().payload;
    const Folder first, second;
    exportTo(first.path(), payload, {}, {.zstd = true});
    exportTo(second.path(), payload, {}, {.zstd = true});
    std::size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(first.path())) {
        const std::string name = entry.path().filename();
        EXPECT_EQ(samples::contentOf(first / name), samples::contentOf(second / name)) << name;
        ++files;
    }
    EXPECT_EQ(files, containers::catalog().size() + 2);
}

TEST(Containers, ZstandardShrinksKtx2AndReadsBack) {
    Coefficients c =
        samples::asymmetric("hsh", 4, OutgoingSet::parabolic(32, 32), Channels::rgb(), 1);
    for (double& value : c.values) value = std::round(value * 8) / 8;
    const Payload payload = pack(c, {});
    const Folder folder;
    const auto plain = exportTo(folder / "plain", payload, {"ktx2"});
    const auto small = exportTo(folder / "small", payload, {"ktx2"}, {.zstd = true});
    EXPECT_LT(small[0].bytes, plain[0].bytes);
    expectSame(readPayload(folder / ("small/" + small[0].path)).payload, payload);
    // what would shrink a thousandfold stays as it is, so that readers can bound what they allocate
    c.outgoing = OutgoingSet::elevations(4096);
    c.isotropic = true;
    c.values.assign(4096 * 3 * 16, 0.0);
    const auto zero = exportTo(folder / "zero", pack(c, {}), {"ktx2"}, {.zstd = true});
    EXPECT_GT(zero[0].bytes, 4096U * 8);
    EXPECT_NO_THROW(readPayload(folder / ("zero/" + zero[0].path)));
}

TEST(Containers, RefuseNumbersThatTheyCannotHold) {
    const Folder folder;
    for (const Number number : {Number::unorm8, Number::unorm16}) {
        const Payload payload = samplePayloads(number)[0].payload;
        for (const char* name : {"exr", "exr-parts"}) {
            try {
                exportTo(folder / "out", payload, {name});
                ADD_FAILURE() << name;
            } catch (const UsageError& error) {
                EXPECT_NE(std::string(error.what()).find("ktx2"), std::string::npos);
            }
        }
    }
    const Payload payload = samplePayloads(Number::float16)[0].payload;
    for (const char* name : {"", "a/b", "..", ".hidden"}) {
        EXPECT_THROW(exportTo(folder / "out", payload, {"bin"}, {}, name), UsageError) << name;
    }
    EXPECT_FALSE(std::filesystem::exists(folder / "out")) << "nothing is left behind";
}

TEST(Containers, AStripTooHighForReadersIsRefused) {
    const Payload payload = pack(
        samples::asymmetric("hsh", 3, OutgoingSet::parabolic(4, 8192), Channels::rgb(), 1), {});
    const Folder folder;
    EXPECT_THROW(exportTo(folder / "out", payload, {"exr"}), UsageError);
    EXPECT_NO_THROW(exportTo(folder / "out", payload, {"exr-parts"}));
}

TEST(Containers, ExistingFilesStayWithoutForce) {
    const Payload payload = samplePayloads(Number::float16)[0].payload;
    const Folder folder;
    samples::put(folder / "sample_test.json", "mine");
    FileSet files(folder.path(), false);
    const Container* bin = &findContainer("bin");
    try {
        writeContainers(payload, std::span(&bin, 1), "sample", {}, files);
        ADD_FAILURE() << "written";
    } catch (const OutputError& error) {
        EXPECT_NE(std::string(error.what()).find("sample_test.json"), std::string::npos);
        EXPECT_NE(std::string(error.what()).find("FileSet::force"), std::string::npos);
    }
    EXPECT_EQ(samples::contentOf(folder / "sample_test.json"), "mine");
    EXPECT_FALSE(std::filesystem::exists(folder / "sample.hsh.json"));
}

// FIPS 180-4 and RFC 4648 print these.
TEST(Checksum, MatchesThePublishedValues) {
    EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    for (const auto& [text, coded] :
         {std::pair{"f", "Zg=="}, {"fo", "Zm8="}, {"foo", "Zm9v"}, {"foobar", "Zm9vYmFy"}}) {
        const std::span octets(reinterpret_cast<const std::byte*>(text), std::strlen(text));
        EXPECT_EQ(base64(octets), coded);
        EXPECT_TRUE(std::ranges::equal(fromBase64(coded, octets.size()), octets));
        EXPECT_TRUE(fromBase64(coded, octets.size() + 1).empty());
    }
    EXPECT_TRUE(fromBase64("Zm9*", 3).empty());
}

}  // namespace
}  // namespace hshfit::gpu
