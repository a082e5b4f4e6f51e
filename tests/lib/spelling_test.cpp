// The nearest known name, in the messages of every table of names.

#include <hshfit/accuracy/metrics.h>
#include <hshfit/bases/catalog.h>
#include <hshfit/gpu/containers/targets.h>
#include <hshfit/irradiance/conventions.h>
#include <hshfit/specification/sums.h>
#include <hshfit/spelling.h>
#include <hshfit/transfer/windows.h>

#include <gtest/gtest.h>

#include <array>

namespace hshfit {
namespace {

/// The message of `call` for a name that is `name` with one letter replaced.
template <class Call>
std::string messageFor(std::string name, Call call) {
    name[name.size() / 2] = '#';
    try {
        call(name);
    } catch (const UsageError& error) {
        return error.what();
    }
    return "no error";
}

template <class Rows, class Call>
void expectSuggestions(const Rows& rows, Call call) {
    for (const auto& row : rows) {
        const std::string name(row.name);
        if (name.size() < 3) continue;  // two letters differ from any others by two edits
        EXPECT_NE(messageFor(name, call).find("did you mean '"), std::string::npos)
            << messageFor(name, call);
    }
}

TEST(Spelling, EveryNameOfATableIsSuggestedForAMisspeltOne) {
    expectSuggestions(bases::catalog(), [](const std::string& name) { bases::find(name); });
    expectSuggestions(metricCatalog(), [](const std::string& name) { selectMetrics(name); });
    expectSuggestions(gpu::targets(), [](const std::string& name) { gpu::selectTargets(name); });
    expectSuggestions(conventions(), [](const std::string& name) { selectConventions(name); });
    EXPECT_EQ(messageFor("hann", [](const std::string& name) { parseWindow(name); }),
              "unknown window 'ha#n' (did you mean 'hann'?); known: none, hann, lanczos, bending");
}

TEST(Spelling, BeginningsCountAndDistantNamesDoNot) {
    constexpr std::array known{"zernike", "hsh", "sh"};
    EXPECT_EQ(spelling::nearest("zer", known), "zernike");
    EXPECT_EQ(spelling::nearest("hhs", known), "hsh");
    EXPECT_EQ(spelling::nearest("HSH", known), "hsh");
    EXPECT_EQ(spelling::nearest("Zernicke", known), "zernike");
    EXPECT_EQ(spelling::nearest("wavelet", known), "");
    EXPECT_EQ(spelling::question("wavelet", known), "");
    // Edits by hand: kitten, sitten, sittin, sitting.
    EXPECT_EQ(spelling::distance("kitten", "sitting"), 3U);
}

TEST(Joints, AreThePlusSignsOutsideOfNumbers) {
    const std::string text = "phong:exponent=1e+2+lambert + 2.e+1 * ggx";
    const std::size_t first = nextJoint(text, 0), second = nextJoint(text, first + 1);
    EXPECT_EQ(first, text.find("+lambert"));
    EXPECT_EQ(second, text.find("+ 2.e"));
    EXPECT_EQ(nextJoint(text, second + 1), std::string::npos);
    EXPECT_EQ(nextJoint("oren+e+b", 0), 4U);
    EXPECT_EQ(withoutSpaces("  a b "), "a b");
}

}  // namespace
}  // namespace hshfit
