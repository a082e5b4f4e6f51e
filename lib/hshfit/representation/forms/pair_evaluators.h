#pragma once

#include <hshfit/representation/pair_evaluator.h>
#include <hshfit/representation/representation.h>

#include <memory>

namespace hshfit::inline representation::inline forms {

/// Throws InputError as `reconstruct` does.
std::unique_ptr<PairEvaluator> pairEvaluator(const Representation& representation,
                                             const BrdfOpener& open);

}  // namespace hshfit::inline representation::inline forms
