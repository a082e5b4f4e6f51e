#include "store.h"

#include <hshfit/error.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/files/printable.h>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>

namespace hshfit::jobs {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

constexpr const char* recordFormat = "hshfit-batch-item";
constexpr double mostBytes = 9e15;

[[noreturn]] void failToWrite(const fs::path& path, int error) {
    throw OutputError(fmt::format("{}: {}", path.string(), std::strerror(error)));
}

InputStamp stampFromJson(const JsonFields& fields) {
    return {.path = fields.word("path"),
            .bytes = static_cast<std::uint64_t>(fields.number("bytes", 0, mostBytes)),
            .modified = std::stoll(fields.word("modified")),
            .changed = std::stoll(fields.word("changed")),
            .sha256 = fields.word("sha256")};
}

/// The lock is of the process that has it open, and goes with it.
int openLocked(const fs::path& path) {
    const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (file < 0) failToWrite(path, errno);
    if (::flock(file, LOCK_EX | LOCK_NB) == 0) return file;
    ::close(file);
    return -1;
}

std::string processName() {
    std::array<char, 256> host{};
    ::gethostname(host.data(), host.size() - 1);
    timespec now{};
    ::clock_gettime(CLOCK_REALTIME, &now);
    // Process numbers and even host names come again; the time does not.
    return fmt::format("{}-{}-{:x}", host.data(), ::getpid(),
                       static_cast<std::uint64_t>(now.tv_sec) * 1'000'000'000ULL +
                           static_cast<std::uint64_t>(now.tv_nsec));
}

}  // namespace

Json recordJson(const ItemRecord& record) {
    Json inputs = Json::array(), outputs = Json::array();
    for (const InputStamp& input : record.inputs)
        inputs.push_back({{"path", input.path},
                          {"bytes", input.bytes},
                          {"modified", std::to_string(input.modified)},
                          {"changed", std::to_string(input.changed)},
                          {"sha256", input.sha256}});
    for (const auto& [path, bytes] : record.outputs)
        outputs.push_back({{"path", path}, {"bytes", bytes}});
    return {{"format", recordFormat},
            {"version", 1},
            {"name", record.name},
            {"words", record.words},
            {"key", record.key},
            {"exit_code", record.exitCode},
            {"signal", record.signal},
            {"message", record.message},
            {"seconds", record.seconds},
            {"cpu_seconds", record.cpuSeconds},
            {"peak_bytes", record.peakBytes},
            {"inputs", inputs},
            {"outputs", outputs}};
}

ItemRecord recordFromJson(const nlohmann::json& json, const std::string& file) {
    const JsonFields fields(json, "", file);
    if (fields.word("format") != recordFormat) fields.fail("no record of a batch", "format");
    ItemRecord record{
        .name = fields.word("name"),
        .words = fields.words("words"),
        .key = fields.word("key"),
        .exitCode = fields.integer("exit_code", 0, 255),
        .signal = fields.integer("signal", 0, 255),
        .message = fields.word("message"),
        .seconds = fields.number("seconds"),
        .cpuSeconds = fields.number("cpu_seconds"),
        .peakBytes = static_cast<std::uint64_t>(fields.number("peak_bytes", 0, mostBytes))};
    for (const JsonFields& input : fields.objects("inputs"))
        record.inputs.push_back(stampFromJson(input));
    for (const JsonFields& output : fields.objects("outputs"))
        record.outputs[output.word("path")] =
            static_cast<std::uint64_t>(output.number("bytes", 0, mostBytes));
    return record;
}

std::optional<ItemRecord> BatchStore::read(const std::string& name) const {
    const fs::path path = place(name) / "record.json";
    std::ifstream file(path, std::ios::binary);
    if (!file) return {};
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    try {
        constexpr int deepest = 8;
        return recordFromJson(parseJson(text, path.string(), deepest), path.string());
    } catch (const InputError&) {
        return {};
    } catch (const std::logic_error&) {  // a time that is no number
        return {};
    }
}

bool BatchStore::isWhole(const ItemRecord& record) const {
    std::error_code error;
    for (const auto& [path, bytes] : record.outputs)
        if (fs::file_size(place(record.name) / path, error) != bytes || error) return false;
    return true;
}

StoreWriter::StoreWriter(const BatchStore& store) : store_(store) {
    std::error_code error;
    for (const char* name : {"items", "running"}) {
        const fs::path path = store.folder() / name;
        fs::create_directories(path, error);
        if (error) failToWrite(path, error.value());
    }
    // Another process may take the file for one of an ended process before it is locked.
    struct stat facts {};
    constexpr int attempts = 100;
    for (int attempt = 0; lock_ < 0 && attempt < attempts; ++attempt) {
        id_ = processName();
        lock_ = openLocked(store.folder() / "running" / id_);
        if (lock_ >= 0 && ::fstat(lock_, &facts) == 0 && facts.st_nlink == 0) {
            ::close(lock_);
            lock_ = -1;
        }
    }
    removeLeftovers();
}

StoreWriter::~StoreWriter() {
    std::error_code ignored;
    fs::remove(store_.folder() / "running" / id_, ignored);
    if (lock_ >= 0) ::close(lock_);
}

fs::path StoreWriter::part(const std::string& name) const {
    return store_.folder() / "items" / fmt::format(".{}.{}", name, id_);
}

void StoreWriter::removeLeftovers() const {
    std::error_code error;
    std::vector<std::string> ended;
    const fs::path running = store_.folder() / "running";
    for (const auto& entry : fs::directory_iterator(running, error)) {
        const std::string name = entry.path().filename().string();
        if (name == id_) continue;
        const int lock = openLocked(entry.path());
        if (lock < 0) continue;
        ended.push_back(name);
        ::close(lock);
    }
    if (ended.empty()) return;
    for (const auto& entry : fs::directory_iterator(store_.folder() / "items", error)) {
        const std::string name = entry.path().filename().string();
        if (!name.starts_with('.')) continue;
        for (const std::string& id : ended)
            if (name.ends_with("." + id)) fs::remove_all(entry.path(), error);
    }
    for (const std::string& id : ended) fs::remove(running / id, error);
}

void publish(const fs::path& part, const fs::path& place) {
    if (::rename(part.c_str(), place.c_str()) == 0) return;
    if (errno != ENOTEMPTY && errno != EEXIST) failToWrite(place, errno);
    // The two exchange their names, so that one of them is in place at any moment. Some network
    // file systems cannot: the earlier result is then taken away first.
    if (::renameat2(AT_FDCWD, part.c_str(), AT_FDCWD, place.c_str(), RENAME_EXCHANGE) != 0) {
        const fs::path aside = part.string() + ".old";
        if (::rename(place.c_str(), aside.c_str()) != 0 ||
            ::rename(part.c_str(), place.c_str()) != 0)
            failToWrite(place, errno);
        ::rename(aside.c_str(), part.c_str());
    }
    std::error_code ignored;
    fs::remove_all(part, ignored);
}

}  // namespace hshfit::jobs
