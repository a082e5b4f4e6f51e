#include <hshfit/files/template_text.h>

#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>
#include <new>
#include <optional>
#include <string>

namespace {

/// Bytes of the largest allocation that succeeds in this program.
std::size_t largestAllocation = std::numeric_limits<std::size_t>::max();

}  // namespace

void* operator new(std::size_t size) {
    void* memory = size <= largestAllocation ? std::malloc(size == 0 ? 1 : size) : nullptr;
    if (!memory) throw std::bad_alloc();
    return memory;
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}

namespace hshfit {
namespace {

using kainjow::mustache::data;
using Fill = std::string (*)(std::string_view, const data&);

/// The text, or nothing where memory was short.
std::optional<std::string> filledWithin(std::size_t most, Fill fill, const std::string& text,
                                        const data& values) {
    largestAllocation = most;
    std::optional<std::string> result;
    try {
        result = fill(text, values);
    } catch (const std::bad_alloc&) {
    }
    largestAllocation = std::numeric_limits<std::size_t>::max();
    return result;
}

TEST(TemplateText, ShortMemoryLeavesNothingOfAText) {
    const std::string name(60, 'n'), value(100'000, 'v');
    data list{data::type::list};
    for (int k = 0; k < 3; ++k) list.push_back(data(name, value));
    const data values("list", list);
    const std::string text = "begin {{#list}}{{" + name + "}}{{/list}} end";
    const std::string whole = "begin " + value + value + value + " end";
    for (const Fill fill : {&filledText, &filledPage}) {
        int complete = 0, failed = 0;
        for (std::size_t most = 16; most < 2'000'000; most += most / 8) {
            const auto result = filledWithin(most, fill, text, values);
            EXPECT_TRUE(!result || *result == whole) << most << " bytes: " << result->size();
            ++(result ? complete : failed);
        }
        EXPECT_GT(complete, 0);
        EXPECT_GT(failed, 0);
    }
}

TEST(TemplateText, PagesEscapeValuesAndSourceTextDoesNot) {
    const data values("value", std::string("a<b & \x1b"));
    EXPECT_EQ(filledText("{{value}}", values), "a<b & \x1b");
    EXPECT_EQ(filledPage("{{value}} {{{value}}}", values), "a&lt;b &amp; ? a<b & ?");
}

TEST(TemplateText, NamesWithPointsLeadToMembers) {
    const data values("a", data("b", std::string("found")));
    EXPECT_EQ(filledText("{{a.b}}{{a.c}}", values), "found");
}

}  // namespace
}  // namespace hshfit
