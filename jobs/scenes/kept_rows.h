#pragma once

#include "scene_surfaces.h"

#include <hshfit/files/checkpoint.h>
#include <hshfit/transport/path_tracer.h>

#include <atomic>
#include <cstddef>
#include <string>

namespace hshfit::jobs {

/// Rows of a camera's picture in a file (Checkpoint) beside it, so that a run that was stopped goes
/// on: the picture has the same bits as one of a run without a stop.
class KeptRows {
public:
    /// `inputs` is the scene's inputsKey. Throws InputError for rows of other inputs or options.
    KeptRows(const std::string& path, const std::string& inputs, const Camera& camera,
             const PathOptions& options);

    /// The rows as tracePaths takes them; they must not outlive this object.
    PathRows rows();
    /// Rows of an earlier run that were taken.
    std::size_t taken() const { return taken_; }
    /// The picture is written: removes the file.
    void remove() noexcept { work_.remove(); }

private:
    std::size_t width_;
    Checkpoint work_;
    std::atomic<std::size_t> taken_ = 0;
};

}  // namespace hshfit::jobs
