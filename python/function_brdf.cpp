#include "function_brdf.h"

#include "arrays.h"

#include <hshfit/error.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <utility>

namespace hshfit::python {
namespace {

/// [direction][channel] of the function's answer to `out`, [channel][direction]. Throws as
/// doublesOf does, and UsageError for a shape that does not go with n directions.
void take(const py::object& answer, std::size_t count, std::size_t channels,
          const std::string& name, double* out) {
    const Doubles values = doublesOf(answer, (name + ": the answer of the function").c_str());
    // Axes of the directions and of the channels; an axis of length 1 stands for all.
    py::ssize_t direction = 0, channel = 0;
    const py::ssize_t axes = values.ndim();
    const bool perChannel = axes > 0 && axes <= 2 && (axes == 2 || channels > 1);
    const auto n = static_cast<py::ssize_t>(count), c = static_cast<py::ssize_t>(channels);
    const auto stepOf = [&](py::ssize_t axis, py::ssize_t length) {
        const py::ssize_t have = values.shape(axis);
        if (have == 1 || have == length) return have == 1 ? 0 : values.strides(axis);
        const Shape shape(values.shape(), values.shape() + axes);
        throw UsageError(fmt::format(
            "{}: for {} directions the function returned an array of shape ({}); right would be "
            "({}{})",
            name, count, fmt::join(shape, ", "), count,
            channels == 1 ? std::string(",") : fmt::format(", {}", channels)));
    };
    if (axes > 2)
        stepOf(0, -1);
    else if (axes == 1 && !perChannel)
        direction = stepOf(0, n);
    else if (axes == 1)
        // One colour for all directions.
        channel = stepOf(0, c);
    else if (axes == 2) {
        direction = stepOf(0, n);
        channel = stepOf(1, c);
    }
    const auto* data = reinterpret_cast<const char*>(values.data());
    for (py::ssize_t j = 0; j < c; ++j)
        for (py::ssize_t k = 0; k < n; ++k)
            out[j * n + k] = *reinterpret_cast<const double*>(data + k * direction + j * channel);
}

}  // namespace

FunctionBrdf::FunctionBrdf(py::object function, FunctionFacts facts)
    : function_(std::move(function)), facts_(std::move(facts)) {}

FunctionBrdf::~FunctionBrdf() {
    const py::gil_scoped_acquire lock;
    function_ = py::object();
    raised_ = nullptr;
}

std::shared_ptr<FunctionBrdf> FunctionBrdf::fresh() const {
    return std::make_shared<FunctionBrdf>(function_, facts_);
}

void FunctionBrdf::rethrow() const {
    const std::lock_guard lock(mutex_);
    if (raised_) std::rethrow_exception(raised_);
}

void FunctionBrdf::call(const Direction& wo, const DirectionBatch& wi, double* out) const {
    const py::gil_scoped_acquire lock;
    try {
        py::array_t<double> incoming(Shape{static_cast<py::ssize_t>(wi.count), 3});
        double* to = incoming.mutable_data();
        for (std::size_t k = 0; k < wi.count; ++k) {
            *to++ = wi.x[k];
            *to++ = wi.y[k];
            *to++ = wi.z[k];
        }
        py::array_t<double> outgoing(Shape{3});
        std::copy_n(&wo.x, 3, outgoing.mutable_data());
        take(function_(incoming, outgoing), wi.count, facts_.channels.count(), facts_.name, out);
    } catch (...) {
        stopped_ = true;
        const std::lock_guard kept(mutex_);
        if (!raised_) raised_ = std::current_exception();
    }
}

void FunctionBrdf::eval(const Direction& wo, DirectionBatch wi, double* out) const {
    const std::size_t channels = facts_.channels.count();
    if (!(wo.z > 0)) {
        std::fill_n(out, channels * wi.count, 0.0);
        return;
    }
    if (!stopped_) call(wo, wi, out);
    if (stopped_) {
        std::fill_n(out, channels * wi.count, std::numeric_limits<double>::quiet_NaN());
        return;
    }
    for (std::size_t k = 0; k < wi.count; ++k)
        for (std::size_t c = 0; c < channels && !(wi.z[k] > 0); ++c) out[c * wi.count + k] = 0;
}

std::vector<Lobe> FunctionBrdf::lobes(const Direction&) const {
    if (!(facts_.halfwayWidth > 0)) return {};
    return {{.about = Lobe::About::halfway, .width = facts_.halfwayWidth}};
}

}  // namespace hshfit::python
