#include <hshfit/error.h>
#include <hshfit/pages/gnuplot.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace hshfit::inline pages {
namespace {

struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
};
using Scratch = std::unique_ptr<std::FILE, Close>;

[[noreturn]] void fail(const std::string& why) {
    throw OutputError(fmt::format("the figures could not be drawn: {}", why));
}

/// A nameless file for the output of the child, of any length.
Scratch scratch() {
    Scratch file(std::tmpfile());
    if (!file) fail(std::generic_category().message(errno));
    return file;
}

std::string contentOf(std::FILE* file) {
    std::string text;
    std::array<char, 4096> block{};
    std::rewind(file);
    while (const std::size_t count = std::fread(block.data(), 1, block.size(), file)) {
        text.append(block.data(), count);
    }
    return text;
}

/// The last lines of gnuplot's complaint as one line.
std::string lastWords(std::string text) {
    std::replace(text.begin(), text.end(), '\n', ' ');
    const auto squeezed =
        std::unique(text.begin(), text.end(), [](char a, char b) { return a == ' ' && b == ' '; });
    text.erase(squeezed, text.end());
    constexpr std::size_t limit = 300;
    return text.size() > limit ? text.substr(text.size() - limit) : text;
}

class Actions {
public:
    Actions() { ::posix_spawn_file_actions_init(&actions_); }
    ~Actions() { ::posix_spawn_file_actions_destroy(&actions_); }
    Actions(const Actions&) = delete;
    Actions& operator=(const Actions&) = delete;
    posix_spawn_file_actions_t* operator&() { return &actions_; }

private:
    posix_spawn_file_actions_t actions_{};
};

}  // namespace

void runGnuplot(const std::string& folder, const std::vector<std::string>& arguments) {
    const Scratch complaints = scratch();
    Actions actions;
    ::posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    ::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    ::posix_spawn_file_actions_adddup2(&actions, ::fileno(complaints.get()), STDERR_FILENO);
    ::posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());

    std::vector<std::string> words{"gnuplot", "-d"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);

    pid_t child = 0;
    const int error = ::posix_spawnp(&child, "gnuplot", &actions, nullptr, argv.data(), environ);
    if (error == ENOENT) {
        fail("gnuplot was not found; install it (Debian: apt-get install gnuplot-nox)");
    }
    if (error != 0) fail("gnuplot: " + std::generic_category().message(error));
    int status = 0;
    while (::waitpid(child, &status, 0) < 0) {
        if (errno != EINTR) fail(std::generic_category().message(errno));
    }
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
        fail("gnuplot failed: " + lastWords(contentOf(complaints.get())));
    }
}

std::string gnuplotString(const std::string& text) {
    std::string out = "'";
    for (const char c : text) {
        if (c == '\'') {
            out += "''";
        } else if (c == '\n') {
            out += "'.\"\\n\".'";
        } else {
            out += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
        }
    }
    return out + "'";
}

}  // namespace hshfit::inline pages
