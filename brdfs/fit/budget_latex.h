#pragma once

#include <brdfs/fit/budget.h>

#include <string>

namespace hshfit::brdfs {

/// A budget as LaTeX that needs no package: a tabular for each parameter, with its result and
/// expanded uncertainty below. Rules are drawn as by latexTable.
std::string latexBudget(const Budget& budget);

}  // namespace hshfit::brdfs
