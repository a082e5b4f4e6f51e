#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>
#include <hshfit/files/exr_picture.h>
#include <hshfit/files/file_set.h>
#include <hshfit/files/made_from.h>
#include <hshfit/files/output_rule.h>
#include <hshfit/pictures/rgb_picture.h>

#include "lib/coefficient_files/coefficient_samples.h"

#include <gtest/gtest.h>
#include <png.h>

#include <nlohmann/json.hpp>

#include <set>
#include <vector>

using hshfit::addMadeFrom;
using hshfit::AtomicFile;
using hshfit::FileSet;
using hshfit::MadeFrom;
using hshfit::madeFromOf;
using hshfit::OutputError;
using hshfit::setOutputRule;
using hshfit::samples::contentOf;
using hshfit::samples::Folder;
using hshfit::samples::put;

namespace {

const MadeFrom made{.command = "project", .key = "abc", .files = {"one.json", "two.csv"}};

TEST(MadeFrom, IsTheLastMemberOfJsonHoweverItIsLaidOut) {
    const Folder folder;
    for (const char* text :
         {"{\"a\": {\"b\": [1, 2]}}", "{\n  \"a\": {\n    \"b\": [1, 2]\n  }\n}\n",
          "{\"a\":{\"b\":[1,2]}}\n", "{\n \"a\": {\"b\": [1, 2]} }  \n\n"}) {
        put(folder / "x.json", text);
        ASSERT_TRUE(addMadeFrom(folder / "x.json", made)) << text;
        const auto json = nlohmann::ordered_json::parse(contentOf(folder / "x.json"));
        EXPECT_EQ(json["a"]["b"][1], 2);
        EXPECT_EQ((--json.end()).key(), "made_from");
        const auto read = madeFromOf(folder / "x.json");
        ASSERT_TRUE(read) << text;
        EXPECT_EQ(read->key, "abc");
        EXPECT_EQ(read->files, made.files);
    }
}

TEST(MadeFrom, LeavesContentOfOtherKindsAsItIs) {
    const Folder folder;
    for (const char* text :
         {"", "[1, 2]\n", "{}", "{", "v 1 2 3\n", "\x89PNG\r\n\x1a\n", "\x76\x2f\x31\x01"}) {
        put(folder / "x.json", text);
        EXPECT_FALSE(addMadeFrom(folder / "x.json", made)) << text;
        EXPECT_EQ(contentOf(folder / "x.json"), text);
        EXPECT_FALSE(madeFromOf(folder / "x.json"));
    }
    EXPECT_FALSE(madeFromOf(folder / "absent.json"));
}

/// libpng checks the checksum of every chunk.
TEST(MadeFrom, IsATextOfPngThatLibpngReads) {
    const Folder folder;
    const std::vector<unsigned char> rgba(4 * 3 * 2, 77);
    put(folder / "x.png", hshfit::pngOf(rgba, 3, 2));
    ASSERT_TRUE(addMadeFrom(folder / "x.png", made));
    ASSERT_TRUE(madeFromOf(folder / "x.png"));
    EXPECT_EQ(madeFromOf(folder / "x.png")->files, made.files);
    std::FILE* file = std::fopen((folder / "x.png").c_str(), "rb");
    png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    ASSERT_EQ(setjmp(png_jmpbuf(png)), 0) << "libpng refuses the file";
    png_set_crc_action(png, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
    png_init_io(png, file);
    png_read_png(png, info, PNG_TRANSFORM_IDENTITY, nullptr);
    png_textp texts = nullptr;
    int count = 0;
    png_get_text(png, info, &texts, &count);
    ASSERT_EQ(count, 1);
    EXPECT_STREQ(texts[0].key, "made_from");
    EXPECT_EQ(nlohmann::json::parse(texts[0].text)["key"], "abc");
    EXPECT_EQ(png_get_rows(png, info)[1][0], 77);
    png_destroy_read_struct(&png, &info, nullptr);
    std::fclose(file);
}

/// OpenEXR reads back the pixels by the moved table of chunks; sizes around its blocks of 16 lines.
TEST(MadeFrom, IsAnAttributeOfExrThatLeavesThePixels) {
    const Folder folder;
    for (const std::size_t height : {1u, 15u, 16u, 17u, 70u}) {
        hshfit::ExrPicture picture{.width = 5, .height = height, .channels = {"B", "G", "R"}};
        for (std::size_t i = 0; i < 15 * height; ++i)
            picture.values.push_back(0.5F * static_cast<float>(i));
        AtomicFile file(folder / "x.exr");
        writeExrPicture(picture, hshfit::ExrPixels::single, file);
        file.commit();
        ASSERT_TRUE(addMadeFrom(folder / "x.exr", made));
        const auto read = hshfit::readExrPicture(contentOf(folder / "x.exr"), "x.exr", 1 << 20);
        EXPECT_EQ(read.values, picture.values) << height;
        EXPECT_EQ(read.attributes.count("hshfit:made_from"), 1u);
        ASSERT_TRUE(madeFromOf(folder / "x.exr"));
        EXPECT_EQ(madeFromOf(folder / "x.exr")->key, "abc");
        EXPECT_FALSE(addMadeFrom(folder / "x.exr", made)) << "twice";
    }
}

/// A rule of the process for the time of a test.
class Rule : public testing::Test {
protected:
    static void state(const std::string& key, bool replace = false) {
        setOutputRule({.replace = replace, .command = "test", .facts = "f", .key = key});
    }
    void TearDown() override { setOutputRule({}); }
    const Folder folder_;
};

TEST_F(Rule, EqualBytesAreKeptAndOthersRefused) {
    state("");
    hshfit::writeFile(folder_ / "a.csv", "1");
    EXPECT_TRUE(hshfit::takeKeptFiles().empty());
    hshfit::writeFile(folder_ / "a.csv", "1");
    EXPECT_EQ(hshfit::takeKeptFiles().size(), 1u);
    EXPECT_THROW(hshfit::writeFile(folder_ / "a.csv", "2"), OutputError);
    EXPECT_EQ(contentOf(folder_ / "a.csv"), "1");
    state("", true);
    hshfit::writeFile(folder_ / "a.csv", "2");
    EXPECT_EQ(contentOf(folder_ / "a.csv"), "2");
}

TEST_F(Rule, OfOneKeyOnlyWhatNobodyChangedIsReplaced) {
    state("k");
    const std::string path = folder_ / "a.json";
    hshfit::writeFile(path, "{\"seconds\": 1}\n");
    hshfit::writeFile(path, "{\"seconds\": 2}\n");
    const std::string written = contentOf(path);
    EXPECT_NE(written.find("\"seconds\": 2"), std::string::npos);
    std::string edited = written;
    edited.replace(edited.find("2"), 1, "3");
    put(path, edited);
    EXPECT_THROW(hshfit::writeFile(path, "{\"seconds\": 4}\n"), OutputError);
    EXPECT_EQ(contentOf(path), edited);
    state("other");
    put(path, written);
    EXPECT_THROW(hshfit::writeFile(path, "{\"seconds\": 4}\n"), OutputError);
}

TEST_F(Rule, ASetIsRefusedAsAWhole) {
    state("");
    put(folder_ / "b", "mine");
    FileSet files(folder_.path(), true);
    files.write("a", "1");
    files.write("b", "2");
    EXPECT_THROW(files.commit(), OutputError);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "a"));
    EXPECT_EQ(contentOf(folder_ / "b"), "mine");
}

TEST_F(Rule, JsonOfASetNamesTheOthersAndPicturesStayAsTheyAre) {
    state("k");
    const std::string png = hshfit::pngOf(std::vector<unsigned char>(4, 1), 1, 1);
    FileSet files(folder_.path(), true);
    files.write("a.json", "{\"b\": 1}\n");
    files.write("b.png", png);
    files.commit();
    EXPECT_EQ(contentOf(folder_ / "b.png"), png);
    const auto read = madeFromOf(folder_ / "a.json");
    ASSERT_TRUE(read);
    EXPECT_EQ(read->files, (std::vector<std::string>{"a.json", "b.png"}));
}

TEST_F(Rule, ASetStatesTheSumsOfFilesThatStateNothing) {
    state("k");
    FileSet files(folder_.path(), true);
    files.write("a.json", "{\"b\": 1}\n");
    files.write("b.csv", "abc");
    files.writePart("part.json", "{\"c\": 1}\n");
    files.commit();
    EXPECT_EQ(contentOf(folder_ / "part.json"), "{\"c\": 1}\n");
    const auto read = madeFromOf(folder_ / "a.json");
    ASSERT_TRUE(read);
    EXPECT_EQ(read->files, (std::vector<std::string>{"a.json", "b.csv", "part.json"}));
    ASSERT_EQ(read->sums.size(), 3u);
    EXPECT_EQ(read->sums[0], "");
    // FIPS 180-2, appendix B.1
    EXPECT_EQ(read->sums[1], "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST_F(Rule, SumsOfLargeFilesSeeTheirSizeAndBothEnds) {
    std::string bytes(std::size_t{17} << 20, 'a');
    std::set<std::string> sums;
    const auto sum = [&] {
        put(folder_ / "large", bytes);
        return hshfit::sumOfPart(folder_ / "large");
    };
    sums.insert(sum());
    EXPECT_EQ(*sums.begin(), sum());
    bytes.front() = 'b';
    sums.insert(sum());
    bytes.back() = 'b';
    sums.insert(sum());
    bytes += 'b';
    sums.insert(sum());
    EXPECT_EQ(sums.size(), 4u);
    EXPECT_EQ(hshfit::sumOfPart(folder_ / "none"), "absent");
}

TEST_F(Rule, ASetRemovesWhatItReplacesButNothingElse) {
    state("k", true);
    {
        FileSet files(folder_.path(), true);
        files.write("a.json", "{\"b\": 1}\n");
        files.write("b.csv", "1");
        files.commit();
    }
    put(folder_ / "mine.csv", "2");
    {
        FileSet kept(folder_.path(), true);
        kept.write("a.json", "{\"b\": 2}\n");
        kept.write("b.csv", "1");
        kept.removeOthers();
        kept.commit();
    }
    EXPECT_EQ(contentOf(folder_ / "b.csv"), "1");
    FileSet files(folder_.path(), true);
    files.write("a.json", "{\"b\": 3}\n");
    files.removeOthers();
    files.commit();
    EXPECT_FALSE(std::filesystem::exists(folder_ / "b.csv"));
    EXPECT_EQ(contentOf(folder_ / "mine.csv"), "2");
}

TEST_F(Rule, AKeyOfAThreadStandsOverThatOfTheProcess) {
    state("process");
    {
        const hshfit::OutputKey key("item");
        hshfit::writeFile(folder_ / "a.json", "{\"b\": 1}\n");
    }
    hshfit::writeFile(folder_ / "b.json", "{\"b\": 1}\n");
    EXPECT_EQ(madeFromOf(folder_ / "a.json")->key, "item");
    EXPECT_EQ(madeFromOf(folder_ / "b.json")->key, "process");
}

TEST_F(Rule, ALibraryReplacesAndStatesNothing) {
    setOutputRule({});
    put(folder_ / "a.json", "mine");
    hshfit::writeFile(folder_ / "a.json", "{\"b\": 1}\n");
    EXPECT_EQ(contentOf(folder_ / "a.json"), "{\"b\": 1}\n");
}

}  // namespace
