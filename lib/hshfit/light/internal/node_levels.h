#pragma once

#include <algorithm>
#include <cmath>

namespace hshfit::inline light {

/// Number of nodes at a level, from the number at level 0: half as many again at each, at least 2.
inline int nodesAtLevel(double nodes, int level) {
    return std::max(2, static_cast<int>(std::ceil(nodes * std::pow(1.5, level))));
}

}  // namespace hshfit::inline light
