#include "item_key.h"

#include <jobs/common/named_files.h>
#include "manifest.h"
#include "program.h"

#include <hshfit/error.h>
#include <hshfit/files/checksum.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/files/mapped_file.h>

#include <fmt/format.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <set>

namespace hshfit::jobs {

namespace fs = std::filesystem;

namespace {

std::int64_t nanoseconds(const timespec& time) {
    return static_cast<std::int64_t>(time.tv_sec) * 1'000'000'000 + time.tv_nsec;
}

bool haveSameTimes(const InputStamp& a, const InputStamp& b) {
    return a.bytes == b.bytes && a.modified == b.modified && a.changed == b.changed;
}

void addFiles(const nlohmann::json& value, std::set<std::string>& files) {
    if (value.is_string())
        addNamedFiles(value.get_ref<const std::string&>(), files);
    else if (value.is_structured())
        for (const auto& each : value) addFiles(each, files);
}

}  // namespace

InputStamp FileSums::stamp(const std::string& path, const std::vector<InputStamp>& known) {
    struct stat facts {};
    if (::stat(path.c_str(), &facts) != 0)
        throw InputError(fmt::format("{}: {}", path, std::strerror(errno)));
    InputStamp now{.path = path,
                   .bytes = static_cast<std::uint64_t>(facts.st_size),
                   .modified = nanoseconds(facts.st_mtim),
                   .changed = nanoseconds(facts.st_ctim),
                   .sha256 = {}};
    for (const InputStamp& earlier : known)
        if (earlier.path == path && haveSameTimes(earlier, now)) return earlier;
    {
        const std::lock_guard lock(mutex_);
        const auto found = stamps_.find(path);
        if (found != stamps_.end() && haveSameTimes(found->second, now)) return found->second;
    }
    if (now.bytes == 0) {
        now.sha256 = sha256(std::string_view());
    } else {
        const MappedFile file(path);
        now.sha256 = sha256(std::as_bytes(file.bytes()));
        file.checkIntact();
    }
    const std::lock_guard lock(mutex_);
    return stamps_[path] = now;
}

std::vector<std::string> filesOf(const BatchItem& item, const BatchProgram& program) {
    std::set<std::string> files;
    for (const std::string& input : item.inputs) addNamedFiles(input, files);
    for (const auto& [key, value] : item.options->items())
        if (!program.writes(program.commands[item.command], key)) addFiles(value, files);
    return {files.begin(), files.end()};
}

std::string itemKey(const BatchProgram& program, const std::vector<std::string>& words,
                    const std::vector<InputStamp>& inputs) {
    nlohmann::ordered_json facts = {{"version", program.version}, {"words", words}};
    for (const InputStamp& input : inputs) facts["files"][input.path] = input.sha256;
    return sha256(jsonText(facts));
}

ItemState stateOf(const BatchItem& item, const BatchProgram& program, FileSums& sums,
                  const std::optional<ItemRecord>& earlier) {
    ItemState state;
    state.words = program.words(item, {});
    for (const std::string& file : filesOf(item, program))
        state.inputs.push_back(
            sums.stamp(file, earlier ? earlier->inputs : std::vector<InputStamp>{}));
    state.key = itemKey(program, state.words, state.inputs);
    return state;
}

}  // namespace hshfit::jobs
