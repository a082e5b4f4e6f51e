#include <hshfit/material_maps/level_json.h>

namespace hshfit::inline material_maps {

nlohmann::ordered_json levelsJson(std::span<const LevelSize> levels) {
    auto rows = nlohmann::ordered_json::array();
    for (const LevelSize& level : levels)
        rows.push_back({{"width", level.width}, {"height", level.height}});
    return rows;
}

std::vector<LevelSize> readLevels(const JsonFields& texture) {
    constexpr int mostSide = 1 << 20;
    std::vector<LevelSize> levels;
    for (const JsonFields& level : texture.objects("levels")) {
        levels.push_back({static_cast<std::size_t>(level.integer("width", 1, mostSide)),
                          static_cast<std::size_t>(level.integer("height", 1, mostSide))});
    }
    if (levels.empty()) texture.fail("has no level", "levels");
    return levels;
}

}  // namespace hshfit::inline material_maps
