#include <hshfit/each_in_parallel.h>

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <chrono>
#include <numeric>
#include <stdexcept>
#include <thread>
#include <vector>

namespace hshfit {
namespace {

TEST(EachInParallel, CallsEveryBodyOnce) {
    std::vector<int> calls(1000, 0);
    eachInParallel(calls.size(), [&](std::size_t k) { ++calls[k]; });
    EXPECT_EQ(calls, std::vector<int>(1000, 1));
}

// One body throws while loops within others are under way: those count to their end.
TEST(EachInParallel, LoopsWithinBodiesUnderWayAreNotCutShort) {
    constexpr std::size_t inner = 256;
    for (int round = 0; round < 20; ++round) {
        std::atomic<int> cut = 0;
        std::atomic<std::size_t> under = 0;
        const auto body = [&](std::size_t k) {
            if (k == 7) {
                // Until another body is within its loop, if there is a second thread.
                for (int wait = 0; under == 0 && wait < 100; ++wait)
                    std::this_thread::sleep_for(std::chrono::milliseconds(1));
                throw std::runtime_error("seven");
            }
            std::vector<int> done(inner, 0);
            ++under;
            tbb::parallel_for(std::size_t{0}, inner, [&](std::size_t i) {
                std::this_thread::sleep_for(std::chrono::microseconds(50));
                done[i] = 1;
            });
            if (std::accumulate(done.begin(), done.end(), 0) != static_cast<int>(inner)) ++cut;
        };
        EXPECT_THROW(eachInParallel(16, body), std::runtime_error);
        EXPECT_EQ(cut, 0);
    }
}

}  // namespace
}  // namespace hshfit
