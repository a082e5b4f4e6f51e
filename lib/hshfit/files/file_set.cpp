#include <hshfit/error.h>
#include <hshfit/files/file_set.h>
#include <hshfit/wording.h>

#include <algorithm>
#include <atomic>
#include <system_error>

#include <fmt/format.h>
#include <unistd.h>

namespace hshfit::inline files {

namespace fs = std::filesystem;

FileSet::FileSet(fs::path folder, bool force) : folder_(std::move(folder)), force_(force) {
    if (folder_.empty()) folder_ = ".";
    std::error_code error;
    for (fs::path at = folder_; !at.empty() && !fs::exists(at, error); at = at.parent_path()) {
        made_.insert(made_.begin(), at);
    }
    fs::create_directories(folder_, error);
    if (!error && fs::is_directory(folder_)) return;
    takeBack();
    throw OutputError(fmt::format("cannot make the folder '{}': {}", folder_.string(),
                                  error ? error.message() : "a file stands there"));
}

FileSet::~FileSet() {
    members_.clear();
    takeBack();
}

AtomicFile& FileSet::add(const std::string& name) {
    const fs::path path = folder_ / name;
    if (std::any_of(members_.begin(), members_.end(),
                    [&](const Member& member) { return member.path == path; })) {
        throw OutputError(fmt::format("'{}' would be written twice", path.string()));
    }
    std::error_code error;
    if (!force_ && fs::exists(path, error)) {
        throw OutputError(fmt::format("'{}' exists; nothing is written without {}", path.string(),
                                      Setting{"FileSet::force"}));
    }
    members_.emplace_back(path,
                          force_ ? AtomicFile::Existing::replace : AtomicFile::Existing::refuse);
    return members_.back().file;
}

void FileSet::keepWhatStands(Member& member) {
    static std::atomic<unsigned> counter{0};
    std::error_code error;
    const fs::path target = fs::canonical(member.path, error);
    member.stood = !error;
    if (error || !fs::is_regular_file(target)) return;
    for (int attempt = 0; attempt < 1000; ++attempt) {
        const fs::path link =
            target.parent_path() / fmt::format(".hshfit-{}-{}.old", ::getpid(), counter++);
        fs::create_hard_link(target, link, error);
        if (!error) member.before = link.string();
        if (error != std::errc::file_exists) return;
    }
}

void FileSet::takeBack() noexcept {
    std::error_code error;
    for (Member& member : members_) {
        if (!member.before.empty()) {
            const fs::path target = fs::canonical(member.path, error);
            if (!error && member.placed) fs::rename(member.before, target, error);
            fs::remove(member.before, error);
        } else if (member.placed && !member.stood) {
            fs::remove(member.path, error);
        }
    }
    members_.clear();
    // Only empty folders: one that somebody else has put a file into stays.
    for (auto at = made_.rbegin(); at != made_.rend(); ++at) ::rmdir(at->c_str());
    made_.clear();
}

void FileSet::commit() {
    for (Member& member : members_) member.file.finish();
    try {
        for (Member& member : members_) {
            if (force_) keepWhatStands(member);
            member.file.commit();
            member.placed = true;
        }
    } catch (...) {
        takeBack();
        throw;
    }
    std::error_code error;
    for (Member& member : members_) {
        if (!member.before.empty()) fs::remove(member.before, error);
    }
    members_.clear();
    made_.clear();
}

}  // namespace hshfit::inline files
