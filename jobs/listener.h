#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace hshfit::jobs {

/// How much of a part of the work is done, and of how much. May be called from any thread.
using ProgressCall = std::function<void(std::size_t done, std::size_t total)>;

/// What a job tells its caller while it works. Members that are left out are not called.
struct Listener {
    /// A part of the work begins. Its progress goes to the function returned, whose last copy is
    /// destroyed when the part ends.
    std::function<ProgressCall(const std::string& part)> begin = {};
    /// A remark; the job goes on.
    std::function<void(const std::string& remark)> note = {};

    ProgressCall part(const std::string& name) const { return begin ? begin(name) : nullptr; }
    void say(const std::string& remark) const {
        if (note) note(remark);
    }
};

}  // namespace hshfit::jobs
