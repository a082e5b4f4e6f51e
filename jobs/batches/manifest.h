#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace hshfit::jobs {

struct BatchProgram;

/// One piece of work: a command, its input and its options.
struct BatchItem {
    std::size_t line = 0;                  ///< of the manifest, from 1
    std::string name = {};                 ///< of its folder among the results; unique
    std::uint32_t command = 0;             ///< index into BatchProgram::commands
    std::vector<std::string> inputs = {};  ///< one, or the two of a comparison
    std::string output = {};               ///< name of the result; empty: the answer alone
    /// An object; items with equal options share it.
    std::shared_ptr<const nlohmann::json> options = {};
    double cost = 0;  ///< stated; 0: estimated (costs.h)
};

/// The items of a manifest, in its order, and every mistake in it, "FILE:LINE: what is wrong".
struct Manifest {
    std::vector<BatchItem> items;
    std::vector<std::string> mistakes;
};

/// Reads a manifest: JSON lines (docs/reference/batch.md), of which the first may state defaults.
/// Globs and folders become an item for each file. Checks every line as far as that is possible
/// without reading whole measurements: keys, options as the command takes them, inputs that exist,
/// models that parse, names that differ. Paths are relative to the current folder.
///
/// Throws InputError for a manifest that cannot be read.
Manifest readManifest(const std::string& path, const BatchProgram& program);

}  // namespace hshfit::jobs
