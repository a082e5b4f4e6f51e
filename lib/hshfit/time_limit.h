#pragma once

#include <algorithm>
#include <chrono>
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
    /// One of `parts` equal shares of what is left.
    TimeLimit share(double parts) const {
        if (!end_) return {};
        const std::chrono::duration<double> left = *end_ - Clock::now();
        return TimeLimit(std::max(0.0, left.count()) / parts);
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
