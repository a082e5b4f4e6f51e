// The format of JSON texts, wherever its key stands.

#include <hshfit/files/json_format.h>

#include "temporary_file.h"

#include <gtest/gtest.h>

namespace hshfit {
namespace {

TEST(JsonFormat, IsFoundInAnyOrderAndWithAnySpaces) {
    for (const char* text :
         {R"({"format":"a"})", "\n\t { \"x\" : [1, {\"format\": \"b\"}],\r\n \"format\" : \"a\" }",
          R"({"z":{"format":"b"},"y":[[]],"format":"a","format":"c"})",
          R"({"format":"a", the rest is not looked at)"})
        EXPECT_EQ(jsonFormat(text), "a") << text;
}

TEST(JsonFormat, IsEmptyForTextsThatHaveNone) {
    for (const char* text :
         {"", "{", "{}", "[\"format\", \"a\"]", "\"format\"", "null", "1e999",
          R"({"format":1,"x":"a"})", R"({"format":["a"],"x":"a"})", R"({"format":{"a":"a"}})",
          R"([{"format":"a"}])", R"({"x":{"format":"a"}})", R"({"format" "a"})", "\xff\xfe{"})
        EXPECT_EQ(jsonFormat(text), "") << text;
}

TEST(JsonFormat, OfAFileIsThatOfItsText) {
    EXPECT_EQ(jsonFormatOf(test::TemporaryFile(R"({"a":0,"format":"b"})").path()), "b");
    EXPECT_EQ(jsonFormatOf("/"), "");
    EXPECT_EQ(jsonFormatOf("absent.json"), "");
}

}  // namespace
}  // namespace hshfit
