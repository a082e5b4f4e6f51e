#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace hshfit::jobs {

/// The state of a file that an item was made from. Equal sizes and times stand for equal bytes, as
/// in git; where they differ, the bytes decide.
struct InputStamp {
    std::string path;
    std::uint64_t bytes = 0;
    std::int64_t modified = 0, changed = 0;  ///< nanoseconds since 1970
    std::string sha256;
};

/// record.json in an item's folder.
struct ItemRecord {
    std::string name = {};
    std::vector<std::string> words = {};  ///< the command line, with the name of the result
    std::string key = {};                 ///< SHA-256 of all that the result depends on (itemKey)
    int exitCode = 0;
    int signal = 0;  ///< that ended the process; 0: none
    std::string message = {};
    double seconds = 0, cpuSeconds = 0;
    std::uint64_t peakBytes = 0;  ///< of resident memory
    std::vector<InputStamp> inputs = {};
    std::map<std::string, std::uint64_t> outputs = {};  ///< bytes by path in the item's folder

    bool isDone() const { return exitCode == 0 && signal == 0; }
};

nlohmann::ordered_json recordJson(const ItemRecord& record);
/// Throws InputError, with `file` in front.
ItemRecord recordFromJson(const nlohmann::json& json, const std::string& file);

/// The folder of a batch: items/NAME/ with record.json, answer.json and the result.
class BatchStore {
public:
    explicit BatchStore(std::filesystem::path folder) : folder_(std::move(folder)) {}

    const std::filesystem::path& folder() const { return folder_; }
    std::filesystem::path place(const std::string& name) const { return folder_ / "items" / name; }
    /// None where there is none that can be read.
    std::optional<ItemRecord> read(const std::string& name) const;
    /// Whether all outputs of a record are there with their sizes.
    bool isWhole(const ItemRecord& record) const;

private:
    std::filesystem::path folder_;
};

/// A process that writes into a store. Items are made in hidden folders with a name of the process
/// in theirs; those that ended processes left behind are removed when another one begins.
class StoreWriter {
public:
    /// Makes the folders. Throws OutputError.
    explicit StoreWriter(const BatchStore& store);
    ~StoreWriter();
    StoreWriter(const StoreWriter&) = delete;
    StoreWriter& operator=(const StoreWriter&) = delete;

    /// The folder in which an item is made.
    std::filesystem::path part(const std::string& name) const;

private:
    void removeLeftovers() const;

    const BatchStore& store_;
    std::string id_;
    int lock_ = -1;
};

/// Puts a finished folder in its place, in one step, and removes an earlier one. Throws
/// OutputError.
void publish(const std::filesystem::path& part, const std::filesystem::path& place);

}  // namespace hshfit::jobs
