#pragma once

#include <string>
#include <vector>

namespace hshfit::inline files {

/// The treatment of files that exist where AtomicFile writes, and the key that new ones state.
/// Like the mask of permissions (umask) it belongs to the process: a program states it once, before
/// its work.
struct OutputRule {
    /// Whether an existing file is replaced. False: it is kept if it has the bytes that would be
    /// written, replaced if it states the same key, else refused with OutputError. The default
    /// suits use as a library.
    bool replace = true;
    std::string command = {};  ///< that writes
    /// Options and version, without the inputs; empty: files say nothing.
    std::string facts = {};
    /// A checksum of inputs, options and version, for files that have a place for it (made_from.h).
    std::string key = {};
};

/// The rule in use, and another in its place; not while files are written.
const OutputRule& outputRule();
void setOutputRule(OutputRule rule);

/// The exit code with which the command is going to end, where that is known before its files are
/// complete; a new rule begins with 0.
void stateExitCode(int code);
int statedExitCode();

/// Files that were found to stand with the bytes that would have been written, since the last call;
/// from any thread.
std::vector<std::string> takeKeptFiles();
void addKeptFile(std::string path);

/// While it lives, AtomicFiles that this thread makes have this key instead of the rule's.
class OutputKey {
public:
    explicit OutputKey(std::string key);
    ~OutputKey();
    OutputKey(const OutputKey&) = delete;
    OutputKey& operator=(const OutputKey&) = delete;

    /// The key for a file that is made now by this thread; empty: none.
    static std::string current();

private:
    std::string key_;
    const std::string* before_;
};

}  // namespace hshfit::inline files
