#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace hshfit::jobs {

/// Receives the finished and the total amount of a part of the work. Has to be thread-safe.
using ProgressCall = std::function<void(std::size_t done, std::size_t total)>;

/// Callbacks through which a job reports its progress. Empty members are not called.
struct Listener {
    /// Called at the start of a part of the work. The returned function receives the part's
    /// progress; its last copy is destroyed when the part ends.
    std::function<ProgressCall(const std::string& part)> begin = {};
    /// A remark; the job goes on.
    std::function<void(const std::string& remark)> note = {};

    ProgressCall part(const std::string& name) const { return begin ? begin(name) : nullptr; }
    void say(const std::string& remark) const {
        if (note) note(remark);
    }
};

}  // namespace hshfit::jobs
