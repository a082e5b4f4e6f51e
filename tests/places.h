#pragma once

#include <string>

namespace hshfit::test {

std::string sharedFolder();  ///< the shared inputs beside the project; may be absent
std::string sourceFolder();  ///< the top of the project
std::string program();       ///< the path of the program hshfit

bool hasGnuplot();
/// The reason of a test that is skipped without it.
inline constexpr const char* noGnuplot = "gnuplot is not installed";

}  // namespace hshfit::test
