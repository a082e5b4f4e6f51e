#pragma once

// The traces of a process that a signal has to clear away: temporaries, empty folders, children.

#include <csignal>
#include <string>

#include <sys/types.h>

namespace hshfit::inline files {

/// Makes SIGINT, SIGTERM, SIGHUP, SIGQUIT and SIGPIPE end the children and remove the temporaries
/// of the process before they end it, and a file-size limit a write error instead of a signal. For
/// `main` to call once.
void removeTemporariesOnSignals();

/// Ends the children, removes the temporaries, and ends the process without a signal.
[[noreturn]] void removeTracesAndExit(int code) noexcept;

/// While one lives, those signals wait: a step that leaves no trace half-registered, and no set of
/// files half-renamed, stands within one. To be short; such a signal waits 5 s at most.
class Uninterrupted {
public:
    Uninterrupted() noexcept;
    ~Uninterrupted();
    Uninterrupted(const Uninterrupted&) = delete;
    Uninterrupted& operator=(const Uninterrupted&) = delete;

    /// The signals that were blocked before, for a child to begin with.
    const sigset_t& signalsBefore() const { return before_; }

private:
    sigset_t before_;
};

/// A file, a folder that is empty by then, or a child with its process group, which signals remove
/// until this is released or destroyed. To be made and released within an Uninterrupted.
class Trace {
public:
    Trace() = default;
    ~Trace() { release(); }
    Trace(const Trace&) = delete;
    Trace& operator=(const Trace&) = delete;

    void file(const std::string& path) { keep(path, 0); }
    void folder(const std::string& path) { keep(path, -1); }
    void child(pid_t group) { keep({}, group); }
    void release() noexcept;

private:
    void keep(const std::string& path, pid_t child);
    struct Slot;
    friend void removeTraces() noexcept;
    Slot* slot_ = nullptr;
};

}  // namespace hshfit::inline files
