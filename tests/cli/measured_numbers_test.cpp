// Numbers on the console, to the digits that their errors leave.

#include <cli/measured_numbers.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace hshfit::cli {
namespace {

// Expected texts by hand: the rule of two digits of the error (Guide to the Expression of
// Uncertainty in Measurement, 7.2.6).
TEST(MeasuredNumbers, HaveTheDigitsThatTheirErrorsLeave) {
    EXPECT_EQ(withError(0.06634837701338393, 0.0022), "0.0663 +- 0.0022");
    EXPECT_EQ(withError(5.3819336, 3.85), "5.4 +- 3.9");
    EXPECT_EQ(withError(-12.3456, 0.789), "-12.35 +- 0.79");
    EXPECT_EQ(withError(1234.5, 17), "1234 +- 17");
    EXPECT_EQ(withError(1234.5, 170), "1230 +- 170");
    EXPECT_EQ(withError(0.083775804, 5.5e-9), "0.083775804 +- 5.5e-09");
    EXPECT_EQ(withError(1.234567e-7, 3.2e-9), "1.235e-07 +- 3.2e-09");
    EXPECT_EQ(withError(7.654321e8, 1.2e6), "7.654e+08 +- 1.2e+06");
    EXPECT_EQ(withError(0, 0.012), "0.000 +- 0.012");
    EXPECT_EQ(withError(0.001, 0.5), "0.00 +- 0.50");
    // An error that rounds to a number of one digit more.
    EXPECT_EQ(withError(1.23456, 0.0996), "1.23 +- 0.10");
    EXPECT_EQ(withError(0.25, 0), "0.25 +- 0");
    EXPECT_EQ(withError(0.5, std::numeric_limits<double>::infinity()), "0.5 +- inf");
}

TEST(MeasuredNumbers, KeepTheValueWithinATenthOfTheError) {
    for (double value = 1.7e-9; value < 1e10; value *= 3.1)
        for (double error = 1e-13 * value; error < 10 * value; error *= 2.3) {
            const std::string text = withError(value, error);
            EXPECT_LE(std::abs(std::stod(text) - value), 0.051 * error + 0.6e-7 * value) << text;
            EXPECT_NEAR(std::stod(text.substr(text.find("+- ") + 3)), error, 0.051 * error) << text;
        }
}

TEST(MeasuredNumbers, SpecificationsHaveSixDigitsAndNamesKeepTheirs) {
    EXPECT_EQ(withShortNumbers("ggx:alpha=0.06634837701338393,F0=0.5"),
              "ggx:alpha=0.0663484,F0=0.5");
    EXPECT_EQ(withShortNumbers("lambert:kd=0.123456789/0.2/1.0000000000000002e-05 + 2 * sg"),
              "lambert:kd=0.123457/0.2/1e-05 + 2 * sg");
    EXPECT_EQ(withShortNumbers("a1234567890:b.1234567891=1"), "a1234567890:b.1234567891=1");
}

}  // namespace
}  // namespace hshfit::cli
