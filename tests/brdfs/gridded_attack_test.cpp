// Damaged UTIA, MIT and slice files end in one clear line.

#include <brdfs/catalog.h>
#include <brdfs/measured/gridded/mit.h>
#include <brdfs/measured/gridded/slice.h>
#include <brdfs/measured/gridded/utia.h>

#include <brdfs/gridded_files.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <random>

namespace hshfit {
namespace {

using test::expectInputError;
using test::TemporaryFile;

std::span<const unsigned char> bytesOf(const std::string& text) {
    return {reinterpret_cast<const unsigned char*>(text.data()), text.size()};
}

std::string contentOf(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

TEST(GriddedAttack, everyFieldOfTheMitHeaderIsChecked) {
    const std::string good =
        test::mitFile({3, 4, 5, 6}, [](int, int, int, int, int) { return 1.F; });
    EXPECT_NO_THROW(brdfs::MitBrdf(bytesOf(good), "input"));
    const std::pair<std::size_t, std::vector<std::int32_t>> fields[] = {
        {0, {0, -1, 2, 4, 4097, INT32_MIN, INT32_MAX}},
        {1, {0, -1, 3, 4097, INT32_MAX}},
        {2, {0, -1, 4, 4097, INT32_MAX}},
        {3, {0, -1, 5, 4097, INT32_MAX}},
        {6, {0, 2, -1}},
        {7, {1, -1}},
        {9, {2, -1}},
        {10, {0, 1, 4, -3, INT32_MAX}}};
    for (const auto& [field, values] : fields) {
        for (const std::int32_t value : values) {
            std::string bad = good;
            std::memcpy(bad.data() + 4 * field, &value, 4);
            const bool plausible = field < 4 && value > 0 && value <= 4096;
            expectInputError([&] { brdfs::MitBrdf(bytesOf(bad), "input"); },
                             plausible
                                 ? std::vector<std::string>{"input", "bytes, expected"}
                                 : std::vector<std::string>{"header[" + std::to_string(field) + "]",
                                                            "is " + std::to_string(value) + ","});
        }
    }
    // All four at their largest: 2^48 cells in every channel.
    std::string huge = good;
    for (std::size_t i = 0; i < 4; ++i) {
        const std::int32_t most = 4096;
        std::memcpy(huge.data() + 4 * i, &most, 4);
    }
    expectInputError([&] { brdfs::MitBrdf(bytesOf(huge), "input"); },
                     {"expected 3377699720527936"});
}

TEST(GriddedAttack, everyLengthOfAnMitFileButTheRightOneIsRefused) {
    const std::string good =
        test::mitFile({3, 4, 5, 6}, [](int, int, int, int, int) { return 1.F; });
    for (std::size_t size = 0; size < good.size(); size += size < 80 ? 1 : 97) {
        expectInputError([&] { brdfs::MitBrdf(bytesOf(good.substr(0, size)), "input"); },
                         {"input", std::to_string(size) + " bytes"});
    }
    expectInputError([&] { brdfs::MitBrdf(bytesOf(good + 'x'), "input"); }, {"expected"});
    const TemporaryFile file(good.substr(0, 400), ".dat");
    expectInputError([&] { brdfs::open(file.path()); },
                     {file.path(), "400 bytes, expected 4384 for 3 x 4 x 5 x 6"});
}

TEST(GriddedAttack, aMitFileThatShrinksIsReportedAndHarmless) {
    const TemporaryFile file(
        test::mitFile({20, 20, 20, 20}, [](int, int, int, int, int) { return 1.F; }), ".dat");
    const auto brdf = brdfs::open(file.path());
    file.resize(4096);
    std::mt19937 random(1);
    for (int i = 0; i < 500; ++i) {
        evaluate(*brdf, test::randomDirection(random), test::randomDirection(random));
    }
    dynamic_cast<const brdfs::MitBrdf&>(*brdf).census();
    expectInputError([&] { brdf->checkIntact(); }, {"shrank while it was being read"});
}

TEST(GriddedAttack, onlyTheSizeOfAUtiaTableIsRead) {
    for (const std::size_t size : {1, 8, 663552, 1990655, 1990657}) {
        expectInputError([&] { brdfs::UtiaBrdf(bytesOf(std::string(size, '\0')), "input", {}); },
                         {"input", std::to_string(size) + " bytes, expected 1990656"});
    }
    const TemporaryFile file(std::string(5000, 'x'), ".bin");
    expectInputError([&] { brdfs::open(file.path()); }, {file.path(), "5000 bytes"});
    file.write(std::string(1990656, '\0'));
    EXPECT_NO_THROW(brdfs::open(file.path()));
    EXPECT_THROW(brdfs::open(file.path() + ":beyond=never"), UsageError);
    EXPECT_THROW(brdfs::open(file.path() + ":scale=0"), UsageError);
}

TEST(GriddedAttack, onlyTheSizeOfAMerlSliceIsRead) {
    for (const std::size_t size : {1, 4, 97196, 97199, 97201, 97204}) {
        expectInputError([&] { brdfs::readMerlSlice(bytesOf(std::string(size, '\0')), "input"); },
                         {"input", std::to_string(size) + " bytes, expected 97200"});
    }
}

std::string picture(int width, int height, const test::ExrPlanes& planes) {
    const TemporaryFile file({}, ".exr");
    test::writeExr(file.path(), width, height, Imf::FLOAT, Imf::NO_COMPRESSION, planes);
    return contentOf(file.path());
}

double one(int, int) {
    return 1;
}

TEST(GriddedAttack, everyTruncationOfAPictureIsRefused) {
    const std::string good = picture(5, 4, {{"R", one}, {"G", one}, {"B", one}});
    EXPECT_NO_THROW(brdfs::readSlicePicture(bytesOf(good), "input"));
    for (std::size_t size = 0; size < good.size(); ++size) {
        expectInputError([&] { brdfs::readSlicePicture(bytesOf(good.substr(0, size)), "input"); },
                         {"input"});
    }
}

TEST(GriddedAttack, corruptedPicturesAreRefusedOrRead) {
    const std::string good = picture(5, 4, {{"R", one}, {"G", one}, {"B", one}});
    std::mt19937 random(3);
    int refused = 0;
    for (int i = 0; i < 5000; ++i) {
        std::string bad = good;
        for (int n = 0; n < 1 + i % 3; ++n)
            bad[random() % bad.size()] = static_cast<char>(random());
        try {
            const auto brdf = brdfs::readSlicePicture(bytesOf(bad), "input");
            for (const double f : evaluate(*brdf, {0.6, 0, 0.8}, {0, 0.6, 0.8})) EXPECT_GE(f, 0);
        } catch (const InputError& error) {
            ++refused;
            EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
        }
    }
    EXPECT_GT(refused, 1000);
}

TEST(GriddedAttack, picturesOfAnotherKindAreRefused) {
    const auto refuse = [](const std::string& bytes, const std::vector<std::string>& parts) {
        expectInputError([&] { brdfs::readSlicePicture(bytesOf(bytes), "input"); }, parts);
    };
    refuse(picture(3, 3, {{"depth", one}}), {"neither channels R, G, B nor Y"});
    refuse(picture(3, 3, {{"R", one}, {"G", one}}), {"neither channels R, G, B nor Y"});
    refuse(picture(3, 3, {{"-5nm", one}, {"nm", one}, {"5xnm", one}}), {"neither channels"});
    expectInputError(
        [] {
            brdfs::UtiaBrdf(bytesOf(picture(288, 288, {{"R", one}, {"G", one}})), "input", {});
        },
        {"no channel 'B'"});
    expectInputError(
        [] {
            brdfs::UtiaBrdf(bytesOf(picture(287, 288, {{"R", one}, {"G", one}, {"B", one}})),
                            "input", {});
        },
        {"287 x 288"});
}

}  // namespace
}  // namespace hshfit
