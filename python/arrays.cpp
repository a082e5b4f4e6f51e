#include "arrays.h"

#include <hshfit/coefficients/outgoing.h>
#include <hshfit/error.h>
#include <hshfit/files/json_fields.h>

#include <jobs/common/pair_file.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <limits>
#include <memory>
#include <string_view>
#include <utility>

namespace hshfit::python {
namespace {

constexpr py::ssize_t bytes = sizeof(double);

/// Whether steps between numbers are whole numbers of them, as in all arrays but views of records.
bool isRegular(const Doubles& array) {
    for (py::ssize_t axis = 0; axis < array.ndim(); ++axis)
        if (array.strides(axis) % bytes != 0) return false;
    return true;
}

Doubles reshaped(const Doubles& array, const Shape& shape) {
    return Doubles(array.attr("reshape")(py::cast(std::vector<py::ssize_t>(shape))));
}

Vectors fromArray(Doubles array, const char* name) {
    const py::ssize_t axes = array.ndim();
    if (axes == 0 || array.shape(axes - 1) != 3) {
        const Shape shape(array.shape(), array.shape() + axes);
        throw UsageError(fmt::format("{}: unit vectors as an array of shape (..., 3), not ({})",
                                     name, fmt::join(shape, ", ")));
    }
    Vectors vectors;
    vectors.shape.assign(array.shape(), array.shape() + axes - 1);
    for (const py::ssize_t n : vectors.shape) vectors.count *= static_cast<std::size_t>(n);
    if (!isRegular(array)) array = Doubles(array.attr("copy")());
    if (axes > 2) array = reshaped(array, {static_cast<py::ssize_t>(vectors.count), 3});
    vectors.array = array;
    const py::ssize_t last = array.ndim() - 1;
    vectors.data = {.data = array.data(),
                    .stride = last == 0 ? 0 : array.strides(0) / bytes,
                    .step = array.strides(last) / bytes};
    return vectors;
}

/// The kind of numbers in what NumPy makes an array of: 'f', 'i', …; '\0' where it makes none.
char kindOf(const py::object& argument) {
    try {
        const py::object array = py::module_::import("numpy").attr("asarray")(argument);
        return py::cast<py::array>(array).dtype().kind();
    } catch (py::error_already_set&) {
        return '\0';  // rows of several lengths, or no sequence
    }
}

}  // namespace

Doubles doublesOf(const py::object& argument, const char* name) {
    // An array of float64 of NumPy's own class is taken as it is.
    const bool plain = Py_TYPE(argument.ptr()) == py::detail::npy_api::get().PyArray_Type_ &&
                       Doubles::check_(argument);
    if (!plain) {
        if (py::module_::import("numpy.ma").attr("isMaskedArray")(argument).cast<bool>())
            throw py::type_error(
                fmt::format("{}: a masked array; give its filled() or compressed() numbers", name));
        const char kind = kindOf(argument);
        if (kind == 'c')
            throw py::type_error(fmt::format("{}: complex numbers; give real ones", name));
        if (std::string_view("biufO").find(kind) == std::string_view::npos)
            throw py::type_error(fmt::format("{}: no array of numbers", name));
    }
    Doubles array = Doubles::ensure(argument);
    if (array) return array;
    PyErr_Clear();
    throw py::type_error(fmt::format("{}: no array of numbers", name));
}

Vectors vectorsOf(const py::object& argument, const char* name) {
    return fromArray(doublesOf(argument, name), name);
}

std::pair<Vectors, Vectors> broadcast(const py::object& a, const char* nameOfA, const py::object& b,
                                      const char* nameOfB) {
    Vectors first = vectorsOf(a, nameOfA), second = vectorsOf(b, nameOfB);
    if (first.shape == second.shape) return {std::move(first), std::move(second)};
    if (first.shape.empty() || second.shape.empty()) {
        Vectors& one = first.shape.empty() ? first : second;
        const Vectors& many = first.shape.empty() ? second : first;
        one.shape = many.shape;
        one.count = many.count;
        return {std::move(first), std::move(second)};
    }
    py::tuple both;
    try {
        both = py::module_::import("numpy").attr("broadcast_arrays")(doublesOf(a, nameOfA),
                                                                     doublesOf(b, nameOfB));
    } catch (py::error_already_set& error) {
        if (!error.matches(PyExc_ValueError)) throw;
        throw UsageError(fmt::format("{} and {}: shapes ({}, 3) and ({}, 3) do not go together",
                                     nameOfA, nameOfB, fmt::join(first.shape, ", "),
                                     fmt::join(second.shape, ", ")));
    }
    return {fromArray(Doubles(both[0]), nameOfA), fromArray(Doubles(both[1]), nameOfB)};
}

std::vector<Direction> directionsIn(const Vectors& vectors, const char* name) {
    std::vector<Direction> directions;
    directions.reserve(vectors.count);
    for (std::size_t k = 0; k < vectors.count; ++k)
        directions.push_back(jobs::unitDirection(vectors.data.at(k),
                                                 [&] { return fmt::format("{}[{}]", name, k); }));
    return directions;
}

DirectionColumns::DirectionColumns(const std::vector<Direction>& directions) {
    for (const Direction& d : directions) {
        x.push_back(d.x);
        y.push_back(d.y);
        z.push_back(d.z);
    }
}

py::array_t<double> arrayOf(std::vector<double> values, const Shape& shape) {
    auto kept = std::make_unique<std::vector<double>>(std::move(values));
    const double* data = kept->data();
    const py::capsule owner(kept.get(),
                            [](void* v) { delete static_cast<std::vector<double>*>(v); });
    kept.release();
    return py::array_t<double>(shape, data, owner);
}

py::array_t<double> viewOf(const double* values, const Shape& shape, const py::object& owner) {
    py::array_t<double> view(shape, values, owner);
    view.attr("setflags")(py::arg("write") = false);
    return view;
}

py::array_t<double> arrayOf(const std::vector<Direction>& directions) {
    std::vector<double> values;
    values.reserve(3 * directions.size());
    for (const Direction& d : directions) values.insert(values.end(), {d.x, d.y, d.z});
    return arrayOf(std::move(values), {static_cast<py::ssize_t>(directions.size()), 3});
}

std::vector<double> numbersOf(const py::object& argument, const char* name) {
    const auto array = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(
        doublesOf(argument, name));
    return {array.data(), array.data() + array.size()};
}

py::object fromJson(const nlohmann::ordered_json& document) {
    return py::module_::import("json").attr("loads")(jsonText(document));
}

std::string pathOf(const py::object& path, const char* name) {
    if (py::isinstance<py::str>(path)) return path.cast<std::string>();
    if (py::hasattr(path, "__fspath__"))
        return py::module_::import("os").attr("fspath")(path).cast<std::string>();
    throw py::type_error(
        fmt::format("{}: a string or a path, not {}", name,
                    py::str(path.get_type().attr("__name__")).cast<std::string>()));
}

std::vector<std::string> pathsOf(const py::object& paths, const char* name) {
    const bool one = py::isinstance<py::str>(paths) || py::hasattr(paths, "__fspath__");
    std::vector<std::string> all;
    for (const py::handle path : one ? py::object(py::make_tuple(paths)) : paths)
        all.push_back(pathOf(py::reinterpret_borrow<py::object>(path), name));
    return all;
}

std::string outgoingText(const py::object& outgoing) {
    if (outgoing.is_none()) return {};
    if (py::isinstance<OutgoingSet>(outgoing)) return outgoing.cast<const OutgoingSet&>().spec();
    if (py::isinstance<py::tuple>(outgoing) && py::len(outgoing) == 2) {
        const auto [theta, phi] = outgoing.cast<std::pair<double, double>>();
        return fmt::format("{},{}", theta, phi);
    }
    return py::str(outgoing).cast<std::string>();
}

std::string listText(const py::object& names) {
    if (py::isinstance<py::str>(names)) return names.cast<std::string>();
    std::string text;
    for (const py::handle name : names)
        text += (text.empty() ? "" : ",") + py::str(name).cast<std::string>();
    return text;
}

void requireWithin(const char* name, double value, double low, double high) {
    if (value >= low && value <= high) return;
    throw UsageError(fmt::format("{}: {} is not from {} to {}", name, value, low, high));
}

double orNaN(const std::optional<double>& value) {
    return value.value_or(std::numeric_limits<double>::quiet_NaN());
}

}  // namespace hshfit::python
