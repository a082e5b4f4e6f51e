#include "arrays.h"
#include "watched.h"

#include <hshfit/error.h>

#include <jobs/scenes/render_json.h>

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <nlohmann/json.hpp>

#include <string>
#include <utility>
#include <vector>

namespace hshfit::python {
namespace {

using By = jobs::RenderOptions::By;

By byFrom(const std::string& name) {
    if (name == "both") return By::both;
    if (name == "integration") return By::integration;
    if (name == "coefficients") return By::coefficients;
    throw UsageError(fmt::format("by: '{}' is none of coefficients, integration and both", name));
}

/// Point lights, tuples, into the rig, and specifications; false if none was given.
bool takeLights(const py::object& light, SphereRig& rig, std::vector<std::string>& specs) {
    if (light.is_none()) return false;
    const bool one = py::isinstance<py::str>(light) || py::hasattr(light, "__fspath__");
    const py::object lights = one ? py::object(py::make_tuple(light)) : light;
    for (const py::handle each : lights) {
        if (!py::isinstance<py::tuple>(each)) {
            specs.push_back(pathOf(py::reinterpret_borrow<py::object>(each), "light"));
            continue;
        }
        const auto numbers = each.cast<std::vector<double>>();
        const double strength = numbers.size() > 2 ? numbers[2] : 1;
        if (numbers.size() < 2 || numbers.size() > 3 || !(numbers[0] >= 0 && numbers[0] <= 180) ||
            !(strength >= 0))
            throw UsageError(
                "light: give (theta, phi) or (theta, phi, strength): degrees from the line of "
                "sight (0 to 180), degrees from the right counterclockwise; or a kind of light or "
                "the path of a picture");
        rig.lights.push_back(
            {directionFromAngles(radians(numbers[0]), radians(numbers[1])), strength});
    }
    return true;
}

/// One value or a sequence of them.
template <class Value>
std::vector<Value> listFrom(const py::object& values) {
    if (py::isinstance<py::str>(values) || !py::hasattr(values, "__iter__"))
        return {values.cast<Value>()};
    return values.cast<std::vector<Value>>();
}

std::optional<double> optionalNumber(const py::object& value) {
    return value.is_none() ? std::nullopt : std::optional(value.cast<double>());
}

py::object render(const py::object& specs, const py::object& path, const py::object& light,
                  const py::object& dome, const py::object& mesh, const std::string& up,
                  const py::object& view, const py::object& fieldOfView, const py::object& by,
                  const py::object& bases, const py::object& orders, bool cosine,
                  const py::object& outgoing, const py::object& exposures,
                  const py::object& exposure, int size, const py::object& samples,
                  const py::object& tolerance, const py::object& seconds,
                  const py::object& progress) {
    namespace bounds = jobs::bounds;
    const std::vector<std::string> sources = pathsOf(specs, "specs");
    const std::string output = pathOf(path, "path");
    requireWithin("size", size, bounds::pictureSize);
    if (up != "y" && up != "z") throw UsageError(fmt::format("up: '{}' is neither y nor z", up));
    jobs::RenderOptions options;
    jobs::SphereSheetOptions sheet;
    const bool lit = takeLights(light, options.rig, options.lights);
    if (!lit) options.rig = SphereRig{};
    if (const auto value = optionalNumber(dome)) {
        requireWithin("dome", *value, bounds::dome);
        options.rig.dome = *value;
    } else if (options.lights.empty()) {
        options.rig.dome = SphereRig{}.dome;
    }
    options.stops = sheet.stops = optionalNumber(exposure);
    options.size = sheet.size = size;
    if (!samples.is_none()) {
        options.samples = sheet.samples = samples.cast<int>();
        requireWithin("samples", options.samples, bounds::pictureSamples);
    }
    nlohmann::ordered_json answer;
    // As the program chooses: any option that spheres under point lights do not have.
    const bool surface = !options.lights.empty() || !mesh.is_none() || !view.is_none() ||
                         !fieldOfView.is_none() || !by.is_none() || !bases.is_none() ||
                         !orders.is_none() || !exposures.is_none() || !seconds.is_none();
    if (!surface) {
        sheet.rig = options.rig;
        watched(progress, {}, [&](const jobs::Listener& listener) {
            answer = jobs::spheresJson(jobs::renderSpheres(sources, output, sheet, listener), sheet,
                                       output);
        });
        return fromJson(answer);
    }
    if (!mesh.is_none()) options.mesh = pathOf(mesh, "mesh");
    options.meshYUp = up == "y";
    if (!by.is_none()) options.by = byFrom(by.cast<std::string>());
    if (!bases.is_none()) options.bases = listFrom<std::string>(bases);
    if (!orders.is_none()) options.orders = listFrom<int>(orders);
    if (!exposures.is_none()) options.exposures = listFrom<double>(exposures);
    options.cosine = cosine;
    options.outgoing = outgoingText(outgoing);
    options.tolerance = optionalNumber(tolerance);
    if (options.tolerance) requireWithin("tolerance", *options.tolerance, bounds::pictureTolerance);
    options.seconds = optionalNumber(seconds);
    if (options.seconds) requireWithin("seconds", *options.seconds, bounds::seconds);
    if (!view.is_none()) {
        const auto [theta, phi] = view.cast<std::pair<double, double>>();
        requireWithin("view", theta, 0, 180);
        options.viewTheta = theta;
        options.viewPhi = phi;
    }
    if (const auto value = optionalNumber(fieldOfView)) {
        requireWithin("field_of_view", *value, bounds::fieldOfView);
        options.fieldOfView = *value;
    }
    watched(progress, {}, [&](const jobs::Listener& listener) {
        answer =
            jobs::renderJson(jobs::render(sources, output, options, listener), options, output);
    });
    return fromJson(answer);
}

}  // namespace

void bindPictures(py::module_& module) {
    const jobs::RenderOptions options;
    module.def("render", render, py::arg("specs"), py::arg("path"), py::kw_only(),
               py::arg("light") = py::none(), py::arg("dome") = py::none(),
               py::arg("mesh") = py::none(), py::arg("up") = "y", py::arg("view") = py::none(),
               py::arg("field_of_view") = py::none(), py::arg("by") = py::none(),
               py::arg("bases") = py::none(), py::arg("orders") = py::none(),
               py::arg("cosine") = options.cosine, py::arg("outgoing") = py::none(),
               py::arg("exposures") = py::none(), py::arg("exposure") = py::none(),
               py::arg("size") = options.size, py::arg("samples") = py::none(),
               py::arg("tolerance") = py::none(), py::arg("seconds") = py::none(),
               py::arg("progress") = py::none(),
               R"(Pictures of materials on spheres or a mesh, written to path (.png or .exr).

specs   specifications or paths, one or a sequence; of a folder, the files in it
light   point lights (theta, phi[, strength]) in degrees about the line of sight, or kinds of
        catalog("lights") and pictures, which add up; None: two point lights
by      "integration", "coefficients" or "both", which adds their difference; with it, or with a
        light that is no point, mesh, view, bases, orders or exposures, a row for each material:
        direct integration, then each basis and order, radiance in W/(m^2 sr) per unit of light
tolerance  bound of the estimated error of integration; None: 0.05 of "integration", 0.005 of "both"
seconds end of integration, with the best picture so far; None: no end
view    (theta, phi) to the viewer in degrees; exposures: stops, a column each

Returns the answer of the command: of each picture its place, error, relative L2 and largest
difference.)");
}

}  // namespace hshfit::python
