#pragma once

#include <ctime>

#include <unistd.h>

namespace hshfit::test {

/// Returns in another second of the clock, so that files that state when they were made differ.
inline void untilNextSecond() {
    const std::time_t now = std::time(nullptr);
    while (std::time(nullptr) == now) usleep(1000);
}

}  // namespace hshfit::test
