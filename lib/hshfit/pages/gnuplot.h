#pragma once

#include <hshfit/error.h>
#include <hshfit/files/file_set.h>

#include <optional>
#include <string>
#include <vector>

namespace hshfit::inline pages {

/// gnuplot is missing, or failed with a message. The files beside the figures can do without it.
struct NoFigures : OutputError {
    using OutputError::OutputError;
};

/// Runs gnuplot in `folder` with these arguments and no start-up files, in UTC. `outputs` are the
/// files that it is to write; dates are taken out of those that are PDF. Throws NoFigures that
/// names the package to install where there is no gnuplot, or with gnuplot's last words where it
/// fails; OutputError where gnuplot ends well and one of the files is cut short, as on a full disk,
/// which gnuplot does not report.
///
/// Signals that end the process (removeTemporariesOnSignals) end gnuplot first.
void runGnuplot(const std::string& folder, const std::vector<std::string>& arguments,
                const std::vector<std::string>& outputs);

/// Whether a PNG, PDF or SVG file ends as its format says: IEND, %%EOF, </svg>.
bool figureIsComplete(const std::string& path);

/// `text` as a gnuplot string expression, byte by byte. Quotes, back-quotes, which gnuplot would
/// else run as a command, and control characters become octal escapes.
std::string gnuplotString(const std::string& text);

/// `text` so that gnuplot's enhanced mode shows it as it is.
std::string unenhanced(const std::string& text);

/// "NAME='FILE'; ": lets a script use the temporary of a file where it names the file itself.
std::string gnuplotFile(const std::string& name, const AtomicFile& file);

}  // namespace hshfit::inline pages
