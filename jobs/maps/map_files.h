#pragma once

#include <hshfit/files/file_set.h>
#include <hshfit/material_maps/processes.h>

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::jobs {

/// The files of a map: the first process has them under temporary names until all are complete.
/// All processes call the same functions.
class MapFiles {
public:
    /// Files of an earlier map in the folder go when these are put in place. Throws OutputError.
    MapFiles(const std::string& folder, bool force, Processes& processes);

    /// Throws what `texture` and `write` would throw for these names.
    void requireFree(const std::vector<std::string>& names) const;
    /// Adds a texture, which processes write in place: its path until it is complete.
    std::string texture(const std::string& name);
    void write(const std::string& name, std::string_view text);
    /// A file that the first process writes, closed: its path until all are complete.
    std::string file(const std::string& name, const std::function<void(AtomicFile&)>& fill);
    /// One of many, which the sidecar names: it would not name them all itself.
    void writePart(const std::string& name, std::string_view text);
    /// Puts all in place; their names are returned.
    std::vector<std::string> commit();

private:
    Processes& processes_;
    std::optional<FileSet> files_;
    std::vector<std::string> names_;
};

}  // namespace hshfit::jobs
