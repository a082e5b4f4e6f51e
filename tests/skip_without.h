#pragma once

#include <gtest/gtest.h>

#include <filesystem>

/// Skips a test, with the reason printed, where an input beside the project is absent.
#define SKIP_WITHOUT(path) \
    if (!std::filesystem::exists(path)) GTEST_SKIP() << (path) << " is absent"
