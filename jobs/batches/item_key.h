#pragma once

#include "store.h"

#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace hshfit::jobs {

struct BatchItem;
struct BatchProgram;

/// SHA-256 of files, each read once while its size and times stay as they are.
class FileSums {
public:
    /// The stamp of a file as it is now. Of `known`, an earlier stamp with the same size and times
    /// gives the checksum without reading. Throws InputError for a file that cannot be read.
    InputStamp stamp(const std::string& path, const std::vector<InputStamp>& known = {});

private:
    std::mutex mutex_;
    std::unordered_map<std::string, InputStamp> stamps_;
};

/// The files that an item's inputs and its options' values name, and the files that these name in
/// turn (named_files.h), each once, sorted by name; without the files that the item writes.
std::vector<std::string> filesOf(const BatchItem& item, const BatchProgram& program);

/// SHA-256 of all that an item's result depends on: the version of the program, the words of the
/// command line, and the bytes of the files that they name.
std::string itemKey(const BatchProgram& program, const std::vector<std::string>& words,
                    const std::vector<InputStamp>& inputs);

/// The words, stamps and key of an item as it would be run now.
struct ItemState {
    std::vector<std::string> words;
    std::vector<InputStamp> inputs;
    std::string key;
};
ItemState stateOf(const BatchItem& item, const BatchProgram& program, FileSums& sums,
                  const std::optional<ItemRecord>& earlier);

}  // namespace hshfit::jobs
