#pragma once

// Scenes that tests of several commands share.

#include <nlohmann/json.hpp>

namespace hshfit::test {

/// Adds the inside of the cube from -1 to 1: six squares of the material 'grey' that all emit 1.
inline void addFurnace(nlohmann::json& objects) {
    const auto add = [&](double theta, double phi, const nlohmann::json& at) {
        objects.push_back({{"mesh", "square"},
                           {"material", "grey"},
                           {"emission", 1},
                           {"theta", theta},
                           {"phi", phi},
                           {"at", at}});
    };
    add(0, 0, {0, 0, -1});
    add(180, 0, {0, 0, 1});
    add(90, 0, {-1, 0, 0});
    add(90, 180, {1, 0, 0});
    add(90, 90, {0, -1, 0});
    add(90, -90, {0, 1, 0});
}

}  // namespace hshfit::test
