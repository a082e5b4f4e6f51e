#pragma once

#include <hshfit/bases/basis.h>
#include <hshfit/light/light_nodes.h>

#include <vector>

namespace hshfit::inline light {

/// Adds to `moments`, [R, G, B][slot], the sums over the nodes of flux times the analysis functions
/// of the basis (and cos(theta) where that belongs to its inner product). Theta functions are
/// evaluated once for nodes of one height that follow each other, and azimuths are summed first.
/// Runs on all threads; results do not depend on their number.
void addNodeMoments(const Basis& basis, const LightNodes& nodes, std::vector<double>& moments);

}  // namespace hshfit::inline light
