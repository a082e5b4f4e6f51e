#pragma once

#include <tbb/parallel_for.h>

#include <atomic>
#include <cstddef>
#include <exception>

namespace hshfit {

/// body(0) … body(count - 1) in parallel, for bodies that have parallel loops of their own and may
/// throw. Once one has thrown, no other begins, those under way end as usual, and its exception
/// goes to the caller. From tbb::parallel_for, an exception would also cut short the loops within
/// bodies under way, silently, so that these would go on with incomplete results.
template <class Body>
void eachInParallel(std::size_t count, const Body& body) {
    std::atomic<bool> failed = false;
    std::exception_ptr failure;  // of the thread that set `failed`
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t k) {
        if (failed) return;
        try {
            body(k);
        } catch (...) {
            if (!failed.exchange(true)) failure = std::current_exception();
        }
    });
    if (failure) std::rethrow_exception(failure);
}

}  // namespace hshfit
