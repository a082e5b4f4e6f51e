#pragma once

#include <hshfit/files/atomic_file.h>

#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::inline files {

/// Files that appear together or not at all, most of them in one folder.
///
/// Each is an AtomicFile; commit() first completes all of them, where a full disk shows, and then
/// renames them. Should a rename fail, the renames before it are taken back: new files are removed,
/// and earlier files return from hard links made beforehand (where the file system has them). The
/// signals of removeTemporariesOnSignals wait until all are renamed; a SIGKILL between two renames
/// leaves the set incomplete, but none of its files.
///
/// Every member but the destructor throws OutputError, which names the file. Files may be added
/// from several threads at once.
class FileSet {
public:
    enum class Above { make, require };

    /// Makes the folder if absent, and the folders above it unless they are required to stand. They
    /// go again if nothing is committed. Without `force`, a file that stands is refused; with it,
    /// the rule of the process decides (OutputRule).
    FileSet(std::filesystem::path folder, bool force, Above above = Above::make);
    ~FileSet();
    FileSet(const FileSet&) = delete;
    FileSet& operator=(const FileSet&) = delete;

    const std::filesystem::path& folder() const { return folder_; }

    /// Throws what `add` throws for a file of that name, before long work is done for nothing.
    void requireFree(const std::string& name) const;
    /// A file of that name in the folder, or anywhere for an absolute path, to be written to; not
    /// to be committed by itself. Throws OutputError for a name that was added before.
    AtomicFile& add(const std::string& name);
    /// Adds a file of this text and closes it, which leaves it under its temporary name.
    const AtomicFile& write(const std::string& name, std::string_view text);
    /// The same with a function that writes it. Where it throws, the set is without that file.
    const AtomicFile& write(const std::string& name, const std::function<void(AtomicFile&)>& fill);
    /// The same for one of very many files: the other files name it, but it states no key itself.
    void writePart(const std::string& name, std::string_view text);
    /// Leaves the checksum of this file, if the set has it, out of the statements of the set. For a
    /// file whose bytes differ from run to run, as times do: files that state its checksum would
    /// differ too.
    void leaveUnchecked(const std::string& name);
    /// commit() then also removes what stands in the folder from the set that this one replaces:
    /// files that the statement of a replaced file names and that this set does not have.
    void removeOthers() { removesOthers_ = true; }
    /// Takes a file out of the set again.
    void remove(const std::string& name);

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
        bool part = false;       ///< states nothing
        bool unchecked = false;  ///< no file states a sum of it
    };
    std::filesystem::path placeOf(const std::string& name) const;
    static void keepWhatStands(Member& member);
    void stateKeys();
    std::vector<std::filesystem::path> others() const;
    void takeBack() noexcept;

    std::filesystem::path folder_;
    bool force_;
    bool removesOthers_ = false;
    std::string key_ = OutputKey::current();
    std::vector<std::filesystem::path> made_;  ///< folders, the outermost first
    std::deque<Trace> madeTraces_;
    std::mutex mutex_;  ///< of members_
    std::vector<std::unique_ptr<Member>> members_;
};

}  // namespace hshfit::inline files
