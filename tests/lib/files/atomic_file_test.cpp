#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

namespace fs = std::filesystem;
using hshfit::AtomicFile;
using hshfit::OutputError;

namespace {

class AtomicFileTest : public ::testing::Test {
protected:
    void SetUp() override {
        char pattern[] = "/tmp/hshfit-atomic-XXXXXX";
        ASSERT_NE(::mkdtemp(pattern), nullptr);
        folder = pattern;
    }
    void TearDown() override {
        fs::permissions(folder, fs::perms::owner_all);
        fs::remove_all(folder);
    }
    std::size_t entries() const {
        return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), {}));
    }
    static std::string content(const fs::path& path) {
        std::ifstream in(path, std::ios::binary);
        return {std::istreambuf_iterator<char>(in), {}};
    }
    static std::string messageOf(const fs::path& path, std::string_view text) {
        try {
            hshfit::writeFile(path.string(), text);
        } catch (const OutputError& error) {
            EXPECT_EQ(error.code(), hshfit::ExitCode::output);
            return error.what();
        }
        ADD_FAILURE() << path << " was written";
        return {};
    }
    /// Runs `work` in a child; its wait status.
    template <class Work>
    static int inChild(Work work) {
        const pid_t child = ::fork();
        if (child == 0) {
            work();
            ::_exit(0);
        }
        int status = 0;
        EXPECT_EQ(::waitpid(child, &status, 0), child);
        return status;
    }

    fs::path folder;
};

TEST_F(AtomicFileTest, AppearsOnlyOnCommit) {
    const fs::path path = folder / "a.txt";
    std::ofstream(path) << "before";
    {
        AtomicFile file(path.string());
        file.write("after");
        std::fflush(file.stream());
        EXPECT_EQ(content(path), "before");
        EXPECT_EQ(content(file.temporaryPath()), "after");
        EXPECT_EQ(fs::path(file.temporaryPath()).parent_path(), folder);
        file.commit();
        EXPECT_EQ(content(path), "after");
    }
    EXPECT_EQ(content(path), "after");
    EXPECT_EQ(entries(), 1u);
}

TEST_F(AtomicFileTest, LeavesNothingWithoutCommit) {
    const fs::path path = folder / "a.txt";
    std::ofstream(path) << "before";
    {
        AtomicFile file(path.string());
        file.write("after");
    }
    EXPECT_EQ(content(path), "before");
    EXPECT_EQ(entries(), 1u);
}

TEST_F(AtomicFileTest, TakesPermissionsFromTheUmask) {
    const mode_t old = ::umask(0027);
    hshfit::writeFile((folder / "a").string(), "x");
    ::umask(old);
    struct stat status {};
    ASSERT_EQ(::stat((folder / "a").c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 07777u, 0640u);
}

TEST_F(AtomicFileTest, RefusesAnExistingFileWhenAsked) {
    const fs::path path = folder / "a.txt";
    std::ofstream(path) << "before";
    EXPECT_THROW(AtomicFile(path.string(), AtomicFile::Existing::refuse), OutputError);
    // One that appears while the file is being written.
    AtomicFile file((folder / "b").string(), AtomicFile::Existing::refuse);
    file.write("ours");
    std::ofstream(folder / "b") << "theirs";
    EXPECT_THROW(file.commit(), OutputError);
    EXPECT_EQ(content(folder / "b"), "theirs");
    EXPECT_EQ(entries(), 2u);
}

TEST_F(AtomicFileTest, FollowsLinksAndKeepsThem) {
    const fs::path path = folder / "a.txt", link = folder / "link";
    std::ofstream(path) << "before";
    fs::create_symlink("a.txt", link);
    hshfit::writeFile(link.string(), "after");
    EXPECT_TRUE(fs::is_symlink(link));
    EXPECT_EQ(content(path), "after");
}

TEST_F(AtomicFileTest, FollowsLinksToWhereNothingStands) {
    fs::create_directory(folder / "to");
    fs::create_symlink("to/second", folder / "first");
    fs::create_symlink("made", folder / "to/second");
    hshfit::writeFile((folder / "first").string(), "x");
    EXPECT_TRUE(fs::is_symlink(folder / "first"));
    EXPECT_TRUE(fs::is_symlink(folder / "to/second"));
    EXPECT_TRUE(fs::is_regular_file(fs::symlink_status(folder / "to/made")));
    EXPECT_EQ(content(folder / "to/made"), "x");
    fs::create_symlink(folder / "none/file", folder / "astray");
    EXPECT_NE(messageOf(folder / "astray", "x").find("No such file"), std::string::npos);
    fs::create_symlink("circle", folder / "circle");
    EXPECT_NE(messageOf(folder / "circle", "x").find("symbolic links"), std::string::npos);
    EXPECT_EQ(entries(), 4u) << "first, to, astray, circle";
}

TEST_F(AtomicFileTest, KeepsThePermissionsOfTheFileItReplaces) {
    const fs::path path = folder / "a";
    for (const mode_t mode : {0600U, 0640U, 0666U, 0755U}) {
        std::ofstream(path) << "before";
        ASSERT_EQ(::chmod(path.c_str(), mode), 0);
        const bool root = ::geteuid() == 0;
        if (root) {
            ASSERT_EQ(::chown(path.c_str(), 12, 34), 0);
        }
        AtomicFile file(path.string());
        struct stat status {};
        ASSERT_EQ(::stat(file.temporaryPath().c_str(), &status), 0);
        EXPECT_EQ(status.st_mode & 07777u, mode) << "never open to more readers, not even before";
        file.commit();
        ASSERT_EQ(::stat(path.c_str(), &status), 0);
        EXPECT_EQ(status.st_mode & 07777u, mode);
        if (root) {
            EXPECT_EQ(std::pair(status.st_uid, status.st_gid), std::pair(12U, 34U));
        }
        fs::remove(path);
    }
}

TEST_F(AtomicFileTest, NamesTheFileThatCannotBeWritten) {
    EXPECT_EQ(messageOf(folder, "x"), "cannot write '" + folder.string() + "': Is a directory");
    EXPECT_NE(messageOf(folder / "none" / "a", "x").find("there is no folder '"),
              std::string::npos);
    EXPECT_NE(messageOf(folder / "none/", "x").find("Is a directory"), std::string::npos);
    EXPECT_THROW(hshfit::writeFile("", "x"), OutputError);
    hshfit::writeFile((folder / "file").string(), "x");
    EXPECT_NE(messageOf(folder / "file" / "a", "x").find("Not a directory"), std::string::npos);
    EXPECT_NE(messageOf(folder / std::string(300, 'a'), "x").find("too long"), std::string::npos);
    EXPECT_EQ(entries(), 1u);
}

TEST_F(AtomicFileTest, UnwritableFolderOrFile) {
    hshfit::writeFile((folder / "protected").string(), "x");
    fs::permissions(folder / "protected", static_cast<fs::perms>(0444));
    fs::permissions(folder, static_cast<fs::perms>(0555));
    const int status = inChild([&] {
        if (::geteuid() == 0 && ::setuid(65534) != 0) ::_exit(1);  // root may write anywhere
        for (const char* name : {"new", "protected"}) {
            if (messageOf(folder / name, "y").find("Permission denied") == std::string::npos) {
                ::_exit(2);
            }
        }
    });
    ASSERT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), 0);
    EXPECT_EQ(content(folder / "protected"), "x");
}

TEST_F(AtomicFileTest, ReportsAFullDevice) {
    if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
    // Fits into the stream's buffer, so that only the flush in commit() can notice.
    EXPECT_EQ(messageOf("/dev/full", "x"), "cannot write '/dev/full': No space left on device");
    EXPECT_NE(messageOf("/dev/full", std::string(1 << 20, 'x')).find("No space left"),
              std::string::npos);
    struct stat status {};
    ASSERT_EQ(::stat("/dev/full", &status), 0);
    EXPECT_TRUE(S_ISCHR(status.st_mode)) << "a device is written to, not replaced";
}

TEST_F(AtomicFileTest, ReportsAFileSizeLimitAndCleansUp) {
    const int status = inChild([&] {
        hshfit::removeTemporariesOnSignals();
        const rlimit limit{1000, 1000};
        ::setrlimit(RLIMIT_FSIZE, &limit);
        try {
            hshfit::writeFile((folder / "a").string(), std::string(2000, 'x'));
        } catch (const OutputError& error) {
            ::_exit(static_cast<int>(error.code()));
        }
    });
    ASSERT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), 5);
    EXPECT_EQ(entries(), 0u);
}

TEST_F(AtomicFileTest, SignalsRemoveTheTemporaries) {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE}) {
        const int status = inChild([&] {
            const rlimit noCore{0, 0};
            ::setrlimit(RLIMIT_CORE, &noCore);
            hshfit::removeTemporariesOnSignals();
            AtomicFile first((folder / "a").string()), second((folder / "b").string());
            first.write("x");
            hshfit::writeFile((folder / "done").string(), "x");
            if (entries() == 3) ::raise(signal);
        });
        ASSERT_TRUE(WIFSIGNALED(status)) << signal;
        EXPECT_EQ(WTERMSIG(status), signal);
        EXPECT_EQ(entries(), 1u) << "only the committed file stays";
    }
}

TEST_F(AtomicFileTest, ManyOpenAtOnce) {
    // Fewer file descriptors than files would be no matter: each is open until it is committed.
    {
        std::vector<std::unique_ptr<AtomicFile>> files;
        for (int i = 0; i < 100; ++i) {
            files.push_back(std::make_unique<AtomicFile>((folder / std::to_string(i)).string()));
            files.back()->write(std::to_string(i));
        }
        for (std::size_t i = 0; i < 100; i += 2) files[i]->commit();
    }
    EXPECT_EQ(entries(), 50u);
    EXPECT_EQ(content(folder / "98"), "98");
}

}  // namespace
