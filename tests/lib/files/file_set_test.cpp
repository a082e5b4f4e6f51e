#include <hshfit/error.h>
#include <hshfit/files/file_set.h>

#include "lib/coefficient_files/coefficient_samples.h"

#include <atomic>
#include <csignal>
#include <new>
#include <thread>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace fs = std::filesystem;
using hshfit::FileSet;
using hshfit::OutputError;
using hshfit::samples::contentOf;
using hshfit::samples::Folder;
using hshfit::samples::put;

namespace {

std::ptrdiff_t entries(const fs::path& folder) {
    return std::distance(fs::directory_iterator(folder), {});
}

TEST(FileSet, AppearsAsAWhole) {
    const Folder folder;
    {
        FileSet files(folder.path() / "a" / "b", false);
        files.write("one", "1");
        files.add("two").write("2");
        EXPECT_FALSE(fs::exists(folder / "a/b/one"));
        files.commit();
    }
    EXPECT_EQ(contentOf(folder / "a/b/one"), "1");
    EXPECT_EQ(contentOf(folder / "a/b/two"), "2");
    EXPECT_EQ(entries(folder.path() / "a" / "b"), 2);
}

TEST(FileSet, LeavesNothingWithoutCommit) {
    const Folder folder;
    {
        FileSet files(folder.path() / "a" / "b", false);
        files.write("one", "1");
    }
    EXPECT_FALSE(fs::exists(folder / "a"));
    fs::create_directory(folder / "stays");
    { const FileSet files(folder / "stays", false); }
    EXPECT_TRUE(fs::exists(folder / "stays"));
}

TEST(FileSet, RefusesExistingFiles) {
    const Folder folder;
    put(folder / "one", "before");
    FileSet files(folder.path(), false);
    EXPECT_THROW(files.add("one"), OutputError);
    files.write("two", "2");
    EXPECT_THROW(files.add("two"), OutputError) << "twice in one set";
    EXPECT_THROW(files.add("no/such/folder"), OutputError);
    FileSet replacing(folder.path(), true);
    replacing.write("one", "after");
    replacing.commit();
    EXPECT_EQ(contentOf(folder / "one"), "after");
}

// A rename that fails takes those before it back.
TEST(FileSet, TakesBackWhenAFileTurnsUpInTheMeantime) {
    const Folder folder;
    {
        FileSet files(folder.path(), false);
        files.write("one", "1");
        files.write("two", "2");
        put(folder / "two", "theirs");
        EXPECT_THROW(files.commit(), OutputError);
    }
    EXPECT_FALSE(fs::exists(folder / "one"));
    EXPECT_EQ(contentOf(folder / "two"), "theirs");
    EXPECT_EQ(entries(folder.path()), 1);
}

TEST(FileSet, RestoresReplacedFiles) {
    const Folder folder;
    put(folder / "one", "before");
    fs::create_symlink("one", folder / "link");
    put(folder / "three", "3 before");
    {
        FileSet files(folder.path(), true);
        files.write("link", "after");
        files.write("new", "after");
        files.write("three", "after");
        files.write("two", "after");
        fs::create_directory(folder / "two");
        EXPECT_THROW(files.commit(), OutputError);
    }
    EXPECT_EQ(contentOf(folder / "one"), "before");
    EXPECT_EQ(contentOf(folder / "three"), "3 before");
    EXPECT_TRUE(fs::is_symlink(folder / "link"));
    EXPECT_FALSE(fs::exists(folder / "new"));
    EXPECT_EQ(entries(folder.path()), 4) << "one, link, three, two";
}

TEST(FileSet, LeavesNoLinksToReplacedFiles) {
    const Folder folder;
    put(folder / "one", "before");
    FileSet files(folder.path(), true);
    files.write("one", "after");
    files.write("two", "2");
    files.commit();
    EXPECT_EQ(contentOf(folder / "one"), "after");
    EXPECT_EQ(entries(folder.path()), 2);
}

TEST(FileSet, SaysThatAFileStandsWhereAFolderShould) {
    const Folder folder;
    put(folder / "file", "x");
    EXPECT_THROW(FileSet(folder / "file", true), OutputError);
    EXPECT_THROW(FileSet(folder / "file/below", true), OutputError);
    EXPECT_EQ(entries(folder.path()), 1);
}

TEST(FileSet, AFileWhoseWriterThrowsIsNotOfTheSet) {
    const Folder folder;
    FileSet files(folder.path(), true);
    files.write("one", "1");
    const auto throws = [](hshfit::AtomicFile& file) {
        file.write("half of ");
        throw std::bad_alloc();
    };
    EXPECT_THROW(files.write("two", throws), std::bad_alloc);
    files.write("three", "3");
    files.remove("three");
    files.commit();
    EXPECT_EQ(contentOf(folder / "one"), "1");
    EXPECT_EQ(entries(folder.path()), 1);
}

TEST(FileSet, FoldersAboveAreMadeOrRequired) {
    const Folder folder;
    EXPECT_THROW(FileSet(folder.path() / "a" / "b", true, FileSet::Above::require), OutputError);
    EXPECT_FALSE(fs::exists(folder / "a"));
    FileSet slash(folder.path() / "a/", true, FileSet::Above::require);
    slash.write("one", "1");
    slash.commit();
    EXPECT_EQ(contentOf(folder / "a/one"), "1");
}

/// Runs `work` in a child that removes its traces on signals; its wait status.
template <class Work>
int inChild(Work work) {
    const pid_t child = ::fork();
    if (child == 0) {
        hshfit::removeTemporariesOnSignals();
        work();
        ::_exit(0);
    }
    int status = 0;
    EXPECT_EQ(::waitpid(child, &status, 0), child);
    return status;
}

TEST(FileSet, SignalsRemoveTheFolderThatWasMade) {
    const Folder folder;
    const int status = inChild([&] {
        FileSet files(folder.path() / "a" / "b", true);
        files.write("one", "1");
        ::raise(SIGTERM);
    });
    EXPECT_TRUE(WIFSIGNALED(status));
    EXPECT_EQ(entries(folder.path()), 0);
}

// The signal arrives at the thread that renames, and at another one while it renames.
TEST(FileSet, SignalsWaitUntilAllAreRenamed) {
    const Folder folder;
    for (const bool another : {false, true}) {
        const int status = inChild([&] {
            std::atomic<bool> renaming = false;
            std::thread other([&] {
                renaming.wait(false);
                ::kill(::getpid(), SIGTERM);
            });
            FileSet files(folder.path() / "a", true);
            for (int i = 0; i < 100; ++i) files.write(std::to_string(i), "x");
            {
                const hshfit::Uninterrupted step;
                if (another) {
                    renaming = true;
                    renaming.notify_one();
                    ::usleep(20'000);
                } else {
                    ::raise(SIGTERM);
                }
                files.commit();
            }
            ::pause();
        });
        ASSERT_TRUE(WIFSIGNALED(status));
        EXPECT_EQ(WTERMSIG(status), SIGTERM);
        EXPECT_EQ(entries(folder.path() / "a"), 100);
        fs::remove_all(folder / "a");
    }
}

// The limit on the size of files stands in for a full disk: the last of three does not fit.
TEST(FileSet, AFullDiskLeavesNothing) {
    const Folder folder;
    put(folder / "one", "before");
    const pid_t child = ::fork();
    if (child == 0) {
        hshfit::removeTemporariesOnSignals();
        const rlimit limit{1000, 1000};
        ::setrlimit(RLIMIT_FSIZE, &limit);
        try {
            FileSet files(folder.path(), true);
            files.write("one", "after");
            files.write("two", "2");
            files.write("three", std::string(2000, 'x'));
            files.commit();
        } catch (const OutputError&) {
            ::_exit(5);
        }
        ::_exit(0);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), 5);
    EXPECT_EQ(contentOf(folder / "one"), "before");
    EXPECT_EQ(entries(folder.path()), 1);
}

}  // namespace
