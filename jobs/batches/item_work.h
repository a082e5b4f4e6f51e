#pragma once

#include "store.h"

#include <filesystem>
#include <string>
#include <vector>

namespace hshfit::jobs {

struct BatchProgram;

/// An order to make one item.
struct ItemOrder {
    std::filesystem::path part = {};      ///< the folder in which it is made
    std::filesystem::path place = {};     ///< to which the folder goes
    std::vector<std::string> words = {};  ///< with the path of the result within `part`
    ItemRecord record = {};               ///< name, words, key and inputs
};

/// An order as one line of text, for another process.
std::string orderText(const ItemOrder& order);

/// Runs an order's words, puts the folder of the item in its place, and returns the record as one
/// line of text. A failure of any kind is in the record. Standard output and standard error of the
/// process go to files while the words run.
std::string makeItem(const std::string& order, const BatchProgram& program);

/// The record of such a line. Throws InputError.
ItemRecord madeItem(const std::string& text);

/// Puts a record of a failure in the place of the item.
void recordFailure(ItemOrder& order, int exitCode, const std::string& message);
/// Puts a record in the place of an item whose process died; `signal` 0: not by a signal.
void recordDeath(ItemOrder& order, int signal);

/// Whether an item failed because allocations did.
bool lackedMemory(const ItemRecord& record);

}  // namespace hshfit::jobs
