#pragma once

#include <hshfit/files/interruption.h>
#include <hshfit/files/output_rule.h>

#include <cstddef>
#include <cstdio>
#include <span>
#include <string>
#include <string_view>
#include <vector>

struct stat;

namespace hshfit::inline files {

/// A file that appears under its name only once it is complete.
///
/// The bytes go to a temporary name in the same folder; commit() renames it. Without a commit the
/// destructor removes the temporary, and an earlier file at `path` stays as it was. A symbolic link
/// is followed, also to a name where nothing stands; a device or a pipe (/dev/stdout, /dev/null) is
/// written to directly. New files get the permissions 0666 less the umask; a file that replaces
/// another has the other's permissions, and its owner where the system allows it. The file is not
/// synced to the disk: a power cut may lose it.
///
/// A rule of the process that refuses (OutputRule) holds for `replace` and `refuse` alike: a file
/// that stands is kept if it has the same bytes, replaced if it states the same key, else refused.
///
/// Every member but the destructor throws OutputError, with the path and the system's reason.
class AtomicFile {
public:
    /// `always`: replaced whatever the rule, for files that go on from run to run.
    enum class Existing { replace, refuse, always };

    explicit AtomicFile(std::string path, Existing existing = Existing::replace);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    void write(std::string_view text);
    void write(std::span<const std::byte> bytes);

    /// The open stream, for writers that seek. Close it only through commit().
    std::FILE* stream() { return stream_; }
    /// The name for another program to write to before commit(); `path` itself for a device.
    const std::string& temporaryPath() const { return temporary_; }
    /// The path as it was given.
    const std::string& path() const { return path_; }
    /// The place of the file: `path` with its links resolved.
    const std::string& target() const { return target_; }

    /// Flushes and closes: every byte is in the temporary, or this throws. Only the members below
    /// may follow.
    void finish();
    /// The key that the file would state.
    const std::string& key() const { return key_; }
    /// finish(), and the statement of the key with the `files` written beside this one and their
    /// `sums`, where there is a key and a place for it; once.
    void state(const std::vector<std::string>& files, const std::vector<std::string>& sums = {});
    /// From now on the file has no key, so that state() only finishes it.
    void leaveUnstated() { key_.clear(); }
    /// finish(), and the rule: throws for a file that stands and is not to be replaced.
    void requirePlace();
    /// finish(), state() and requirePlace(), unless they were called, and the rename.
    void commit();

private:
    [[noreturn]] void fail(int error) const;
    void openTemporary(const struct stat* replaced);
    int move();
    void discard() noexcept;

    std::string path_;       ///< as given, for messages
    std::string target_;     ///< links resolved
    std::string temporary_;  ///< target_ itself when it is written directly
    Existing existing_;
    std::FILE* stream_ = nullptr;
    Trace trace_;
    std::string key_ = OutputKey::current();
    bool finished_ = false, stated_ = false, standsAlready_ = false;
    bool isRuled_ = false;  ///< the rule of the process decides on what stands
};

/// Writes `text` to `path` through an AtomicFile.
void writeFile(const std::string& path, std::string_view text);

}  // namespace hshfit::inline files
