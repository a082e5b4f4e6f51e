#include <hshfit/error.h>
#include <hshfit/pages/gnuplot.h>
#include <hshfit/pages/page_figures.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string_view>
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
    throw NoFigures(fmt::format("the figures could not be drawn: {}", why));
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

/// A process group of its own, and the signals that were not blocked before.
class Attributes {
public:
    explicit Attributes(const sigset_t& mask) {
        ::posix_spawnattr_init(&attributes_);
        ::posix_spawnattr_setpgroup(&attributes_, 0);
        ::posix_spawnattr_setsigmask(&attributes_, &mask);
        ::posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK);
    }
    ~Attributes() { ::posix_spawnattr_destroy(&attributes_); }
    Attributes(const Attributes&) = delete;
    Attributes& operator=(const Attributes&) = delete;
    posix_spawnattr_t* operator&() { return &attributes_; }

private:
    posix_spawnattr_t attributes_{};
};

/// The environment with UTC for the dates that figures hold.
std::vector<std::string> environmentInUtc() {
    std::vector<std::string> variables{"TZ=UTC0"};
    for (char** variable = environ; *variable; ++variable) {
        if (std::strncmp(*variable, "TZ=", 3) != 0) variables.emplace_back(*variable);
    }
    return variables;
}

std::vector<char*> pointersTo(std::vector<std::string>& words) {
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    return pointers;
}

/// Starts the child and waits for it; its wait status. A signal that ends this process ends the
/// child first: it knows of it from before its start until after its end.
int statusOf(std::vector<std::string> words, Actions& actions) {
    std::vector<std::string> variables = environmentInUtc();
    const std::vector<char*> argv = pointersTo(words), environment = pointersTo(variables);
    pid_t child = 0;
    Trace trace;
    {
        const Uninterrupted start;
        Attributes attributes(start.signalsBefore());
        const int error =
            ::posix_spawnp(&child, argv[0], &actions, &attributes, argv.data(), environment.data());
        if (error == ENOENT) {
            fail("gnuplot was not found; install it (Debian: apt-get install gnuplot-nox)");
        }
        if (error != 0) fail("gnuplot: " + std::generic_category().message(error));
        trace.child(child);
    }
    // The process number stays taken until the child is waited for, within the second step.
    siginfo_t information{};
    while (::waitid(P_PID, static_cast<id_t>(child), &information, WEXITED | WNOWAIT) < 0 &&
           errno == EINTR) {
    }
    const Uninterrupted end;
    int status = 0;
    while (::waitpid(child, &status, 0) < 0) {
        if (errno != EINTR) fail(std::generic_category().message(errno));
    }
    trace.release();
    return status;
}

std::string endOf(const std::string& path) {
    constexpr std::streamoff most = 64;
    std::ifstream in(path, std::ios::binary | std::ios::ate);
    const std::streamoff size = in.tellg();
    if (!in || size <= 0) return {};
    in.seekg(size - std::min(size, most));
    return {std::istreambuf_iterator<char>(in), {}};
}

/// Blanks the dates that cairo writes into a PDF, so that equal figures have equal bytes; the
/// length, and so the table of offsets, stays.
void removeDates(const std::string& path) {
    const std::string figure = fileContent(path);
    if (!figure.starts_with("%PDF-")) return;
    std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
    for (const std::string_view key : {"/CreationDate (", "/ModDate ("}) {
        for (std::size_t at = 0; (at = figure.find(key, at)) != figure.npos; at += key.size()) {
            file.seekp(static_cast<std::streamoff>(at));
            file << std::string(figure.find(')', at) + 1 - at, ' ');
        }
    }
    file.close();
    if (!file) throw OutputError(fmt::format("cannot write '{}'", path));
}

}  // namespace

bool figureIsComplete(const std::string& path) {
    std::string end = endOf(path);
    if (end.ends_with(std::string_view("\0\0\0\0IEND\xae\x42\x60\x82", 12))) return true;
    end.erase(end.find_last_not_of(" \r\n") + 1);
    return end.ends_with("</svg>") || end.ends_with("%%EOF");
}

void runGnuplot(const std::string& folder, const std::vector<std::string>& arguments,
                const std::vector<std::string>& outputs) {
    const Scratch complaints = scratch();
    Actions actions;
    ::posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    ::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    ::posix_spawn_file_actions_adddup2(&actions, ::fileno(complaints.get()), STDERR_FILENO);
    ::posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
    std::vector<std::string> words{"gnuplot", "-d"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    const int status = statusOf(std::move(words), actions);
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
        fail("gnuplot failed: " + lastWords(contentOf(complaints.get())));
    }
    if (std::ranges::all_of(outputs, figureIsComplete)) {
        for (const std::string& output : outputs) removeDates(output);
        return;
    }
    const std::string said = lastWords(contentOf(complaints.get()));
    throw OutputError(fmt::format("a figure was cut short, as on a full disk{}{}",
                                  said.empty() ? "" : ": ", said));
}

std::string gnuplotString(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < ' ' || byte == 0x7f || std::strchr("'\"`\\", c))
            out += fmt::format("\\{:03o}", byte);
        else
            out += c;
    }
    return out + '"';
}

std::string unenhanced(const std::string& text) {
    std::string out;
    for (const char c : text) {
        if (std::string_view("^_{}@&~\\").find(c) != std::string_view::npos) out += '\\';
        out += c;
    }
    return out;
}

std::string gnuplotFile(const std::string& name, const AtomicFile& file) {
    const auto path = std::filesystem::absolute(file.temporaryPath()).string();
    return fmt::format("{}={}; ", name, gnuplotString(path));
}

}  // namespace hshfit::inline pages
