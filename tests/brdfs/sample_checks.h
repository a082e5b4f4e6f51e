#pragma once

#include <hshfit/brdf/directions.h>
#include <hshfit/error.h>

#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

namespace hshfit::test {

inline Direction atDegrees(double theta, double phi) {
    return directionFromAngles(radians(theta), radians(phi));
}

inline void expectDirection(const Direction& got, const Direction& expected,
                            double tolerance = 1e-12) {
    EXPECT_NEAR(got.x, expected.x, tolerance);
    EXPECT_NEAR(got.y, expected.y, tolerance);
    EXPECT_NEAR(got.z, expected.z, tolerance);
}

/// For every truncation, in a copy of exactly the size, either the reader takes the rest or it
/// throws InputError.
template <class Read>
void cutEverywhere(const Read& read, const std::string& text) {
    EXPECT_NO_THROW(read(text));
    for (std::size_t size = 0; size < text.size(); ++size) {
        const std::vector<char> copy(text.begin(),
                                     text.begin() + static_cast<std::ptrdiff_t>(size));
        try {
            read(std::string_view(copy.data(), copy.size()));
        } catch (const InputError&) {
        }
    }
}

}  // namespace hshfit::test
