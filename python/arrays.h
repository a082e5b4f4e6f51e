#pragma once

// Numbers between NumPy and the library.

#include "module.h"

#include <hshfit/brdf/directions.h>

#include <jobs/common/bounds.h>
#include <jobs/studies/eval.h>

#include <pybind11/numpy.h>
#include <nlohmann/json_fwd.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::python {

using Doubles = py::array_t<double, py::array::forcecast>;
using Shape = std::vector<py::ssize_t>;

/// An argument as an array, in place where it is one of float64. Raises TypeError that begins with
/// `name` for masked arrays, complex numbers and anything else without real numbers.
Doubles doublesOf(const py::object& argument, const char* name);

/// An argument of shape (..., 3), in place where it is an array of float64.
struct Vectors {
    Doubles array;
    Shape shape;  ///< without the last axis
    std::size_t count = 1;
    jobs::VectorArray data;
};
/// Throws as doublesOf does, and UsageError that begins with `name` for another shape.
Vectors vectorsOf(const py::object& argument, const char* name);
/// Two of them, broadcast against each other as NumPy does it.
std::pair<Vectors, Vectors> broadcast(const py::object& a, const char* nameOfA, const py::object& b,
                                      const char* nameOfB);
/// Their unit vectors, in the order of the memory. Throws InputError as unitDirection does.
std::vector<Direction> directionsIn(const Vectors& vectors, const char* name);
/// As three arrays, for batch evaluation.
struct DirectionColumns {
    explicit DirectionColumns(const std::vector<Direction>& directions);
    DirectionBatch batch() const { return {x.data(), y.data(), z.data(), x.size()}; }
    std::vector<double> x, y, z;
};

/// An array that takes the vector over, without a copy.
py::array_t<double> arrayOf(std::vector<double> values, const Shape& shape);
/// A read-only array over memory of `owner`, which it keeps alive.
py::array_t<double> viewOf(const double* values, const Shape& shape, const py::object& owner);
/// Directions as an array (n, 3).
py::array_t<double> arrayOf(const std::vector<Direction>& directions);
/// A copy of a float64 array of `count` numbers, in C order. Throws as doublesOf does.
std::vector<double> numbersOf(const py::object& argument, const char* name);

/// The document as Python's json module reads it.
py::object fromJson(const nlohmann::ordered_json& document);
/// A string, or a path-like object, as a string. Raises TypeError with `name`.
std::string pathOf(const py::object& path, const char* name);
/// The string of one path, or of each path of a sequence.
std::vector<std::string> pathsOf(const py::object& paths, const char* name);
/// An outgoing set as text: "32x32", 16, (52, 0) in degrees, an Outgoing, or None for "".
std::string outgoingText(const py::object& outgoing);
/// Names as a list with commas: a string as it is, or a sequence of strings.
std::string listText(const py::object& names);
/// Throws UsageError with `name` unless low <= value <= high.
void requireWithin(const char* name, double value, double low, double high);
/// Throws UsageError with `name` unless `value` is within the bounds of an option.
template <class Value, class Number>
void requireWithin(const char* name, Value value, const jobs::Bounds<Number>& bounds) {
    requireWithin(name, static_cast<double>(value), static_cast<double>(bounds.least),
                  static_cast<double>(bounds.most));
}
/// An optional number, NaN where there is none.
double orNaN(const std::optional<double>& value);

}  // namespace hshfit::python
