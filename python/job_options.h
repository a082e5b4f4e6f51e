#pragma once

// Options of jobs (jobs/common/option_row.h) as keyword arguments.

#include "module.h"

#include <jobs/common/option_row.h>

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace hshfit::python {

using Options = std::vector<jobs::BoundOption>;

/// Options of several structs.
Options joined(std::initializer_list<Options> parts);
/// The options without the given names, or with these names alone.
Options without(Options options, std::initializer_list<std::string_view> names);
Options only(Options options, std::initializer_list<std::string_view> names);

/// The keyword arguments of one call of a function.
class Keywords {
public:
    explicit Keywords(const py::dict& given) : left_(given.attr("copy")()) {}

    /// Leaves out arguments that are None: they stand for what is not given.
    void dropNone();
    /// Sets the options that are given. Throws UsageError for a value out of its range, and
    /// TypeError for one of another type.
    void set(const Options& options);
    /// The first option that was set and is not for the kinds `inputs` (OptionRow::inputs), or
    /// null.
    const jobs::OptionRow* misplaced(unsigned inputs) const;
    /// The argument, or None.
    py::object take(const char* name);
    /// Throws TypeError if there are arguments that nobody took.
    void finish() const;
    /// Throws UsageError if keys are left of a dict called `name` whose keys are those options.
    void finish(std::string_view name, const Options& options) const;

private:
    py::dict left_;
    std::vector<const jobs::OptionRow*> set_ = {};
};

/// Sets the options from the keyword arguments of a function that takes no others but `progress`,
/// which is returned. Throws as Keywords does.
py::object optionsFrom(const py::kwargs& keywords, const Options& options);

/// A function with arguments by place, and behind them options and `progress`.
struct OptionFunction {
    const char* name;
    std::string before;  ///< arguments by place, "brdf: BrdfLike"
    Options options;     ///< with their defaults
    std::string result;  ///< "Projection"
    std::string text;    ///< the beginning of the docstring
    /// Further arguments that are None where they are not given, with their types.
    std::vector<std::pair<std::string, std::string>> others = {};
    bool progress = true;  ///< it takes that argument
};
/// The docstring: a signature as pybind11 writes it, the text, and a line for each option.
std::string docstring(const OptionFunction& function);

/// Defines it in a class; `arguments` are py::arg by place after self. The method takes py::kwargs
/// last.
template <class Function, class... Arguments>
void defineMethod(const py::object& type, const OptionFunction& function, Function call,
                  const Arguments&... arguments) {
    py::options signatures;
    signatures.disable_function_signatures();
    type.attr(function.name) = py::cpp_function(call, py::name(function.name), py::is_method(type),
                                                arguments..., docstring(function).c_str());
}

/// Defines it in the module; `arguments` are py::arg by place. The function takes py::kwargs last.
template <class Function, class... Arguments>
void define(py::module_& module, const OptionFunction& function, Function call,
            const Arguments&... arguments) {
    py::options signatures;
    signatures.disable_function_signatures();
    module.def(function.name, call, arguments..., docstring(function).c_str());
}

}  // namespace hshfit::python
