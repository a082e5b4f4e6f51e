#include "rotation.h"
#include "arrays.h"
#include "watched.h"

#include <hshfit/error.h>

#include <jobs/lighting/rotate.h>

#include <pybind11/stl.h>

#include <string>
#include <utility>
#include <vector>

namespace hshfit::python {
namespace {

Rotation rotationFrom(const py::object& euler, const py::object& axis, const py::object& up,
                      const py::object& matrix) {
    const int given = !euler.is_none() + !axis.is_none() + !up.is_none() + !matrix.is_none();
    if (given != 1)
        throw UsageError(std::to_string(given) +
                         " rotations; give one of euler=(a, b, c), axis=(x, y, z, angle), "
                         "up=(theta, phi), all in degrees, and matrix=(3, 3)");
    const auto numbers = [](const py::object& argument, std::size_t count, const char* name) {
        std::vector<double> values = numbersOf(argument, name);
        if (values.size() != count)
            throw UsageError(std::string(name) + ": " + std::to_string(count) + " numbers, not " +
                             std::to_string(values.size()));
        return values;
    };
    if (!euler.is_none()) {
        const auto a = numbers(euler, 3, "euler");
        return Rotation::euler(radians(a[0]), radians(a[1]), radians(a[2]));
    }
    if (!axis.is_none()) {
        const auto a = numbers(axis, 4, "axis");
        return Rotation::aboutAxis({a[0], a[1], a[2]}, radians(a[3]));
    }
    if (!up.is_none()) {
        const auto a = numbers(up, 2, "up");
        return Rotation::zTo(directionFromAngles(radians(a[0]), radians(a[1])));
    }
    const auto rows = numbers(matrix, 9, "matrix");
    std::array<double, 9> array{};
    std::copy(rows.begin(), rows.end(), array.begin());
    return Rotation::fromMatrix(array);
}

py::array_t<double> turned(const Rotation& rotation, const py::object& vectors) {
    const Vectors given = vectorsOf(vectors, "directions");
    std::vector<double> values;
    for (std::size_t k = 0; k < given.count; ++k) {
        const Direction d = rotation(given.data.at(k));
        values.insert(values.end(), {d.x, d.y, d.z});
    }
    Shape shape = given.shape;
    shape.push_back(3);
    return arrayOf(std::move(values), shape);
}

/// A Rotation is given in the place of three angles.
Options optionsOf(jobs::MatrixOptions& options) {
    return without(boundOptions(jobs::matrixOptions(), options), {"euler"});
}

py::array_t<double> matrixOf(const std::string& from, const std::string& to,
                             const py::kwargs& keywords) {
    jobs::MatrixOptions options{.from = from, .to = to};
    Keywords given(keywords);
    given.set(optionsOf(options));
    if (const py::object rotation = given.take("rotation"); !rotation.is_none())
        options.rotation = rotation.cast<const Rotation&>();
    given.finish();
    std::vector<std::vector<double>> rows;
    watched(py::none(), {}, [&](const jobs::Listener&) { rows = jobs::matrix(options); });
    std::vector<double> values;
    for (const auto& row : rows) values.insert(values.end(), row.begin(), row.end());
    const int columns = options.orderOfFrom();
    return arrayOf(std::move(values), {options.order * options.order, columns * columns});
}

/// The rotation itself is given as one.
Options optionsOf(jobs::RotateOptions& options) {
    return without(boundOptions(jobs::rotateOptions(), options), {"euler", "axis", "up"});
}

}  // namespace

jobs::RotateOptions rotationBy(const Rotation& rotation, const py::kwargs& keywords) {
    jobs::RotateOptions options{.rotation = rotation};
    Keywords given(keywords);
    given.set(optionsOf(options));
    given.finish();
    return options;
}

OptionFunction rotateMethod(const std::string& type, const std::string& text) {
    jobs::RotateOptions options;
    return {.name = "rotate",
            .before = "self: " + type + ", rotation: Rotation",
            .options = optionsOf(options),
            .result = "Tuple[" + type + ", Row]",
            .text = text,
            .progress = false};
}

py::dict rotatedDict(const jobs::Rotated& done) {
    py::dict out;
    out["method"] = methodName(done.method);
    out["lost_energy"] = done.lostEnergy;
    out["error"] = done.error;
    out["bands"] = done.bands;
    return out;
}

void bindRotation(py::module_& module) {
    py::class_<Rotation>(
        module, "Rotation",
        R"(A rotation of directions, active: the vector d becomes R d, and a function f becomes
f(R^-1 d). Angles in degrees. One of
euler   (a, b, c): R_z(a) R_y(b) R_z(c)
axis    (x, y, z, angle): right-handed
up      (theta, phi): where +z goes, along the shortest arc
matrix  (3, 3), orthonormal within 1e-6)")
        .def(py::init(&rotationFrom), py::kw_only(), py::arg("euler") = py::none(),
             py::arg("axis") = py::none(), py::arg("up") = py::none(),
             py::arg("matrix") = py::none())
        .def_property_readonly("matrix",
                               [](const Rotation& r) {
                                   const auto& rows = r.matrix();
                                   return arrayOf({rows.begin(), rows.end()}, {3, 3});
                               })
        .def("inverse", &Rotation::inverse)
        .def("__call__", turned, py::arg("directions"), "Vectors (..., 3), turned.")
        .def(
            "__matmul__",
            [](const Rotation& second, const Rotation& first) { return second * first; },
            py::arg("first"), "This rotation after `first`.");
    jobs::MatrixOptions options;
    define(module,
           {.name = "matrix",
            .before = "from_basis: str, to_basis: str",
            .options = optionsOf(options),
            .result = "Floats",
            .text = R"(The change of basis (order^2, from_order^2), from_order 0 being order; with a
Rotation from the coefficients of a function to those of the rotated function. UsageError for bases
that it does not have.)",
            .others = {{"rotation", "Optional[Rotation]"}},
            .progress = false},
           matrixOf, py::arg("from_basis"), py::arg("to_basis"));
}

}  // namespace hshfit::python
