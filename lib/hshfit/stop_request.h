#pragma once

#include <tbb/task_group.h>

#include <atomic>

namespace hshfit {

/// Ends work whose caller asked for it; no Error, so that no job takes it for a failure of an
/// input.
struct Stopped {};

/// The flag of the caller of this thread's work; none: nobody asks.
inline thread_local const std::atomic<bool>* stopRequest = nullptr;

/// Threads of oneTBB that help with a loop have no flag: they see that a step of the caller ended
/// it.
inline bool stopIsRequested() {
    return (stopRequest && *stopRequest) || tbb::is_current_task_group_canceling();
}

/// For the steps of long work that reports no progress: throws Stopped once it is asked to end.
inline void stopIfRequested() {
    if (stopIsRequested()) throw Stopped();
}

}  // namespace hshfit
