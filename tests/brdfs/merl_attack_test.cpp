// Damaged MERL files end in one clear line.

#include <brdfs/catalog.h>
#include <brdfs/measured/merl.h>

#include <brdfs/measured_files.h>
#include <gtest/gtest.h>

#include <random>

namespace hshfit {
namespace {

using brdfs::MerlBrdf;
using test::expectInputError;
using test::merlFile;
using test::TemporaryFile;

std::string header(std::int32_t h, std::int32_t d, std::int32_t p) {
    const std::int32_t dimensions[3] = {h, d, p};
    return {reinterpret_cast<const char*>(dimensions), sizeof dimensions};
}

TEST(MerlAttack, everyLengthButTheRightOneIsRefused) {
    const TemporaryFile file(header(90, 90, 180));
    // Within each number of the header, after it, within and after each plane, and one too many.
    for (const std::uintmax_t size : {1, 4, 7, 8, 11, 12, 13, 20, 12 + 8 * 1458000,
                                      12 + 8 * 2 * 1458000, 34992011, 34992013, 69984012}) {
        file.write(header(90, 90, 180));
        file.resize(size);
        expectInputError([&] { MerlBrdf{file.path()}; },
                         {file.path(), std::to_string(size) + " bytes"});
    }
    file.resize(34992012);
    EXPECT_NO_THROW(MerlBrdf{file.path()});
    file.write(header(90, 90, 360));
    file.resize(34992012);
    expectInputError([&] { MerlBrdf{file.path()}; }, {"expected 69984012"});
}

TEST(MerlAttack, everyDimensionIsChecked) {
    const std::int32_t bad[] = {0, -1, 1, 89, 91, INT32_MIN, INT32_MAX, 180, 0x01000000};
    for (const std::int32_t value : bad) {
        const TemporaryFile file;
        for (int i = 0; i < 3; ++i) {
            if (i == 2 && value == 180) continue;
            file.write(header(i == 0 ? value : 90, i == 1 ? value : 90, i == 2 ? value : 180));
            file.resize(34992012);
            expectInputError([&] { MerlBrdf{file.path()}; },
                             {file.path(), "dimension " + std::to_string(i),
                              "is " + std::to_string(value) + ",", "expected"});
        }
    }
    // The right product is not enough.
    const TemporaryFile file(header(180, 90, 90));
    file.resize(34992012);
    expectInputError([&] { MerlBrdf{file.path()}; }, {"dimension 0", "is 180"});
}

TEST(MerlAttack, pathsThatAreNoFilesAreRefused) {
    const TemporaryFile empty;
    expectInputError([&] { MerlBrdf{empty.path()}; }, {empty.path(), "empty"});
    expectInputError([] { MerlBrdf{"/tmp"}; }, {"/tmp: is a directory"});
    expectInputError([] { MerlBrdf{"/no/such.binary"}; }, {"/no/such.binary", "No such file"});
}

TEST(MerlAttack, theCatalogPassesDamagedFilesToTheirReader) {
    const TemporaryFile file(header(90, 90, 180), ".binary");
    file.resize(1000);
    expectInputError([&] { brdfs::open(file.path()); }, {"1000 bytes, expected 34992012"});
    file.write(header(90, 91, 180));
    file.resize(34992012);
    expectInputError([&] { brdfs::open(file.path()); }, {"theta_d", "is 91, expected 90"});
    file.write("junk");
    expectInputError([&] { brdfs::open(file.path()); }, {file.path(), "12-byte header"});
    file.write(header(90, 90, 180));
    file.resize(34992012);
    EXPECT_THROW(brdfs::open(file.path() + ":interpolation=cubic"), UsageError);
    EXPECT_THROW(brdfs::open(file.path() + ":filter=linear"), UsageError);
    const std::string nearest = file.path() + ":interpolation=nearest";
    EXPECT_EQ(brdfs::open(nearest)->name(), nearest);
    EXPECT_EQ(brdfs::open(file.path() + ":interpolation=linear")->name(), file.path());
}

TEST(MerlAttack, aFileThatShrinksIsReportedAndHarmless) {
    const TemporaryFile file(merlFile([](int, int, int, int) { return 5.0; }));
    const MerlBrdf brdf(file.path());
    std::mt19937 random(1);
    const Direction wo = test::randomDirection(random);
    EXPECT_GT(evaluate(brdf, {0, 0, 1}, wo)[0], 0);
    EXPECT_NO_THROW(brdf.checkIntact());
    file.resize(4096);
    for (int i = 0; i < 2000; ++i) evaluate(brdf, test::randomDirection(random), wo);
    expectInputError([&] { brdf.checkIntact(); }, {file.path(), "shrank while it was being read"});
    file.resize(0);
    for (int i = 0; i < 2000; ++i) evaluate(brdf, test::randomDirection(random), wo);
    EXPECT_NO_THROW(brdf.facts());
    expectInputError([&] { brdf.checkIntact(); }, {"shrank while it was being read"});
}

}  // namespace
}  // namespace hshfit
