// The progress of long work where standard error is no terminal.

#include <cli/command.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <regex>
#include <string>
#include <thread>

namespace hshfit::cli {
namespace {

using namespace std::chrono_literals;

/// Standard error of work in `parts` parts of two steps, each step of 210 ms.
std::string said(const Globals& globals, int parts, std::chrono::milliseconds silence) {
    testing::internal::CaptureStderr();
    for (int part = 0; part < parts; ++part) {
        Progress progress(globals, "fit", silence);
        const jobs::ProgressCall call = progress.callback();
        for (std::size_t done : {1, 2}) {
            std::this_thread::sleep_for(210ms);
            if (call) call(done, 2);
        }
    }
    return testing::internal::GetCapturedStderr();
}

TEST(Progress, IsALineAfterEverySilenceWhereThereIsNoTerminal) {
    const std::string each = said({}, 1, 1ms);
    // Seconds are left open: a machine may be slow.
    EXPECT_TRUE(std::regex_match(each, std::regex("hshfit: fit: 1 of 2 after \\d+ s, \\d+ s left\n"
                                                  "hshfit: fit: 2 of 2 after \\d+ s, 0 s left\n")))
        << each;
    // Parts that are shorter than the silence, one after the other.
    const std::string some = said({}, 3, 700ms);
    const auto lines = std::count(some.begin(), some.end(), '\n');
    EXPECT_TRUE(lines >= 1 && lines < 6) << some;
    EXPECT_EQ(said({}, 1, 1min), "");
    EXPECT_EQ(said({.quiet = true}, 1, 1ms), "");
}

}  // namespace
}  // namespace hshfit::cli
