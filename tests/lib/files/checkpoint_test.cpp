#include <hshfit/error.h>
#include <hshfit/files/checkpoint.h>

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <temporary_file.h>
#include <temporary_folder.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <thread>

namespace hshfit {
namespace {

using test::expectInputError;

/// Bytes that tell their index and length.
std::vector<std::byte> contentOf(std::uint64_t index) {
    std::vector<std::byte> bytes(7 * index % 31);
    for (std::size_t k = 0; k < bytes.size(); ++k)
        bytes[k] = static_cast<std::byte>(37 * index + k);
    return bytes;
}

class CheckpointFile : public testing::Test {
protected:
    std::string read() const {
        std::ifstream in(path_, std::ios::binary);
        std::stringstream text;
        text << in.rdbuf();
        return text.str();
    }
    void write(const std::string& text) const {
        std::ofstream(path_, std::ios::binary | std::ios::trunc) << text;
    }
    bool stands() const { return std::filesystem::exists(path_); }

    test::TemporaryFolder folder_;
    std::string path_ = folder_ / "work";
};

TEST_F(CheckpointFile, HoldsBlocksOfAnEarlierRun) {
    {
        Checkpoint work(path_, "key");
        EXPECT_FALSE(work.block(3));
        for (const std::uint64_t index : {3, 0, 9, 31}) work.add(index, contentOf(index));
    }
    Checkpoint work(path_, "key");
    EXPECT_EQ(work.blocks(), 4u);
    for (const std::uint64_t index : {0, 3, 9, 31}) EXPECT_EQ(work.block(index), contentOf(index));
    EXPECT_FALSE(work.block(1));
    work.add(3, contentOf(4));
    EXPECT_EQ(work.block(3), contentOf(4));
    EXPECT_EQ(work.blocks(), 4u);
    work.remove();
    EXPECT_FALSE(stands());
}

TEST_F(CheckpointFile, WithoutABlockGoesAway) {
    { const Checkpoint work(path_, "key"); }
    EXPECT_FALSE(stands());
}

TEST_F(CheckpointFile, OfOtherInputsIsRefusedAndStays) {
    { Checkpoint(path_, "key").add(1, contentOf(1)); }
    const std::string before = read();
    expectInputError([&] { Checkpoint(path_, "another"); }, {path_, "other inputs", "remove it"});
    EXPECT_EQ(read(), before);
    write("a picture\n");
    expectInputError([&] { Checkpoint(path_, "key"); }, {path_, "is no file of finished work"});
    EXPECT_EQ(read(), "a picture\n");
    expectInputError([&] { Checkpoint("/dev/null", "key"); }, {"/dev/null", "no regular file"});
    EXPECT_THROW(Checkpoint(folder_ / "none/work", "key"), OutputError);
}

TEST_F(CheckpointFile, IsOpenInOneProcessAtATime) {
    Checkpoint work(path_, "key");
    work.add(1, contentOf(1));
    EXPECT_THROW(Checkpoint(path_, "key"), OutputError);
    EXPECT_EQ(work.block(1), contentOf(1));
}

/// Cut at every byte, a file holds the blocks before the cut, and goes on.
TEST_F(CheckpointFile, CutAnywhereHoldsTheBlocksBefore) {
    {
        Checkpoint work(path_, "key");
        for (std::uint64_t index = 1; index <= 3; ++index) work.add(index, contentOf(index));
    }
    const std::string whole = read();
    constexpr std::size_t head = 80;
    std::size_t ends[4];
    ends[3] = whole.size();
    for (std::size_t k = 3; k > 0; --k) ends[k - 1] = ends[k] - head - contentOf(k).size();
    for (std::size_t length = 0; length < whole.size(); ++length) {
        write(whole.substr(0, length));
        Checkpoint work(path_, "key");
        std::size_t kept = 0;
        for (std::uint64_t index = 1; index <= 3; ++index) {
            if (length < ends[index]) {
                EXPECT_FALSE(work.block(index)) << length;
                continue;
            }
            EXPECT_EQ(work.block(index), contentOf(index)) << length;
            ++kept;
        }
        EXPECT_EQ(work.blocks(), kept);
        for (std::uint64_t index = kept + 1; index <= 3; ++index) work.add(index, contentOf(index));
        EXPECT_EQ(read(), whole) << length;
    }
}

/// A changed byte costs blocks or the file, and never gives other bytes.
TEST_F(CheckpointFile, WithAChangedByteNeverGivesWrongBlocks) {
    {
        Checkpoint work(path_, "key");
        for (std::uint64_t index = 1; index <= 3; ++index) work.add(index, contentOf(index));
    }
    const std::string whole = read();
    for (std::size_t at = 0; at < whole.size(); ++at) {
        std::string changed = whole;
        changed[at] = static_cast<char>(changed[at] ^ 0x41);
        write(changed);
        try {
            const Checkpoint work(path_, "key");
            EXPECT_LT(work.blocks(), 3u) << at;
            for (std::uint64_t index = 0; index <= 300; ++index) {
                const auto block = work.block(index);
                if (block) {
                    EXPECT_EQ(*block, contentOf(index)) << at;
                }
            }
        } catch (const InputError&) {
            EXPECT_EQ(read(), changed) << at;
        }
    }
}

TEST_F(CheckpointFile, TakesBlocksFromSeveralThreads) {
    {
        Checkpoint work(path_, "key");
        std::vector<std::thread> threads;
        for (std::uint64_t first = 0; first < 4; ++first) {
            threads.emplace_back([&, first] {
                for (std::uint64_t index = first; index < 400; index += 4)
                    work.add(index, contentOf(index));
            });
        }
        for (std::thread& thread : threads) thread.join();
    }
    const Checkpoint work(path_, "key");
    for (std::uint64_t index = 0; index < 400; ++index)
        EXPECT_EQ(work.block(index), contentOf(index));
}

/// Twenty processes are killed at random moments of their writing; work goes on after each.
TEST_F(CheckpointFile, OfKilledProcessesGoesOn) {
    std::mt19937 random(1);
    std::size_t before = 0;
    for (int kill = 0; kill < 20; ++kill) {
        const pid_t child = fork();
        if (child == 0) {
            Checkpoint work(path_, "key");
            for (std::uint64_t index = work.blocks();; ++index) work.add(index, contentOf(index));
        }
        // At least one more block, and then a random moment.
        const auto length = [&] { return stands() ? std::filesystem::file_size(path_) : 0; };
        while (length() < before + 200) usleep(100);
        usleep(std::uniform_int_distribution<unsigned>(0, 3000)(random));
        ::kill(child, SIGKILL);
        ASSERT_EQ(waitpid(child, nullptr, 0), child);
        const Checkpoint work(path_, "key");
        ASSERT_GT(work.blocks(), 0u);
        for (std::uint64_t index = 0; index < work.blocks(); ++index)
            ASSERT_EQ(work.block(index), contentOf(index)) << kill;
        before = length();
    }
}

TEST_F(CheckpointFile, OnAFullDiskStaysAsItWas) {
    Checkpoint work(path_, "key");
    work.add(1, contentOf(1));
    const std::string before = read();
    rlimit limit{};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &limit), 0);
    rlimit narrow = limit;
    narrow.rlim_cur = before.size() + 90;
    const auto handler = signal(SIGXFSZ, SIG_IGN);
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &narrow), 0);
    EXPECT_THROW(work.add(2, std::vector<std::byte>(1000)), OutputError);
    setrlimit(RLIMIT_FSIZE, &limit);
    signal(SIGXFSZ, handler);
    EXPECT_EQ(read(), before);
    work.add(2, contentOf(2));
    EXPECT_EQ(work.block(2), contentOf(2));
}

}  // namespace
}  // namespace hshfit
