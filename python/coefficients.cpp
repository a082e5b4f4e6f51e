#include "answers.h"
#include "arrays.h"
#include "rotation.h"
#include "watched.h"

#include <hshfit/coefficient_files/coefficient_file.h>
#include <hshfit/coefficient_files/representation_file.h>
#include <hshfit/coefficients/reconstruction.h>
#include <hshfit/error.h>
#include <hshfit/representation/forms/represented_brdf.h>

#include <jobs/source/source.h>

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <memory>
#include <string>
#include <utility>

namespace hshfit::python {
namespace {

Shape shapeOf(const Coefficients& c) {
    return {static_cast<py::ssize_t>(c.outgoing.size()),
            static_cast<py::ssize_t>(c.channels.count()), static_cast<py::ssize_t>(c.slots())};
}

py::array_t<double> valuesOf(const py::object& self) {
    const auto& c = self.cast<const Coefficients&>();
    return viewOf(c.values.data(), shapeOf(c), self);
}

std::shared_ptr<Coefficients> withValues(const Coefficients& c, const py::object& values) {
    const Doubles given = doublesOf(values, "values");
    const Shape shape = shapeOf(c);
    if (Shape(given.shape(), given.shape() + given.ndim()) != shape)
        throw UsageError(fmt::format("values: numbers of shape ({}, {}, {}), as `values` has",
                                     shape[0], shape[1], shape[2]));
    auto changed = std::make_shared<Coefficients>(c);
    changed->values = numbersOf(values, "values");
    return changed;
}

template <class Value>
void save(const Value& value, const py::object& path,
          void (*write)(const Value&, const std::string&)) {
    const std::string output = pathOf(path, "path");
    const py::gil_scoped_release released;
    write(value, output);
}

std::pair<std::shared_ptr<Coefficients>, py::dict> rotated(const Coefficients& c,
                                                           const Rotation& rotation,
                                                           const py::kwargs& keywords) {
    const jobs::RotateOptions options = rotationBy(rotation, keywords);
    auto turned = std::make_shared<Coefficients>(c);
    jobs::Rotated done;
    watched(py::none(), {}, [&](const jobs::Listener&) { done = jobs::rotate(*turned, options); });
    return {turned, rotatedDict(done)};
}

py::array_t<double> anglesOf(const OutgoingSet& set) {
    std::vector<double> values;
    for (const Direction& d : set.directions)
        values.insert(values.end(), {degrees(polarAngle(d)), degrees(azimuth(d))});
    return arrayOf(std::move(values), {static_cast<py::ssize_t>(set.size()), 2});
}

std::string mapName(const OutgoingSet& set) {
    switch (set.map) {
        case OutgoingSet::Map::parabolic:
            return "parabolic";
        case OutgoingSet::Map::elevations:
            return "elevations";
        default:
            return "direction";
    }
}

void bindOutgoing(py::module_& module) {
    py::class_<OutgoingSet>(
        module, "Outgoing",
        R"(The outgoing directions for which coefficients are kept: "32x32" (texels of a
parabolic map), 16 (elevations, for isotropic BRDFs) or (theta, phi) in degrees.)")
        .def(py::init([](const py::object& set) { return OutgoingSet::parse(outgoingText(set)); }),
             py::arg("set"))
        .def_property_readonly("spec", &OutgoingSet::spec)
        .def_property_readonly("map", mapName, "\"parabolic\", \"elevations\" or \"direction\".")
        .def_property_readonly(
            "directions", [](const OutgoingSet& set) { return arrayOf(set.directions); },
            "Unit vectors (n, 3), row by row.")
        .def_property_readonly("angles", anglesOf, "(theta, phi) in degrees, (n, 2).")
        .def_property_readonly(
            "solid_angles",
            [](const OutgoingSet& set) {
                return arrayOf(set.solidAngles, {static_cast<py::ssize_t>(set.size())});
            },
            "Solid angles in sr that the directions stand for, (n,).")
        .def("__len__", &OutgoingSet::size)
        .def("__repr__",
             [](const OutgoingSet& set) { return "<hshfit.Outgoing " + set.spec() + ">"; });
}

/// The head of coefficients and of compressed forms.
template <class Class, class Head>
void addHead(Class& bound, Head head) {
    bound
        .def_property_readonly("basis",
                               [=](const typename Class::type& v) { return head(v).basis; })
        .def_property_readonly("order",
                               [=](const typename Class::type& v) { return head(v).order; })
        .def_property_readonly(
            "condon_shortley",
            [=](const typename Class::type& v) { return head(v).condonShortley; })
        .def_property_readonly(
            "quantity",
            [=](const typename Class::type& v) { return quantityName(head(v).quantity); },
            "\"brdf\" for f, \"brdf_cosine\" for f cos(theta_i).")
        .def_property_readonly(
            "channels", [=](const typename Class::type& v) { return head(v).channels.names(); })
        .def_property_readonly("outgoing",
                               [=](const typename Class::type& v) { return head(v).outgoing; })
        .def_property_readonly(
            "energy", [=](const typename Class::type& v) { return energyDict(head(v).energy); },
            "Of the projected function, with its absolute error (Eq. 15's denominator).")
        .def_property_readonly(
            "error", [=](const typename Class::type& v) { return head(v).error; },
            "Estimated relative error of quadrature.")
        .def_property_readonly("source",
                               [=](const typename Class::type& v) { return head(v).source; });
}

void bindPlain(py::module_& module) {
    py::class_<Coefficients, std::shared_ptr<Coefficients>> bound(
        module, "Coefficients",
        R"(Coefficients c_{l,m}(wo) of one BRDF over wi, for a set of outgoing directions:
    q(wi, wo) = sum of c_{l,m}(wo) B_{l,m}(wi),  q = f or f cos(theta_i)
(Gautron et al. 2004, Eq. 16). Made by project() and read().)");
    addHead(bound, [](const Coefficients& c) -> const CoefficientHead& { return c; });
    bound
        .def_property_readonly("values", valuesOf,
                               "Read-only (outgoing, channels, slots), slot l(l+1)+m, in place.")
        .def("with_values", withValues, py::arg("values"),
             "A copy with other values of the same shape; energy and error stay as they were.")
        .def(
            "brdf",
            [](const Coefficients& c) -> std::shared_ptr<Brdf> {
                const py::gil_scoped_release released;
                return std::make_shared<Reconstruction>(c);
            },
            "The reconstruction as a Brdf; values ring and may be negative.")
        .def(
            "save",
            [](const Coefficients& c, const py::object& path) {
                save<Coefficients>(c, path, writeCoefficients);
            },
            py::arg("path"), "Write .json (exact) or .exr (float32).")
        .def("__repr__", [](const Coefficients& c) {
            return fmt::format("<hshfit.Coefficients {} order {}, {} directions, {}>", c.basis,
                               c.order, c.outgoing.size(), c.source);
        });
    defineMethod(bound,
                 rotateMethod("Coefficients", R"(For each outgoing direction the function over wi,
rotated; what leaves the hemisphere is lost. Returns (Coefficients, {"method", "lost_energy",
"error", "bands"}).)"),
                 rotated, py::arg("rotation"));
}

std::vector<std::pair<std::string, double>> stepsOf(const Representation& form) {
    std::vector<std::pair<std::string, double>> steps;
    for (const RepresentationStep& step : form.steps) steps.emplace_back(step.what, step.change);
    return steps;
}

void bindForm(py::module_& module) {
    py::class_<Representation, std::shared_ptr<Representation>> bound(
        module, "Form",
        R"(A BRDF in a compressed form, as a coefficient file holds it. Made by project() with
an option of forms, and by read().)");
    addHead(bound, [](const Representation& form) -> const CoefficientHead& { return form.head; });
    bound
        .def_property_readonly(
            "kind", [](const Representation& form) { return std::string(kindName(form.kind())); },
            "\"outgoing\", \"basis\" or \"halfway\".")
        .def_property_readonly("bytes", &Representation::bytes, "Of all arrays as stored.")
        .def_property_readonly("entropy_bytes", &Representation::entropyBytes,
                               "The same after Zstandard.")
        .def_property_readonly("numbers", &Representation::numbers, "The count of stored numbers.")
        .def_property_readonly(
            "added", [](const Representation& form) { return form.added; },
            "The specification of the BRDF that is added exactly.")
        .def_property_readonly("steps", stepsOf,
                               "(step, relative change in L2) of each step that changed numbers.")
        .def(
            "brdf",
            [](const Representation& form) -> std::shared_ptr<Brdf> {
                const py::gil_scoped_release released;
                return reconstruct(form, jobs::sourceOpener());
            },
            "The form as a Brdf.")
        .def(
            "decoded",
            [](const Representation& form) {
                const py::gil_scoped_release released;
                return std::make_shared<Coefficients>(decoded(form));
            },
            "Plain coefficients of the kind \"outgoing\", without what is added.")
        .def(
            "save",
            [](const Representation& form, const py::object& path) {
                save<Representation>(form, path, writeRepresentation);
            },
            py::arg("path"), "Write .json; plain coefficients also as .exr.")
        .def("__repr__", [](const Representation& form) {
            return fmt::format("<hshfit.Form {}, {} numbers in {} bytes, {}>",
                               kindName(form.kind()), form.numbers(), form.bytes(),
                               form.head.source);
        });
}

}  // namespace

void bindCoefficients(py::module_& module) {
    bindOutgoing(module);
    bindPlain(module);
    bindForm(module);
}

}  // namespace hshfit::python
