#include <hshfit/files/json_fields.h>
#include <hshfit/files/printable.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

using namespace hshfit;

namespace {

TEST(Printable, KeepsUtf8AndReplacesEverythingElse) {
    EXPECT_EQ(printable("plain θ 漢 🙂 ~"), "plain θ 漢 🙂 ~");
    EXPECT_EQ(printable("a\nb\tc\rd\x1b[31m\x7f"), "a?b?c?d?[31m?");
    EXPECT_EQ(printable(std::string_view("a\0b", 3)), "a?b");
    EXPECT_EQ(printable("\xc2\x9b"
                        "31m"),
              "?31m")
        << "CSI of C1";
    EXPECT_EQ(printable("a\xe2\x80\xae"
                        "b\xe2\x81\xa6"
                        "c\xe2\x80\xa8"),
              "a?b?c?")
        << "bidi, line";
    // Table 3-7 of the Unicode standard, each with one byte out of its range.
    for (const std::string_view text :
         {"\x80", "\xff", "\xc0\xaf", "\xc1\xbf", "\xe0\x9f\xbf", "\xed\xa0\x80",
          "\xf0\x8f\xbf\xbf", "\xf4\x90\x80\x80", "\xe2\x82", "\xf0\x9f\x99", "\xf5\x80\x80\x80"}) {
        EXPECT_EQ(printable(text), std::string(text.size(), '?'));
        EXPECT_EQ(printable(std::string(text) + "x"), std::string(text.size(), '?') + "x");
    }
    for (const std::string_view text : {"\xc2\xa0", "\xdf\xbf", "\xe0\xa0\x80", "\xed\x9f\xbf",
                                        "\xee\x80\x80", "\xf0\x90\x80\x80", "\xf4\x8f\xbf\xbf"}) {
        EXPECT_EQ(printable(text), text);
    }
}

TEST(Printable, LinesKeepLineFeedsAndTabs) {
    EXPECT_EQ(printableLines("a\tb\nc\x1b\r\xff\n"), "a\tb\nc???\n");
}

TEST(Printable, JsonReadsBackAsTheSameText) {
    const std::string text = "a\x7f\xc2\x9b\xe2\x80\xae\n\x1b\"\\θ";
    const std::string json = jsonText(nlohmann::json({{"key", text}}), 2);
    EXPECT_EQ(printableLines(json), json);
    EXPECT_EQ(nlohmann::json::parse(json).at("key"), text);
    const auto broken = nlohmann::json::parse(jsonText(nlohmann::ordered_json("a\xff")));
    EXPECT_EQ(broken.get<std::string>(), "a\xef\xbf\xbd");
}

TEST(Printable, ShortenedKeepsBothEndsAndWholeCharacters) {
    EXPECT_EQ(shortened("0123456789", 10), "0123456789");
    EXPECT_EQ(shortened("0123456789abc", 11), "0123…9abc");
    const std::string wide = [] {
        std::string text;
        for (int i = 0; i < 1000; ++i) text += "漢";
        return text;
    }();
    for (std::size_t limit = 10; limit < 40; ++limit) {
        const std::string cut = shortened(wide, limit);
        EXPECT_LE(cut.size(), limit);
        EXPECT_GE(cut.size() + 6, limit);
        EXPECT_EQ(printable(cut), cut);
    }
}

}  // namespace
