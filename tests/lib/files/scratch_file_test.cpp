#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>
#include <hshfit/files/scratch_file.h>

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <temporary_file.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <span>
#include <string>

namespace hshfit {
namespace {

namespace fs = std::filesystem;

/// A folder of its own, removed after the test.
class ScratchFileTest : public testing::Test {
protected:
    ScratchFileTest() {
        fs::remove(place_.path());
        fs::create_directory(place_.path());
    }
    std::string folder() const { return place_.path(); }
    bool isEmpty() const { return fs::is_empty(place_.path()); }

private:
    test::TemporaryFile place_;
};

/// Bytes that tell their place.
std::string numbered(std::size_t count) {
    std::string text;
    while (text.size() < count) text += std::to_string(text.size()) + ' ';
    text.resize(count);
    return text;
}

std::string part(const ScratchFile& file, std::uint64_t offset, std::size_t count) {
    std::string text(count, '?');
    file.read(offset, std::as_writable_bytes(std::span(text.data(), count)));
    return text;
}

TEST_F(ScratchFileTest, GivesBackBytesFromDiskAndMemoryAndAcrossTheTwo) {
    const std::string text = numbered(1000);
    ScratchFile file(folder(), 100);
    for (std::size_t at = 0; at < text.size(); at += 40) {
        EXPECT_EQ(file.size(), at);
        EXPECT_EQ(file.append(text.substr(at, 40)), at);
    }
    for (std::size_t at = 0; at <= text.size(); at += 7)
        for (std::size_t count : {0, 1, 33, 300}) {
            count = std::min(count, text.size() - at);
            ASSERT_EQ(part(file, at, count), text.substr(at, count)) << at << ' ' << count;
        }
    EXPECT_EQ(part(file, 0, text.size()), text);
}

TEST_F(ScratchFileTest, HasNoNameWhileItIsUsed) {
    ScratchFile file(folder(), 10);
    file.append(numbered(100000));
    EXPECT_TRUE(isEmpty());
}

TEST_F(ScratchFileTest, CopiesAllOfItself) {
    const std::string text = numbered(600000);
    ScratchFile from(folder(), 1000), to(folder(), 1000);
    from.append(text);
    from.append("end");
    to.append("before ");
    from.copyTo(to);
    EXPECT_EQ(part(to, 0, to.size()), "before " + text + "end");
    const std::string path = folder() + "/copy";
    AtomicFile file(path);
    from.copyTo(file);
    file.commit();
    std::ifstream in(path, std::ios::binary);
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), text + "end");
}

TEST_F(ScratchFileTest, AFullDiskAndAFolderThatIsNotThereAreErrorsThatNameTheFolder) {
    rlimit before{};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
    const rlimit narrow{5000, before.rlim_max};
    const auto handler = signal(SIGXFSZ, SIG_IGN);
    std::string message;
    {
        ScratchFile file(folder(), 1000);
        ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &narrow), 0);
        try {
            for (int n = 0; n < 10; ++n) file.append(numbered(1500));
        } catch (const OutputError& error) {
            message = error.what();
        }
        setrlimit(RLIMIT_FSIZE, &before);
        signal(SIGXFSZ, handler);
    }
    EXPECT_NE(message.find("'" + folder() + "': File too large"), std::string::npos) << message;
    EXPECT_TRUE(isEmpty());
    ScratchFile nowhere(folder() + "/absent", 10);
    nowhere.append("few");
    try {
        nowhere.append(numbered(100));
        ADD_FAILURE() << "no error";
    } catch (const OutputError& error) {
        EXPECT_NE(std::string(error.what()).find("absent': No such file"), std::string::npos)
            << error.what();
    }
}

/// The value of TMPDIR while this lives.
class TemporaryFolderVariable {
public:
    explicit TemporaryFolderVariable(const char* value) {
        if (const char* before = std::getenv("TMPDIR")) before_ = before;
        value ? setenv("TMPDIR", value, 1) : unsetenv("TMPDIR");
    }
    ~TemporaryFolderVariable() {
        before_ ? setenv("TMPDIR", before_->c_str(), 1) : unsetenv("TMPDIR");
    }

private:
    std::optional<std::string> before_;
};

TEST(ScratchFolder, IsBesideTheOutputUnlessTheEnvironmentNamesOne) {
    const TemporaryFolderVariable unset(nullptr);
    EXPECT_EQ(scratchFolder("some/folder/a.library"), "some/folder");
    EXPECT_EQ(scratchFolder("a.library"), ".");
    EXPECT_EQ(scratchFolder("/dev/null"), fs::temp_directory_path());
    const TemporaryFolderVariable set("/var/tmp");
    EXPECT_EQ(scratchFolder("some/folder/a.library"), "/var/tmp");
}

}  // namespace
}  // namespace hshfit
