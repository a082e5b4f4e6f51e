// Extensions of paths.

#include <hshfit/files/extension.h>

#include <gtest/gtest.h>

namespace {

using hshfit::extensionOf;

TEST(Extension, IsInLowerCase) {
    EXPECT_EQ(extensionOf("a/SPHERE.PNG"), ".png");
    EXPECT_EQ(extensionOf("x.Json"), ".json");
    EXPECT_EQ(extensionOf("x.json.EXR"), ".exr");
    EXPECT_EQ(extensionOf("A.B/x"), "");
    EXPECT_EQ(extensionOf(".PNG"), "");
    EXPECT_EQ(extensionOf(""), "");
    EXPECT_EQ(extensionOf("x.\xC3\x84"), ".\xC3\x84");
}

}  // namespace
