#pragma once

#include <stdexcept>
#include <string>

namespace hshfit {

/// The exit code of a failure. `main` catches all errors once and returns the code.
enum class ExitCode { done = 0, usage = 2, input = 3, numeric = 4, output = 5 };

/// Bad input, an impossible request or a failed write. The message is one line that says what is
/// wrong, where, and what would be right. Our own bugs are `assert`ed instead.
class Error : public std::runtime_error {
public:
    Error(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
    ExitCode code() const { return code_; }

private:
    ExitCode code_;
};

/// A command line or a specification that cannot be understood.
struct UsageError : Error {
    explicit UsageError(const std::string& message) : Error(ExitCode::usage, message) {}
};

/// A file that cannot be read or whose content is invalid; the message names the file.
struct InputError : Error {
    explicit InputError(const std::string& message) : Error(ExitCode::input, message) {}
};

/// Numbers that do not exist (a diverging energy) or did not converge within the bounds.
struct NumericError : Error {
    explicit NumericError(const std::string& message) : Error(ExitCode::numeric, message) {}
};

/// A file that could not be written; nothing half-written is left behind.
struct OutputError : Error {
    explicit OutputError(const std::string& message) : Error(ExitCode::output, message) {}
};

}  // namespace hshfit
