#include <hshfit/files/interruption.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <new>

#include <sys/wait.h>
#include <unistd.h>

namespace hshfit::inline files {

/// An element of a list that only grows, so that a signal handler can walk it. The function that
/// swaps a value out of its slot owns it: the handler unlinks and never frees, `release` frees.
struct Trace::Slot {
    std::atomic<bool> taken{true};
    std::atomic<char*> file{nullptr}, folder{nullptr};
    std::atomic<pid_t> child{0};
    Slot* next = nullptr;
};

namespace {

static_assert(std::atomic<char*>::is_always_lock_free && std::atomic<pid_t>::is_always_lock_free);

std::atomic<void*> slots{nullptr};
std::atomic<int> inside{0};  ///< threads within an Uninterrupted
std::atomic<bool> ending{false};
thread_local int depth = 0;

constexpr int endings[] = {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE};

void sleepOneMillisecond() noexcept {
    timespec pause{0, 1'000'000};
    ::nanosleep(&pause, nullptr);
}

}  // namespace

/// Safe within a signal handler.
void removeTraces() noexcept {
    auto* const first = static_cast<Trace::Slot*>(slots.load());
    for (auto* slot = first; slot; slot = slot->next) {
        const pid_t child = slot->child.exchange(0);
        if (child <= 0) continue;
        ::kill(-child, SIGKILL);
        while (::waitpid(child, nullptr, 0) < 0 && errno == EINTR) continue;
    }
    for (auto* slot = first; slot; slot = slot->next) {
        if (const char* path = slot->file.exchange(nullptr)) ::unlink(path);
    }
    // A folder within a folder goes first, wherever the two are in the list.
    for (bool removed = true; removed;) {
        removed = false;
        for (auto* slot = first; slot; slot = slot->next) {
            char* path = slot->folder.exchange(nullptr);
            if (path && ::rmdir(path) == 0)
                removed = true;
            else
                slot->folder.exchange(path);
        }
    }
}

static void endAndRemoveTraces() noexcept {
    ending = true;
    constexpr int longest = 5000;
    for (int waited = 0; inside > 0 && waited < longest; ++waited) sleepOneMillisecond();
    removeTraces();
}

void removeTracesAndExit(int code) noexcept {
    endAndRemoveTraces();
    ::_exit(code);
}

extern "C" {
static void removeTracesAndDie(int signal) {
    const int error = errno;
    endAndRemoveTraces();
    errno = error;
    // The default action runs once this handler returns and the signal is no longer blocked.
    std::signal(signal, SIG_DFL);
    ::raise(signal);
}
}

void removeTemporariesOnSignals() {
    struct sigaction action {};
    action.sa_handler = removeTracesAndDie;
    sigemptyset(&action.sa_mask);
    for (const int signal : endings) sigaddset(&action.sa_mask, signal);
    for (const int signal : endings) {
        struct sigaction previous {};
        // A signal that the parent ignores (nohup) stays ignored.
        if (::sigaction(signal, nullptr, &previous) == 0 && previous.sa_handler == SIG_IGN) {
            continue;
        }
        ::sigaction(signal, &action, nullptr);
    }
    std::signal(SIGXFSZ, SIG_IGN);
}

Uninterrupted::Uninterrupted() noexcept {
    sigset_t blocked;
    sigemptyset(&blocked);
    for (const int signal : endings) sigaddset(&blocked, signal);
    ::pthread_sigmask(SIG_BLOCK, &blocked, &before_);
    if (depth++ > 0) return;
    ++inside;
    if (!ending) return;
    // Another thread is ending the process: nothing may begin any more.
    --inside;
    for (;;) sleepOneMillisecond();
}

Uninterrupted::~Uninterrupted() {
    if (--depth == 0) --inside;
    ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

void Trace::keep(const std::string& path, pid_t child) {
    release();
    char* copy = nullptr;
    if (child <= 0 && !(copy = ::strdup(path.c_str()))) throw std::bad_alloc();
    for (auto* slot = static_cast<Slot*>(slots.load()); slot && !slot_; slot = slot->next) {
        if (!slot->taken.exchange(true)) slot_ = slot;
    }
    if (!slot_) {
        slot_ = new Slot;
        void* first = slots.load();
        do {
            slot_->next = static_cast<Slot*>(first);
        } while (!slots.compare_exchange_weak(first, slot_));
    }
    if (child > 0)
        slot_->child = child;
    else
        (child == 0 ? slot_->file : slot_->folder) = copy;
}

void Trace::release() noexcept {
    if (!slot_) return;
    slot_->child = 0;
    std::free(slot_->file.exchange(nullptr));
    std::free(slot_->folder.exchange(nullptr));
    slot_->taken = false;
    slot_ = nullptr;
}

}  // namespace hshfit::inline files
