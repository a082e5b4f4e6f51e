#pragma once

// The substitute for oneTBB's parallel_for in the preset `threads`. The packaged libtbb is not
// instrumented: ThreadSanitizer cannot follow the order of its tasks, and would report data
// that one task hands to the next as a race. Here each call starts threads of its own whose
// work nothing else orders, so that every report is a race of the program. A nested call runs
// in the calling thread.

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/blocked_range2d.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/partitioner.h>

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <exception>
#include <thread>
#include <vector>

namespace tbb {

namespace threads {

inline thread_local bool within = false;

/// work(0) .. work(count - 1); thread t of n takes t, t + n, t + 2 n, …
template <class Work>
void runAll(std::size_t count, const Work& work) {
    constexpr std::size_t most = 4;
    const std::size_t allowed =
        global_control::active_value(global_control::max_allowed_parallelism);
    const std::size_t team = within || allowed == 1 ? 1 : std::min(most, count);
    if (team <= 1) {
        for (std::size_t i = 0; i < count; ++i) work(i);
        return;
    }
    std::vector<std::exception_ptr> failures(team);
    std::vector<std::thread> members;
    for (std::size_t t = 0; t < team; ++t) {
        members.emplace_back([&, t] {
            within = true;
            try {
                for (std::size_t i = t; i < count; i += team) work(i);
            } catch (...) {
                failures[t] = std::current_exception();
            }
        });
    }
    for (std::thread& member : members) member.join();
    for (const std::exception_ptr& failure : failures) {
        if (failure) std::rethrow_exception(failure);
    }
}

template <class Range>
void divide(Range range, int times, std::vector<Range>& parts) {
    if (times > 0 && range.is_divisible()) {
        Range right(range, split());
        divide(range, times - 1, parts);
        divide(right, times - 1, parts);
    } else {
        parts.push_back(range);
    }
}

}  // namespace threads

template <std::integral Index, class Body>
void parallel_for(Index first, Index last, const Body& body) {
    if (!(first < last)) return;
    threads::runAll(static_cast<std::size_t>(last - first), [&](std::size_t i) {
        body(static_cast<Index>(first + static_cast<Index>(i)));
    });
}

template <class Range, class Body>
requires(!std::integral<Range>) void parallel_for(const Range& range, const Body& body,
                                                  int times = 6) {
    if (range.empty()) return;
    std::vector<Range> parts;
    threads::divide(range, times, parts);
    threads::runAll(parts.size(), [&](std::size_t i) { body(parts[i]); });
}

template <class Range, class Body>
requires(!std::integral<Range>) void parallel_for(const Range& range, const Body& body,
                                                  const simple_partitioner&) {
    parallel_for(range, body, 64);
}

}  // namespace tbb
