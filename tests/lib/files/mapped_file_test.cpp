#include <hshfit/error.h>
#include <hshfit/files/mapped_file.h>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <temporary_file.h>

#include <algorithm>
#include <fstream>
#include <memory>
#include <numeric>
#include <string>
#include <thread>
#include <vector>

namespace hshfit {
namespace {

using test::expectInputError;
using test::TemporaryFile;

const std::size_t page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));

TEST(MappedFile, holdsTheBytesOfTheFile) {
    const TemporaryFile file("tensor");
    const MappedFile map(file.path());
    EXPECT_EQ(std::string(map.bytes().begin(), map.bytes().end()), "tensor");
    EXPECT_NO_THROW(map.checkIntact());
}

/// Kilobytes of files that are in the memory of this process.
long residentKilobytes() {
    std::ifstream status("/proc/self/status");
    std::string word;
    long value = -1;
    while (status >> word)
        if (word == "RssFile:") status >> value;
    return value;
}

TEST(MappedFile, pagesThatWereLetGoAreReadAgain) {
    const std::string text(std::size_t{1} << 24, 'x');
    const TemporaryFile file(text);
    const MappedFile map(file.path());
    EXPECT_TRUE(std::equal(text.begin(), text.end(), map.data()));
    const long before = residentKilobytes();
    map.releasePages();
    EXPECT_LT(residentKilobytes(), before - 15000);
    EXPECT_TRUE(std::equal(text.begin(), text.end(), map.data()));
    EXPECT_NO_THROW(map.checkIntact());
}

TEST(MappedFile, refusesWhatIsNotAFileWithContent) {
    const TemporaryFile empty("");
    const std::string fifo = empty.path() + ".fifo";
    ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
    expectInputError([&] { MappedFile(empty.path()); }, {empty.path(), "is empty"});
    expectInputError([&] { MappedFile{fifo}; }, {fifo, "not a regular file"});
    expectInputError([] { MappedFile("/"); }, {"/: is a directory"});
    expectInputError([] { MappedFile("/dev/null"); }, {"/dev/null: is not a regular file"});
    expectInputError([&] { MappedFile(empty.path() + ".absent"); }, {"No such file"});
    unlink(fifo.c_str());
}

TEST(MappedFile, refusesAnUnreadableFile) {
    if (geteuid() == 0) GTEST_SKIP() << "root reads every file";
    const TemporaryFile file("x");
    chmod(file.path().c_str(), 0);
    expectInputError([&] { MappedFile(file.path()); }, {file.path(), "Permission denied"});
}

TEST(MappedFile, lostPagesReadAsZerosAndAreReported) {
    const TemporaryFile file(std::string(5 * page, 'x'));
    const TemporaryFile other(std::string(2 * page, 'y'));
    const MappedFile map(file.path()), untouched(other.path());
    EXPECT_EQ(map.data()[4 * page], 'x');
    file.resize(page);
    const volatile unsigned char* data = map.data();
    EXPECT_EQ(data[0], 'x');
    EXPECT_EQ(data[4 * page], 0);
    EXPECT_EQ(data[2 * page + 17], 0);
    expectInputError([&] { map.checkIntact(); }, {file.path(), "shrank while it was being read"});
    // Growing again does not bring the lost values back.
    file.resize(5 * page);
    expectInputError([&] { map.checkIntact(); }, {"shrank while it was being read"});
    EXPECT_EQ(untouched.data()[page], 'y');
    EXPECT_NO_THROW(untouched.checkIntact());
}

TEST(MappedFile, shrinkingWithinThePageIsReported) {
    const TemporaryFile file(std::string(100, 'x'));
    const MappedFile map(file.path());
    file.resize(50);
    expectInputError([&] { map.checkIntact(); }, {"shrank while it was being read"});
}

TEST(MappedFile, rewritingIsReported) {
    const TemporaryFile file(std::string(100, 'x'));
    const MappedFile map(file.path());
    const timespec later[2] = {{0, UTIME_OMIT}, {1, 0}};
    ASSERT_EQ(utimensat(AT_FDCWD, file.path().c_str(), later, 0), 0);
    expectInputError([&] { map.checkIntact(); }, {"was written to while it was being read"});
}

TEST(MappedFile, manyThreadsMayLosePagesAtOnce) {
    const std::size_t pages = 400;
    const TemporaryFile file(std::string(pages * page, 'x'));
    const MappedFile map(file.path());
    file.resize(1);
    std::vector<std::size_t> sums(4, 1);
    std::vector<std::thread> threads;
    for (std::size_t& sum : sums) {
        threads.emplace_back([&map, &sum] {
            sum = 0;
            for (std::size_t i = 1; i < pages; ++i) sum += map.data()[i * page];
        });
    }
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(std::accumulate(sums.begin(), sums.end(), std::size_t{0}), 0u);
    EXPECT_THROW(map.checkIntact(), InputError);
}

TEST(MappedFile, thereIsALimitToOpenFiles) {
    const TemporaryFile file("x");
    std::vector<std::unique_ptr<MappedFile>> maps;
    for (int i = 0; i < MappedFile::maxOpen; ++i) {
        maps.push_back(std::make_unique<MappedFile>(file.path()));
    }
    expectInputError([&] { MappedFile(file.path()); }, {"256 measured files are open already"});
    maps.pop_back();
    EXPECT_NO_THROW(MappedFile(file.path()));
}

// A map that is not ours: the access has to end the process as if we were not there.
unsigned char loseForeignPage(const std::string& path) {
    const int descriptor = open(path.c_str(), O_RDWR | O_CLOEXEC);
    void* map = mmap(nullptr, page, PROT_READ, MAP_SHARED, descriptor, 0);
    if (ftruncate(descriptor, 0) != 0) return 0;
    return *static_cast<const volatile unsigned char*>(map);
}

TEST(MappedFileDeathTest, otherLostPagesStillEndTheProcess) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    const TemporaryFile ours("x"), foreign("x");
    EXPECT_DEATH(
        {
            const MappedFile map(ours.path());
            loseForeignPage(foreign.path());
        },
        "");
}

TEST(MappedFileDeathTest, otherLostPagesReachTheHandlerBefore) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    const TemporaryFile ours("x"), foreign("x");
    EXPECT_EXIT(
        {
            signal(SIGBUS, [](int) { _exit(42); });
            const MappedFile map(ours.path());
            loseForeignPage(foreign.path());
        },
        testing::ExitedWithCode(42), "");
}

}  // namespace
}  // namespace hshfit
