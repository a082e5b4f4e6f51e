#pragma once

// Options of jobs (jobs/common/option_row.h) as keyword arguments.

#include "module.h"

#include <jobs/common/option_row.h>

#include <string>
#include <string_view>
#include <vector>

namespace hshfit::python {

using Options = std::vector<jobs::BoundOption>;

/// The keyword arguments of one call of a function.
class Keywords {
public:
    /// The last argument of every function is `progress`.
    explicit Keywords(const py::kwargs& given) : left_(py::dict(given)) {}

    /// Sets the options that are given. Throws UsageError for a value out of its range, and
    /// TypeError for one of another type.
    void set(const Options& options);
    /// The argument, or None.
    py::object take(const char* name);
    /// Throws TypeError if there are arguments that nobody took.
    void finish() const;

private:
    py::dict left_;
};

/// The docstring: a signature as pybind11 writes it, with the defaults that the options have, the
/// text, and a line for each option. `before`: arguments by place, as "brdf: object".
std::string documented(std::string_view function, std::string_view before, const Options& options,
                       std::string_view result, std::string_view text);

}  // namespace hshfit::python
