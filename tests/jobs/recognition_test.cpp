// Formats of files, by their content.

#include "temporary_folder.h"

#include <brdfs/catalog.h>
#include <brdfs/measured/gridded/utia.h>
#include <hshfit/coefficient_files/coefficient_file.h>
#include <hshfit/coefficient_files/light_file.h>
#include <hshfit/files/json_format.h>
#include <hshfit/gpu/containers/containers.h>
#include <hshfit/light/catalog.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit {
namespace {

/// Beginnings of files that other formats have, or that once were taken for theirs. Files of MERL
/// slices and of UTIA may begin with any number.
std::vector<std::string> beginnings() {
    std::vector<std::string> all{"\n{",           " {",    "{\"",   "{\n\"", "{ }",
                                 "P5\n1",         "P6 2",  "PF\n3", "Pf\n4", "#?=\n",
                                 "#?RADIAN",      "#ALTA", "ply\n", "glTF",  "DDS ",
                                 "\xff\xd8\xff=", "II*",   "<?xml", "ISO"};
    all.push_back(std::string("BMZ>\0\0\0\0\0\0", 10));
    for (int first = 0; first < 256; ++first) all.emplace_back(1, static_cast<char>(first));
    return all;
}

/// `count` numbers of 0.25 with other bytes at the beginning.
template <class Number>
std::string table(std::size_t count, const std::string& beginning) {
    const std::vector<Number> numbers(count, Number{0.25});
    std::string bytes(reinterpret_cast<const char*>(numbers.data()), count * sizeof(Number));
    std::copy(beginning.begin(), beginning.end(), bytes.begin());
    return bytes;
}

std::string formatOf(const std::string& path) {
    for (const auto& [name, value] : brdfs::open(path)->facts())
        if (name == "format") return std::get<std::string>(value);
    return {};
}

void expectTable(const std::string& path, const std::string& bytes, const std::string& format) {
    std::ofstream(path, std::ios::binary) << bytes;
    const std::string start = ::testing::PrintToString(bytes.substr(0, 10));
    EXPECT_FALSE(looksLikeLight(path)) << start;
    EXPECT_FALSE(isLightFile(path)) << start;
    EXPECT_FALSE(looksLikeCoefficients(path)) << start;
    EXPECT_FALSE(gpu::looksLikePayload(path)) << start;
    try {
        EXPECT_EQ(formatOf(path), format) << start;
    } catch (const std::exception& error) {
        ADD_FAILURE() << start << ": " << error.what();
    }
}

TEST(Recognition, TablesMayBeginWithAnyNumber) {
    const test::TemporaryFolder folder;
    for (const std::string& beginning : beginnings()) {
        expectTable(folder / "t.slice", table<float>(90 * 90 * 3, beginning), "merl-slice");
        expectTable(folder / "t", table<float>(90 * 90 * 3, beginning), "merl-slice");
    }
    for (const char* beginning : {"{", "\n{", "{\"", "P5\n1", "#?=\n", "\xff\xd8\xff="})
        expectTable(folder / "t.bin",
                    table<double>(brdfs::UtiaBrdf::fileBytes / sizeof(double), beginning), "utia");
}

TEST(Recognition, JsonNeedsNoExtension) {
    const test::TemporaryFolder folder;
    for (const char* text : {R"({"format":"hshfit-preset","version":1,"spec":"lambert:kd=0.5"})",
                             "\r\n\t {\r\n\t \"format\": \"hshfit-preset\",\n\"version\": 1, "
                             "\"spec\": \"lambert\"}\n"}) {
        std::ofstream(folder / "preset", std::ios::binary) << text;
        EXPECT_NO_THROW(brdfs::open(folder / "preset")) << text;
    }
    // The ends of texts that break off do not contradict.
    for (const std::string_view text : {"{", " {\n", "{}", "{\"a", "{ \"a\":1}"})
        EXPECT_TRUE(beginsAsJson(text)) << text;
    for (const std::string_view text : {"", " ", "[1]", "x{", "{a", "{\"a\x01", "{\x80"})
        EXPECT_FALSE(beginsAsJson(text)) << text;
}

}  // namespace
}  // namespace hshfit
