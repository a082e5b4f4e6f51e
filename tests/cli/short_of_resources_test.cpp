// Runs with little memory and without threads: the same files, or one line and none.

#include "program.h"

#include <cli/run_words.h>

#include <fmt/format.h>

#include <exception>
#include <map>
#include <system_error>
#include <thread>

#include <fcntl.h>
#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

namespace hshfit::test {
namespace {

class ShortOfResources : public Cli {
protected:
    /// The contents of all files below a folder.
    std::map<std::string, std::string> filesIn(const std::string& name) const {
        std::map<std::string, std::string> files;
        if (!fs::exists(path(name))) return files;
        for (const auto& entry : fs::recursive_directory_iterator(path(name)))
            if (entry.is_regular_file())
                files[entry.path().lexically_relative(folder_)] = read(entry.path());
        return files;
    }

    /// The program in an empty folder "run" with a limit of its address space, 0 for none. The
    /// notes of standard error, which hold "poor:", are left out.
    Answer within(std::size_t kilobytes, const std::string& arguments) const {
        fs::remove_all(path("run"));
        fs::create_directory(path("run"));
        const std::string limit = kilobytes > 0 ? fmt::format("ulimit -v {};", kilobytes) : "";
        const std::string line = fmt::format("cd '{}'; {} PATH=/nowhere '{}' {} >../out 2>../err",
                                             path("run"), limit, test::program(), arguments);
        const int status = std::system(line.c_str());
        Answer answer{WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
                      read(path("out")), ""};
        std::istringstream lines(read(path("err")));
        for (std::string each; std::getline(lines, each);)
            if (each.find("poor:") == std::string::npos) answer.err += each + "\n";
        return answer;
    }

    /// The least limit, to a megabyte, with which the program starts.
    std::size_t leastMemory() const {
        std::size_t low = 0, high = 1 << 22;
        while (high - low > 1024) {
            const std::size_t middle = (low + high) / 2;
            (within(middle, "--version").code == 0 ? high : low) = middle;
        }
        return high;
    }

    /// The program with one process or thread of its user at most. Root, who has no such limit, is
    /// another user there.
    Answer withoutThreads(const std::vector<std::string>& words) const {
        fs::permissions(folder_, fs::perms::all);
        const int program = ::open(test::program().c_str(), O_RDONLY);
        const pid_t child = ::fork();
        if (child == 0) {
            const int err = ::open(path("err").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
            ::dup2(err, STDOUT_FILENO);
            ::dup2(err, STDERR_FILENO);
            constexpr uid_t nobodyElse = 64999;
            if (::geteuid() == 0 && ::setuid(nobodyElse) != 0) ::_exit(126);
            const rlimit one{1, 1};
            if (::setrlimit(RLIMIT_NPROC, &one) != 0) ::_exit(126);
            std::vector<std::string> all{"hshfit"};
            all.insert(all.end(), words.begin(), words.end());
            std::vector<char*> pointers;
            for (std::string& word : all) pointers.push_back(word.data());
            pointers.push_back(nullptr);
            ::fexecve(program, pointers.data(), environ);
            ::_exit(127);
        }
        ::close(program);
        int status = 0;
        ::waitpid(child, &status, 0);
        return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), "",
                read(path("err"))};
    }
};

TEST_F(ShortOfResources, FilesAreWholeOrAbsentWithLittleMemory) {
    ASSERT_EQ(
        run("project phong:exponent=20 -o " + path("c.json") + " --order 4 --outgoing 4x4").code,
        0);
    write("scene.json", R"({"format": "hshfit-scene", "version": 1,
        "materials": [{"name": "paint", "brdf": "lambert:kd=.5", "orientations": [{"theta": 20}]}],
        "lights": [{"kind": "sky", "model": "overcast", "radiance": [1, 2, 3]}],
        "views": {"theta": [0, 70], "tangent": "fixed"},
        "budget": {"metric": "relative_l2", "error": 0.2}})");
    const std::size_t least = leastMemory();
    for (const char* command :
         {"export ../c.json -o out --target viewer", "export ../c.json -o out --target three",
          "plan ../scene.json -o out --max-order 2"}) {
        const std::string arguments = std::string(command) + " --threads 1";
        ASSERT_EQ(within(0, arguments).code, 0);
        const auto whole = filesIn("run");
        ASSERT_FALSE(whole.empty());
        int refused = 0;
        for (std::size_t step = 0; step < 12; ++step) {
            const std::size_t limit = least + 900 * step;
            const Answer answer = within(limit, arguments);
            const std::string where = fmt::format("{}, {} kB: {}", command, limit, answer.err);
            if (answer.code == 0) {
                EXPECT_EQ(filesIn("run"), whole) << where;
                continue;
            }
            ++refused;
            EXPECT_TRUE(answer.code >= 3 && answer.code <= 5) << answer.code << ", " << where;
            EXPECT_EQ(std::count(answer.err.begin(), answer.err.end(), '\n'), 1) << where;
            EXPECT_TRUE(filesIn("run").empty()) << where;
        }
        EXPECT_GT(refused, 0) << command;
    }
}

TEST_F(ShortOfResources, OneThreadMoreThanTheSystemStartsIsOneLine) {
    const std::vector<std::string> words{"project",      "phong:exponent=20", "-o",
                                         path("c.json"), "--outgoing",        "8x8",
                                         "--quiet",      "--threads"};
    auto eight = words, one = words;
    eight.emplace_back("8");
    one.emplace_back("1");
    cpu_set_t processors;
    ASSERT_EQ(::sched_getaffinity(0, sizeof processors, &processors), 0);
    if (CPU_COUNT(&processors) > 1) {  // oneTBB starts a thread
        const Answer answer = withoutThreads(eight);
        EXPECT_EQ(answer.code, 4) << answer.err;
        EXPECT_EQ(std::count(answer.err.begin(), answer.err.end(), '\n'), 1) << answer.err;
        EXPECT_NE(answer.err.find("--threads 1"), std::string::npos) << answer.err;
        EXPECT_FALSE(fs::exists(path("c.json")));
    }
    const Answer answer = withoutThreads(one);
    EXPECT_EQ(answer.code, 0) << answer.err;
    EXPECT_TRUE(fs::exists(path("c.json")));
}

TEST_F(ShortOfResources, UncaughtExceptionsEndInOneLine) {
    testing::GTEST_FLAG(death_test_style) = "threadsafe";
    const auto inThread = [](const std::exception_ptr& failure) {
        cli::endUncaughtInOneLine();
        std::thread([&] { std::rethrow_exception(failure); }).join();
    };
    const auto refused = std::make_exception_ptr(
        std::system_error(std::make_error_code(std::errc::resource_unavailable_try_again)));
    EXPECT_EXIT(inThread(refused), testing::ExitedWithCode(4), "^hshfit: .*threads[^\n]*\n$");
    EXPECT_EXIT(inThread(std::make_exception_ptr(std::bad_alloc())), testing::ExitedWithCode(4),
                "^hshfit: not enough memory[^\n]*\n$");
    EXPECT_EXIT(inThread(std::make_exception_ptr(std::logic_error("x"))),
                testing::ExitedWithCode(1), "^hshfit: internal error: x\n$");
}

}  // namespace
}  // namespace hshfit::test
