#pragma once

#include <hshfit/files/atomic_file.h>

#include <deque>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::inline files {

/// Files of one folder that appear together or not at all.
///
/// Each is an AtomicFile; commit() first completes all of them, where a full disk shows, and then
/// renames them. Should a rename fail, those before it are taken back: new files are removed, and
/// earlier files return from hard links made beforehand (where the file system has them). A signal
/// between two renames leaves the set incomplete.
///
/// Every member but the destructor throws OutputError, which names the file.
class FileSet {
public:
    /// Makes the folder, and those above it, if absent; they go again if nothing is committed.
    /// Without `force`, a file that stands is refused.
    FileSet(std::filesystem::path folder, bool force);
    ~FileSet();
    FileSet(const FileSet&) = delete;
    FileSet& operator=(const FileSet&) = delete;

    const std::filesystem::path& folder() const { return folder_; }

    /// A file of that name, to be written to; not to be committed by itself. Throws OutputError for
    /// a name that was added before.
    AtomicFile& add(const std::string& name);
    void write(const std::string& name, std::string_view text) { add(name).write(text); }

    void commit();

private:
    struct Member {
        Member(const std::filesystem::path& place, AtomicFile::Existing existing)
            : path(place), file(place.string(), existing) {}
        std::filesystem::path path;
        AtomicFile file;
        std::string before;  ///< a link to what stood there
        bool stood = false;  ///< something stood there
        bool placed = false;
    };
    static void keepWhatStands(Member& member);
    void takeBack() noexcept;

    std::filesystem::path folder_;
    bool force_;
    std::vector<std::filesystem::path> made_;  ///< folders, the outermost first
    std::deque<Member> members_;
};

}  // namespace hshfit::inline files
