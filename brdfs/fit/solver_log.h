#pragma once

#include <functional>
#include <string>

namespace hshfit::brdfs {

/// Passes the messages of Ceres about its searches to `take`, each once, on the thread of the
/// search; nothing goes to standard error or to files of glog any more. The result of a search that
/// fails has the reason as well. For a program to call once, before any fit, unless it has set up
/// glog itself, which is then left alone.
void takeSolverLog(std::function<void(const std::string&)> take);

}  // namespace hshfit::brdfs
