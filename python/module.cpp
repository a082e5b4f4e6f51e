#include "module.h"

#include "wording.h"

#include <hshfit/version.h>
#include <hshfit/wording.h>

#include <brdfs/fit/solver_log.h>

#include <pybind11/numpy.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <memory>
#include <optional>

namespace hshfit::python {
namespace {

/// Threads of all work in the process; none: as oneTBB has them. Changed under the interpreter's
/// lock.
std::optional<tbb::global_control>& threadLimit() {
    static std::optional<tbb::global_control> limit;
    return limit;
}

void setThreads(std::size_t count) {
    threadLimit().reset();
    if (count > 0) threadLimit().emplace(tbb::global_control::max_allowed_parallelism, count);
}

std::size_t threads() {
    return tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
}

}  // namespace
}  // namespace hshfit::python

PYBIND11_MODULE(_hshfit, module) {
    using namespace hshfit::python;
    namespace py = pybind11;
    hshfit::setWording(pythonWording());
    // pybind11 loads NumPy at the first array, once, under a lock of C++: a thread that waits for
    // this lock holds the interpreter's, which loading needs. So it is done here.
    py::array_t<double>(0);
    // Results of fits have the reasons of searches that fail; the log of Ceres says no more.
    hshfit::brdfs::takeSolverLog([](const std::string&) {});
    module.doc() = "The compiled part of hshfit; import hshfit instead.";
    module.attr("__version__") = hshfit::version;
    module.def("set_threads", setThreads, py::arg("count"),
               "Limit the threads of all later work in this process; 0: all cores. No result\n"
               "depends on their number.");
    module.def("threads", threads, "The number of threads that work may use.");
    bindErrors(module);
    bindBrdf(module);
    bindBases(module);
    bindCoefficients(module);
    bindRotation(module);
    bindProjection(module);
    bindStudies(module);
    bindFit(module);
    bindLibraries(module);
    bindLight(module);
    bindPictures(module);
    bindScenes(module);
    bindMaterialMaps(module);
    bindTrades(module);
    bindExports(module);
    bindFiles(module);
    bindCatalog(module);
}
