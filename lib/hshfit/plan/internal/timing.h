#pragma once

#include <hshfit/representation/representation.h>

namespace hshfit::plan {

/// Median over 31 runs of 4096 pairs each, on one thread, by `pairEvaluator`.
double nanosecondsPerPair(const Representation& representation, const BrdfOpener& open);

}  // namespace hshfit::plan
