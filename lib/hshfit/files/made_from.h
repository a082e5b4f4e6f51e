#pragma once

#include <optional>
#include <string>
#include <vector>

namespace hshfit::inline files {

/// The origin of a file, as the file itself states it, so that a later run can tell whether the
/// file is still valid.
struct MadeFrom {
    std::string command = {};  ///< that wrote it
    std::string key = {};      ///< of inputs, options and version: OutputRule
    /// The exit code of the run. Where it is not 0, its findings lie in its files all the same.
    int exitCode = 0;
    std::vector<std::string> files = {};  ///< written with it, by names in the same folder
    /// sumOfPart of each of them; empty for one that states its own content.
    std::vector<std::string> sums = {};
    /// SHA-256 of the bytes that the statement leaves where they are: before it, in OpenEXR the
    /// pixels. Computed when the statement is added.
    std::string content = {};
    bool changed = false;  ///< read back: the file no longer has the sum `content`
};

/// SHA-256 of a file's bytes; of a file of more than 16 MiB, of its size and of 16 pieces of a MiB
/// spread evenly from its beginning to its end, so that a map of gigabytes is not read again.
/// "absent" where there is none.
std::string sumOfPart(const std::string& path);

/// Whether a file of this name has a place for it: .json, .exr and .png.
bool canStateMadeFrom(const std::string& path);

/// Adds the statement to a complete file: to the JSON object at the root the last member
/// "made_from", to PNG a text chunk "made_from" (PNG 11.3.4.3), to OpenEXR of one part the string
/// attribute "hshfit:made_from". The rest of the content stays as it was. False, and the file is
/// as it was, for content of any other kind. Throws OutputError if it cannot be written.
bool addMadeFrom(const std::string& path, const MadeFrom& made);

/// The statement in a file; none where there is no file or no statement.
std::optional<MadeFrom> madeFromOf(const std::string& path);

}  // namespace hshfit::inline files
