#include "arrays.h"
#include "job_options.h"
#include "watched.h"

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/spelling.h>
#include <hshfit/stop_request.h>

#include <jobs/lighting/rotate.h>
#include <jobs/studies/plot.h>

#include <pybind11/stl.h>

#include <algorithm>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

namespace hshfit::python {
namespace {

std::string innerName(const Basis& basis) {
    return basis.inner() == Basis::Inner::solidAngle ? "solid_angle" : "projected_solid_angle";
}

py::array_t<double> valuesOf(const Basis& basis, const py::object& directions) {
    const Vectors vectors = vectorsOf(directions, "directions");
    const DirectionColumns columns(directionsIn(vectors, "directions"));
    Shape shape = vectors.shape;
    shape.push_back(basis.slots());
    py::array_t<double> values(shape);
    double* to = values.mutable_data();
    // A whole number of lanes, some 0.1 s at the highest orders.
    constexpr std::size_t some = 64;
    watched(py::none(), {}, [&](const jobs::Listener&) {
        DirectionBatch batch = columns.batch();
        const auto slots = static_cast<std::size_t>(basis.slots());
        for (std::size_t first = 0; first < vectors.count; first += some, to += some * slots) {
            stopIfRequested();
            basis.evaluate({batch.x + first, batch.y + first, batch.z + first,
                            std::min(some, vectors.count - first)},
                           to);
        }
    });
    return values;
}

py::array_t<bool> functionsOf(const Basis& basis) {
    py::array_t<bool> has(Shape{basis.slots()});
    bool* to = has.mutable_data();
    for (int l = 0; l < basis.order(); ++l)
        for (int m = -l; m <= l; ++m) to[slotOf(l, m)] = basis.has(l, m);
    return has;
}

/// Degree l and order m of every slot.
std::pair<py::array_t<int>, py::array_t<int>> indicesOf(const Basis& basis) {
    py::array_t<int> ls(Shape{basis.slots()}), ms(Shape{basis.slots()});
    for (int l = 0; l < basis.order(); ++l) {
        for (int m = -l; m <= l; ++m) {
            ls.mutable_data()[slotOf(l, m)] = l;
            ms.mutable_data()[slotOf(l, m)] = m;
        }
    }
    return {ls, ms};
}

std::string reprOf(const Basis& basis) {
    return "<hshfit.Basis " + basis.name() + ", order " + std::to_string(basis.order()) + ">";
}

/// The domain is given by its name.
Options optionsOf(jobs::PlotOptions& options) {
    return without(boundOptions(jobs::plotOptions(), options), {"sphere"});
}

py::dict plotted(const std::string& basis, const py::object& path, const py::kwargs& keywords) {
    jobs::PlotOptions options;
    Keywords given(keywords);
    given.set(optionsOf(options));
    const py::object named = given.take("domain");
    given.finish();
    constexpr std::string_view domains[] = {"hemisphere", "sphere"};
    const std::string domain = named.is_none() ? "hemisphere" : named.cast<std::string>();
    if (std::ranges::find(domains, domain) == std::end(domains))
        throw spelling::unknown("domain", domain, domains);
    options.sphere = domain == "sphere";
    const std::string output = pathOf(path, "path");
    jobs::Plotted done;
    watched(py::none(), {},
            [&](const jobs::Listener&) { done = jobs::plot(basis, output, options); });
    py::dict out;
    out["basis"] = done.basis;
    out["order"] = done.order;
    out["functions"] = done.functions;
    return out;
}

}  // namespace

void bindBases(py::module_& module) {
    py::class_<Basis>(
        module, "Basis",
        R"(Real functions on the hemisphere (for "sh" on the sphere) in bands l = 0 .. order-1.

Slot l(l+1)+m has the function of degree l and order m; see catalog("bases") for names, formulas'
sources and the largest orders. Throws UsageError for others.)")
        .def(py::init([](const std::string& name, int order, bool condonShortley) {
                 const py::gil_scoped_release released;
                 return bases::make(name, order, {.condonShortley = condonShortley});
             }),
             py::arg("name"), py::arg("order"), py::kw_only(), py::arg("condon_shortley") = false)
        .def_property_readonly("name", &Basis::name)
        .def_property_readonly("order", &Basis::order)
        .def_property_readonly("slots", &Basis::slots, "order^2")
        .def_property_readonly("condon_shortley", &Basis::condonShortley)
        .def_property_readonly("inner", innerName,
                               "The inner product in which energies are measured: \"solid_angle\"\n"
                               "or \"projected_solid_angle\".")
        .def_property_readonly("has", functionsOf,
                               "(slots,), whether a slot has a function that can be non-zero.")
        .def_property_readonly("indices", indicesOf, "Degrees l and orders m, both (slots,).")
        .def("__call__", valuesOf, py::arg("directions"),
             "All functions at unit vectors (..., 3): (..., slots).")
        .def("__repr__", reprOf);
    jobs::PlotOptions options;
    define(module,
           {.name = "plot",
            .before = "basis: str, path: Path",
            .options = optionsOf(options),
            .result = "Row",
            .text = R"(Draw the functions of a basis by gnuplot to a .png, .svg or .pdf (Fig. 10 of
Gautron et al. 2004), over the domain "hemisphere" (None) or "sphere". OutputError without
gnuplot.)",
            .others = {{"domain", "Optional[str]"}},
            .progress = false},
           plotted, py::arg("basis"), py::arg("path"));
}

}  // namespace hshfit::python
