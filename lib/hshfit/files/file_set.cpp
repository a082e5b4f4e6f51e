#include <hshfit/error.h>
#include <hshfit/files/extension.h>
#include <hshfit/files/file_set.h>
#include <hshfit/files/made_from.h>
#include <hshfit/wording.h>

#include <algorithm>
#include <atomic>
#include <system_error>

#include <fmt/format.h>
#include <unistd.h>

namespace hshfit::inline files {

namespace fs = std::filesystem;

FileSet::FileSet(fs::path folder, bool force, Above above)
    : folder_(std::move(folder)), force_(force) {
    if (!folder_.has_filename()) folder_ = folder_.parent_path();  // without a slash at the end
    if (folder_.empty()) folder_ = ".";
    std::error_code error;
    for (fs::path at = folder_; !at.empty() && !fs::exists(at, error); at = at.parent_path()) {
        made_.insert(made_.begin(), at);
    }
    if (above == Above::require && made_.size() > 1) {
        throw OutputError(fmt::format("cannot make the folder '{}': there is no folder '{}'",
                                      folder_.string(), folder_.parent_path().string()));
    }
    {
        const Uninterrupted step;
        fs::create_directories(folder_, error);
        for (const fs::path& path : made_) madeTraces_.emplace_back().folder(path.string());
    }
    if (!error && fs::is_directory(folder_)) return;
    takeBack();
    throw OutputError(fmt::format("cannot make the folder '{}': {}", folder_.string(),
                                  error ? error.message() : "a file stands there"));
}

FileSet::~FileSet() {
    members_.clear();
    takeBack();
}

fs::path FileSet::placeOf(const std::string& name) const {
    return folder_ == "." ? fs::path(name) : folder_ / name;
}

void FileSet::requireFree(const std::string& name) const {
    const fs::path path = placeOf(name);
    std::error_code error;
    if (!force_ && fs::exists(path, error)) {
        throw OutputError(fmt::format("'{}' exists; nothing is written without {}", path.string(),
                                      Setting{"FileSet::force"}));
    }
}

AtomicFile& FileSet::add(const std::string& name) {
    const fs::path path = placeOf(name);
    const std::lock_guard lock(mutex_);
    if (std::ranges::any_of(members_, [&](const auto& member) { return member->path == path; })) {
        throw OutputError(fmt::format("'{}' would be written twice", path.string()));
    }
    requireFree(name);
    members_.push_back(std::make_unique<Member>(
        path, force_ ? AtomicFile::Existing::replace : AtomicFile::Existing::refuse));
    return members_.back()->file;
}

const AtomicFile& FileSet::write(const std::string& name, std::string_view text) {
    return write(name, [&](AtomicFile& file) { file.write(text); });
}

const AtomicFile& FileSet::write(const std::string& name,
                                 const std::function<void(AtomicFile&)>& fill) {
    AtomicFile& file = add(name);
    try {
        fill(file);
        file.finish();
        return file;
    } catch (...) {
        remove(name);
        throw;
    }
}

void FileSet::writePart(const std::string& name, std::string_view text) {
    write(name, text);
    const std::lock_guard lock(mutex_);
    const auto member =
        std::ranges::find(members_, placeOf(name), [](const auto& m) { return m->path; });
    (*member)->part = true;
}

void FileSet::leaveUnchecked(const std::string& name) {
    const fs::path path = placeOf(name);
    const std::lock_guard lock(mutex_);
    for (const auto& member : members_) {
        if (member->path == path) member->unchecked = true;
    }
}

void FileSet::remove(const std::string& name) {
    const fs::path path = placeOf(name);
    const std::lock_guard lock(mutex_);
    std::erase_if(members_, [&](const auto& member) { return member->path == path; });
}

void FileSet::keepWhatStands(Member& member) {
    static std::atomic<unsigned> counter{0};
    std::error_code error;
    const fs::path target = member.file.target();
    member.stood = fs::exists(target, error);
    if (!fs::is_regular_file(target, error)) return;
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
    for (const auto& member : members_) {
        if (!member->before.empty()) {
            if (member->placed) fs::rename(member->before, member->file.target(), error);
            fs::remove(member->before, error);
        } else if (member->placed && !member->stood) {
            fs::remove(member->file.target(), error);
        }
    }
    members_.clear();
    // Only empty folders: one that somebody else has put a file into stays.
    for (auto at = made_.rbegin(); at != made_.rend(); ++at) ::rmdir(at->c_str());
    made_.clear();
    madeTraces_.clear();
}

/// The JSON files of a set state its key and name the others; pictures do where there is no JSON,
/// since JSON may hold their checksums. A file with a key of its own stands for itself.
void FileSet::stateKeys() {
    const auto isJson = [](const auto& member) {
        return extensionOf(member->path.string()) == ".json" && !member->part;
    };
    const bool anyJson = std::ranges::any_of(members_, isJson);
    const auto states = [&](const auto& member) {
        return !member->part && canStateMadeFrom(member->path.string()) &&
               (!anyJson || isJson(member));
    };
    std::vector<std::string> names, sums;
    for (const auto& member : members_) {
        if (key_.empty() || member->file.key() != key_) continue;
        names.push_back(member->path.lexically_relative(folder_).string());
        sums.push_back(states(member) || member->unchecked
                           ? std::string()
                           : sumOfPart(member->file.temporaryPath()));
    }
    for (const auto& member : members_) {
        if (member->file.key() != key_)
            member->file.state({});
        else if (!states(member))
            member->file.leaveUnstated();
        else
            member->file.state(names, sums);
    }
}

/// Members of the sets that these files replace.
std::vector<fs::path> FileSet::others() const {
    std::vector<fs::path> result;
    std::error_code error;
    for (const auto& member : members_) {
        const auto made = madeFromOf(member->file.target());
        if (!made) continue;
        for (const std::string& name : made->files) {
            const fs::path path = placeOf(name);
            if (fs::path(name).has_parent_path() || !fs::is_regular_file(path, error)) continue;
            if (std::ranges::none_of(members_, [&](const auto& m) { return m->path == path; }))
                result.push_back(path);
        }
    }
    return result;
}

void FileSet::commit() {
    if (members_.empty()) return takeBack();
    for (const auto& member : members_) member->file.finish();
    stateKeys();
    for (const auto& member : members_) member->file.requirePlace();
    const std::vector<fs::path> replaced = removesOthers_ ? others() : std::vector<fs::path>{};
    const Uninterrupted renames;
    try {
        for (const auto& member : members_) {
            if (force_) keepWhatStands(*member);
            member->file.commit();
            member->placed = true;
        }
    } catch (...) {
        takeBack();
        throw;
    }
    std::error_code error;
    for (const auto& member : members_) {
        if (!member->before.empty()) fs::remove(member->before, error);
    }
    for (const fs::path& path : replaced) fs::remove(path, error);
    members_.clear();
    made_.clear();
    madeTraces_.clear();
}

}  // namespace hshfit::inline files
