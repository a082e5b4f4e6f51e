#pragma once

#include <functional>
#include <string>

namespace hshfit::brdfs {

/// Gives what Ceres says of its searches to `take`, each sentence once, from whatever thread it is
/// said; nothing goes to standard error or to files of glog any more. A search that fails says so
/// in its result as well. For a program to call once, before any fit, unless it has set up glog
/// itself, which is then left alone.
void takeSolverLog(std::function<void(const std::string&)> take);

}  // namespace hshfit::brdfs
