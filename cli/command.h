#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/coefficients/outgoing.h>

#include <nlohmann/json_fwd.hpp>

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

namespace CLI {
class App;
}

namespace hshfit::cli {

struct Command;

/// Options that every command has, and the exit code of a command that ended without an exception.
struct Globals {
    bool json = false;
    bool quiet = false;
    int threads = 0;  ///< 0: all cores
    int exitCode = 0;
};

/// Adds a command with the global options, its own, and its example below the help.
void addCommand(CLI::App& app, Globals& globals, const Command& row);

/// A BRDF specification. With `rgb`, a spectral one as linear Rec. 709; others stay as they are.
std::unique_ptr<Brdf> openBrdf(const std::string& spec, bool rgb);
/// A BRDF specification, a coefficient file or a file of an export, as a BRDF; `rgb` likewise.
std::unique_ptr<Brdf> openSource(const std::string& spec, bool rgb);
/// The option --rgb.
void addRgb(CLI::App& command, bool& rgb);

/// "THETA,PHI" in degrees, theta from 0 to 90. Throws UsageError naming `option`.
Direction parseDirection(const std::string& text, std::string_view option);

/// The set asked for; if empty, 16 elevations for an isotropic BRDF and a 16x16 map otherwise.
OutgoingSet outgoingOrDefault(const std::string& text, const Brdf& brdf);

/// Prints a JSON document to standard output. Throws OutputError if it cannot be written.
void printJson(const nlohmann::ordered_json& document);
/// Prints text to standard output, likewise.
void printText(std::string_view text);

/// A progress line on standard error, only on a terminal and unless --quiet: what is done, how much
/// of it, how fast, and the time left. Empty where nothing would be shown.
class Progress {
public:
    Progress(const Globals& globals, std::string what);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// For the options of library calls; may be called from any thread.
    std::function<void(std::size_t, std::size_t)> callback();

private:
    struct State;
    std::shared_ptr<State> state_;
};

/// A message on standard error, unless --quiet.
void note(const Globals& globals, std::string_view message);

}  // namespace hshfit::cli
