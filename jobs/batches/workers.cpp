#include "workers.h"

#include <hshfit/error.h>

#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <string_view>

namespace hshfit::jobs {

namespace {

/// A process that died of a signal replies with this and the signal's number.
constexpr std::string_view death = "!";

[[noreturn]] void failToStart() {
    throw OutputError(fmt::format("a process of the batch: {}", std::strerror(errno)));
}

bool writeLine(int socket, std::string text) {
    text += '\n';
    for (std::string_view rest = text; !rest.empty();) {
        // A worker that has gone is noticed by its reply, not by a signal.
        const ssize_t n = ::send(socket, rest.data(), rest.size(), MSG_NOSIGNAL);
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) return false;
        rest.remove_prefix(static_cast<std::size_t>(n));
    }
    return true;
}

/// Appends what has come; false at the end of the stream.
bool receive(int socket, std::string& text) {
    char buffer[1 << 16];
    ssize_t n = 0;
    do {
        n = ::recv(socket, buffer, sizeof buffer, 0);
    } while (n < 0 && errno == EINTR);
    if (n <= 0) return false;
    text.append(buffer, static_cast<std::size_t>(n));
    return true;
}

/// The first line of `text`, taken out of it; false if there is none yet.
bool takeLine(std::string& text, std::string& line) {
    const std::size_t end = text.find('\n');
    if (end == std::string::npos) return false;
    line = text.substr(0, end);
    text.erase(0, end + 1);
    return true;
}

/// The process dies with its parent, however that ends.
void dieWith(pid_t parent) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) ::_exit(0);
}

[[noreturn]] void answerOrders(int socket, std::size_t memory,
                               const std::function<std::string(const std::string&)>& work) {
    if (memory > 0) {
        const rlimit limit{memory, memory};
        ::setrlimit(RLIMIT_DATA, &limit);
    }
    std::string text, order;
    for (;;) {
        while (!takeLine(text, order))
            if (!receive(socket, text)) ::_exit(0);
        if (!writeLine(socket, work(order))) ::_exit(0);
    }
}

/// Keeps one process at the orders, and replies for those that die. It has no threads itself, so
/// that it can fork at any time.
[[noreturn]] void supervise(int socket, std::size_t memory,
                            const std::function<std::string(const std::string&)>& work) {
    for (;;) {
        const pid_t self = ::getpid(), child = ::fork();
        if (child < 0) ::_exit(1);
        if (child == 0) {
            dieWith(self);
            answerOrders(socket, memory, work);
        }
        int status = 0;
        while (::waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
        if (WIFEXITED(status) && WEXITSTATUS(status) == 0) ::_exit(0);
        const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
        if (!writeLine(socket, fmt::format("{}{}", death, signal))) ::_exit(0);
    }
}

}  // namespace

Workers::Workers(std::size_t count, std::size_t memory,
                 const std::function<std::string(const std::string&)>& work) {
    std::fflush(nullptr);
    for (std::size_t i = 0; i < count; ++i) {
        int ends[2];
        if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) failToStart();
        const pid_t self = ::getpid(), process = ::fork();
        if (process < 0) failToStart();
        if (process == 0) {
            dieWith(self);
            ::close(ends[0]);
            for (const Worker& other : workers_) ::close(other.socket);
            supervise(ends[1], memory, work);
        }
        ::close(ends[1]);
        workers_.push_back({process, ends[0]});
    }
}

Workers::~Workers() {
    for (const Worker& worker : workers_) {
        ::kill(worker.process, SIGKILL);
        ::close(worker.socket);
    }
    for (const Worker& worker : workers_)
        while (::waitpid(worker.process, nullptr, 0) < 0 && errno == EINTR) continue;
}

void Workers::send(std::size_t worker, const std::string& order) {
    if (!writeLine(workers_[worker].socket, order)) failToStart();
}

Workers::Reply Workers::wait() {
    std::vector<pollfd> sockets;
    for (const Worker& worker : workers_) sockets.push_back({worker.socket, POLLIN, 0});
    for (;;) {
        std::string line;
        for (std::size_t i = 0; i < workers_.size(); ++i) {
            if (!takeLine(workers_[i].received, line)) continue;
            if (!line.starts_with(death)) return {i, line};
            return {i, {}, std::stoi(line.substr(death.size()))};
        }
        if (::poll(sockets.data(), sockets.size(), -1) < 0) {
            if (errno == EINTR) continue;
            failToStart();
        }
        for (std::size_t i = 0; i < sockets.size(); ++i)
            if (sockets[i].revents != 0 && !receive(sockets[i].fd, workers_[i].received))
                throw OutputError("a process of the batch ended, and none could take its place");
    }
}

}  // namespace hshfit::jobs
