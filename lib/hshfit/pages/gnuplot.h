#pragma once

#include <string>
#include <vector>

namespace hshfit::inline pages {

/// Runs gnuplot in `folder` with these arguments and no start-up files. Throws OutputError that
/// names the package to install where there is no gnuplot, or with gnuplot's last words where it
/// fails.
void runGnuplot(const std::string& folder, const std::vector<std::string>& arguments);

/// `text` as a gnuplot string expression. Single quotes hold everything but line breaks literally,
/// back-quotes included, which gnuplot would else run as a command.
std::string gnuplotString(const std::string& text);

}  // namespace hshfit::inline pages
