#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace hshfit::jobs {

/// Takes the amount done of a part of the work, and the whole. May be called from any thread.
using ProgressCall = std::function<void(std::size_t done, std::size_t total)>;

/// The caller of a job hears of its progress here. Members that are left out are not called.
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
