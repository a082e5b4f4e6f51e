// Files that state sizes whose products wrap round in 64 bits, or that are far beyond the file:
// each is refused before memory is reached by them.

#include <gpu/containers/container_samples.h>
#include <temporary_folder.h>

#include <hshfit/checked_product.h>
#include <hshfit/error.h>
#include <hshfit/files/tensor_file.h>
#include <hshfit/gpu/containers/ktx2_image.h>
#include <hshfit/material_maps/level_file.h>
#include <hshfit/material_maps/material_map.h>
#include <hshfit/representation/stored_array.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <functional>
#include <limits>
#include <vector>

namespace hshfit {
namespace {

constexpr std::uint64_t most = std::numeric_limits<std::uint64_t>::max();

std::uint64_t power(int exponent) {
    return std::uint64_t{1} << exponent;
}

void put(const std::string& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
}

/// The one line with which `read` refuses; empty if it reads.
template <class Refusal = InputError>
std::string refusal(const std::function<void()>& read) {
    try {
        read();
    } catch (const Refusal& error) {
        EXPECT_EQ(std::strchr(error.what(), '\n'), nullptr) << error.what();
        return error.what();
    }
    return {};
}

TEST(CheckedProduct, IsNothingBeyond64Bits) {
    EXPECT_EQ(checkedProduct({}), 1U);
    EXPECT_EQ(checkedProduct({3, 5, 7}), 105U);
    EXPECT_EQ(checkedProduct({power(32), power(31), 0}), 0U);
    EXPECT_EQ(checkedProduct({power(32), power(32) - 1}), most - power(32) + 1);
    EXPECT_EQ(checkedProduct({most, 1}), most);
    EXPECT_EQ(checkedProduct({power(32), power(32)}), std::nullopt);
    EXPECT_EQ(checkedProduct({power(20), power(20), power(20), 16}), std::nullopt);
    EXPECT_EQ(checkedProduct({power(63), 2}), std::nullopt);
    EXPECT_EQ(checkedProduct({most, most, 0}), std::nullopt);
}

struct Stack {
    std::uint64_t width, height, layers;
};
/// Texels of 16 bytes, all but the last two with a product that is 0 in 64 bits.
const Stack stacks[] = {{power(20), power(20), power(20)},
                        {power(30), power(30), 1},
                        {power(31), power(29), 1},
                        {power(31), power(31), power(31)},
                        {1, 1, power(60)},
                        {power(63), 2, 1},
                        {power(32) - 1, power(32) - 1, power(32) - 1},
                        {power(20), power(20), power(18)}};

TEST(StatedSizes, LevelsBeyond64BitsAreRefused) {
    const test::TemporaryFolder folder;
    const std::string path = folder / "t.ktx2";
    for (const Stack& s : stacks) {
        SCOPED_TRACE(fmt::format("{} x {} x {}", s.width, s.height, s.layers));
        for (const std::uint64_t stated : {std::uint64_t{0}, std::uint64_t{16}, power(62), most}) {
            put(path, gpu::ktx2Head({.number = gpu::Number::float32,
                                     .width = s.width,
                                     .height = s.height,
                                     .layers = s.layers,
                                     .levels = {{.stored = stated, .uncompressed = stated}}}));
            EXPECT_NE(refusal([&] {
                          const LevelTexture texture(path, {{s.width, s.height}}, s.layers,
                                                     gpu::Number::float32, "t.json");
                          texture.numbers(0, s.width - 1, s.height - 1);
                      }),
                      "");
        }
    }
}

TEST(StatedSizes, LevelsThatAreNotHalvesAreRefused) {
    const test::TemporaryFolder folder;
    const std::string path = folder / "t.ktx2";
    const auto open = [&](const std::vector<LevelSize>& levels) {
        std::vector<std::vector<std::byte>> bytes;
        for (const LevelSize& level : levels) bytes.emplace_back(level.width * level.height * 16);
        put(path, gpu::ktx2File({.number = gpu::Number::float32,
                                 .width = levels[0].width,
                                 .height = levels[0].height,
                                 .layers = 1},
                                bytes));
        return refusal([&] { LevelTexture(path, levels, 1, gpu::Number::float32, "t.json"); });
    };
    EXPECT_EQ(open({{8, 8}, {4, 4}, {2, 2}, {1, 1}}), "");
    EXPECT_EQ(open({{6, 4}, {3, 2}, {1, 1}}), "");
    EXPECT_EQ(open({{5, 1}, {2, 1}}), "");
    for (const std::vector<LevelSize>& levels : {std::vector<LevelSize>{{8, 8}, {1, 1}},
                                                 {{8, 8}, {8, 8}},
                                                 {{8, 8}, {4, 2}},
                                                 {{8, 8}, {4, 4}, {4, 4}},
                                                 {{3, 3}, {2, 2}},
                                                 {{1, 1}, {1, 1}}})
        EXPECT_NE(open(levels).find("is not half of the one before"), std::string::npos);
}

TEST(StatedSizes, MapsBeyond64BitsAreRefused) {
    const test::TemporaryFolder folder;
    const std::string json = folder / "m.json";
    const MapSidecar sidecar{
        .form = "outgoing",
        .texture = "m.ktx2",
        .basis = "hsh",
        .order = 1,
        .channels = Channels::grey(),
        .layout = {.outgoing = OutgoingSet::parabolic(1024, 1024), .slots = {0}, .channels = 1},
        .number = gpu::Number::float32,
        .levels = {{power(20), power(20)}}};
    ASSERT_EQ(sidecar.layers(), power(20));
    put(json, toText(sidecar));
    put(folder / "m.ktx2", gpu::ktx2Head({.number = gpu::Number::float32,
                                          .width = power(20),
                                          .height = power(20),
                                          .layers = power(20),
                                          .levels = {{0, 0}}}));
    EXPECT_NE(refusal([&] {
                  MaterialMap(json).coefficients(0, power(19), power(19));
              }).find("1048576 x 1048576 texels in 1048576 layers are more than a file holds"),
              std::string::npos);
}

TEST(StatedSizes, NoLevelsBeyondAFileAreWritten) {
    const test::TemporaryFolder folder;
    put(folder / "t.ktx2", "");
    for (const Stack& s : stacks) {
        if (checkedProduct({s.width, s.height, s.layers, 16})) continue;
        EXPECT_NE(
            refusal<OutputError>([&] {
                LevelFile(folder / "t.ktx2", gpu::Number::float32, s.layers, {{s.width, s.height}});
            }),
            "");
    }
}

/// A tensor file of one field, `values` doubles.
std::string tensorOf(const std::vector<std::uint64_t>& shape, std::size_t values) {
    std::string bytes(TensorFile::magic);
    const auto add = [&](auto value) {
        bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    add(std::uint8_t{1}), add(std::uint8_t{0}), add(std::uint32_t{1});
    add(std::uint16_t{1}), bytes += 'f';
    add(static_cast<std::uint16_t>(shape.size())), add(std::uint8_t{11});
    add(std::uint64_t{bytes.size() + 8 + 8 * shape.size()});
    for (const std::uint64_t size : shape) add(size);
    return bytes + std::string(8 * values, '\0');
}

TEST(StatedSizes, TensorsBeyond64BitsAreRefused) {
    const auto refused = [](const std::vector<std::uint64_t>& shape) {
        const std::string bytes = tensorOf(shape, 4);
        const std::span octets(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
        return refusal([&] { TensorFile(octets, "t").raw(TensorFile(octets, "t").field("f")); });
    };
    EXPECT_EQ(refused({4}), "");
    EXPECT_EQ(refused({2, 2, 1}), "");
    for (const std::vector<std::uint64_t>& shape :
         {std::vector<std::uint64_t>{power(20), power(20), power(20)},
          {power(32) - 1, power(32) - 1},
          {power(32), power(32)},
          {power(61)},
          {power(61), 1},
          {power(60), 2},
          {power(63), 2},
          {most},
          {5}})
        EXPECT_NE(refused(shape).find("do not fit"), std::string::npos);
}

TEST(StatedSizes, ArraysBeyond64BitsAreRefused) {
    const std::vector<std::byte> bytes(64);
    for (const bool masked : {false, true})
        for (const std::vector<std::size_t>& shape :
             {std::vector<std::size_t>{power(28), power(28), power(8)},
              {power(20), power(20), power(24)},
              {power(32), power(32)},
              {power(63), 2},
              {most},
              {most, most, 0}}) {
            StoredArray array{.shape = shape, .values = {}};
            EXPECT_NE(refusal([&] {
                          unpackInto(array, bytes, masked, "a");
                      }).find("64 bytes cannot hold"),
                      std::string::npos);
        }
}

/// Places of the head that may hold a size: every fourth byte of the first ones, and the numbers of
/// an EXR file, which lie anywhere.
std::vector<std::size_t> placesOf(const std::string& bytes) {
    std::vector<std::size_t> places;
    for (std::size_t at = 4; at + 8 < std::min<std::size_t>(bytes.size(), 160); at += 4)
        places.push_back(at);
    for (const char* name : {"dataWindow", "chunkCount", "channels"}) {
        const std::size_t found = bytes.find(name);
        if (found == std::string::npos || bytes.size() - found < 64) continue;
        const std::size_t size = bytes.find('\0', found + std::strlen(name) + 1) + 1;
        for (std::size_t at = size; at < size + 20; at += 4) places.push_back(at);
    }
    return places;
}

// The texels that come out, if any, are those that went in: their SHA-256 is checked.
TEST(StatedSizes, HugeNumbersInTheHeadOfAnyContainerAreRefusedOrHarmless) {
    const test::TemporaryFolder folder;
    const gpu::Payload payload = gpu::pack(
        samples::asymmetric("hsh", 5, OutgoingSet::direction(0.6, 1), Channels::grey(), 1), {});
    std::vector<std::string> numbers;
    for (const std::uint64_t wide : {power(20), power(31) - 1, power(31), power(32) - 1})
        numbers.emplace_back(reinterpret_cast<const char*>(&wide), 4);
    for (const std::uint64_t wide : {power(40), power(60), power(63), most})
        numbers.emplace_back(reinterpret_cast<const char*>(&wide), 8);
    for (const gpu::Container& container : gpu::containers::catalog()) {
        const auto files =
            test::exportTo(folder.path().string(), payload, {std::string(container.name)});
        const std::string path = folder / files[0].path;
        const std::string good = samples::contentOf(path);
        std::size_t refused = 0;
        for (const std::size_t at : placesOf(good))
            for (const std::string& number : numbers) {
                std::string bad = good;
                bad.replace(at, number.size(), number);
                put(path, bad);
                const std::string message = refusal([&] {
                    EXPECT_EQ(gpu::readPayload(path).payload.coefficients.bytes,
                              payload.coefficients.bytes);
                });
                refused += message.empty() ? 0 : 1;
            }
        EXPECT_GT(refused, 0U) << container.name;
    }
}

}  // namespace
}  // namespace hshfit
