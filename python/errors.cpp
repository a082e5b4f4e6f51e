#include "module.h"

#include <hshfit/error.h>

#include <exception>
#include <string>

namespace hshfit::python {
namespace {

/// The classes of Python, which live as long as the interpreter.
PyObject* errorClass = nullptr;
PyObject* usageClass = nullptr;
PyObject* inputClass = nullptr;
PyObject* numericClass = nullptr;
PyObject* outputClass = nullptr;

PyObject* newClass(py::module_& module, const char* name, const char* doc, PyObject* base,
                   ExitCode code) {
    py::dict members;
    members["exit_code"] = static_cast<int>(code);
    PyObject* made = PyErr_NewExceptionWithDoc((std::string("hshfit.") + name).c_str(), doc, base,
                                               members.ptr());
    if (!made) throw py::error_already_set();
    module.add_object(name, py::handle(made));
    return made;
}

PyObject* classOf(const Error& error) {
    switch (error.code()) {
        case ExitCode::usage:
            return usageClass;
        case ExitCode::input:
            return inputClass;
        case ExitCode::numeric:
            return numericClass;
        case ExitCode::output:
            return outputClass;
        default:
            return errorClass;
    }
}

}  // namespace

void bindErrors(py::module_& module) {
    errorClass = newClass(module, "Error",
                          "A failure with a message of one line. `exit_code` is that of the\n"
                          "program hshfit for the same failure.",
                          PyExc_Exception, ExitCode::done);
    usageClass = newClass(module, "UsageError",
                          "An argument or a specification that cannot be understood (2).",
                          errorClass, ExitCode::usage);
    inputClass = newClass(module, "InputError",
                          "A file that cannot be read, or values that are invalid (3).", errorClass,
                          ExitCode::input);
    numericClass =
        newClass(module, "NumericError", "Numbers that do not exist or did not converge (4).",
                 errorClass, ExitCode::numeric);
    outputClass = newClass(module, "OutputError",
                           "A file that could not be written; nothing half-written is left (5).",
                           errorClass, ExitCode::output);
    py::register_exception_translator([](std::exception_ptr thrown) {
        try {
            if (thrown) std::rethrow_exception(thrown);
        } catch (const Error& error) {
            PyErr_SetString(classOf(error), error.what());
        }
    });
}

}  // namespace hshfit::python
