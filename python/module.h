#pragma once

// The parts of the extension module `_hshfit`. Each `bind` function adds the classes and functions
// of one subject; python/hshfit/__init__.py names those that users see. No part has a formula of
// its own: jobs/ and the public headers of brdfs/ and lib/ do the work, without the interpreter's
// lock.

#include <pybind11/pybind11.h>

namespace hshfit::python {

namespace py = pybind11;

void bindErrors(py::module_& module);
void bindBrdf(py::module_& module);
void bindBases(py::module_& module);
void bindCoefficients(py::module_& module);
void bindProjection(py::module_& module);
void bindStudies(py::module_& module);
void bindFit(py::module_& module);
void bindLibraries(py::module_& module);
void bindLight(py::module_& module);
void bindPictures(py::module_& module);
void bindRotation(py::module_& module);
void bindScenes(py::module_& module);
void bindMaterialMaps(py::module_& module);
void bindTrades(py::module_& module);
void bindExports(py::module_& module);
void bindFiles(py::module_& module);
void bindCatalog(py::module_& module);

}  // namespace hshfit::python
