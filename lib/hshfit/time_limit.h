#pragma once

#include <algorithm>
#include <chrono>
#include <limits>
#include <optional>

namespace hshfit {

/// The end of the time of work that can stop early with what it has; or none.
class TimeLimit {
public:
    TimeLimit() = default;
    /// `seconds` from now.
    explicit TimeLimit(std::optional<double> seconds) {
        if (seconds) end_ = Clock::now() + asDuration(*seconds);
    }
    /// Infinity without an end.
    double secondsLeft() const {
        if (!end_) return std::numeric_limits<double>::infinity();
        const std::chrono::duration<double> left = *end_ - Clock::now();
        return std::max(0.0, left.count());
    }
    /// One of `parts` equal shares of what is left.
    TimeLimit share(double parts) const {
        return end_ ? TimeLimit(secondsLeft() / parts) : TimeLimit();
    }

    explicit operator bool() const { return end_.has_value(); }
    bool isOver() const { return end_ && Clock::now() >= *end_; }

private:
    using Clock = std::chrono::steady_clock;
    static Clock::duration asDuration(double seconds) {
        return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
    }
    std::optional<Clock::time_point> end_;
};

}  // namespace hshfit
