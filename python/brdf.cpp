#include "answers.h"
#include "arrays.h"
#include "watched.h"

#include <hshfit/brdf/transmission.h>
#include <hshfit/each_in_parallel.h>
#include <hshfit/error.h>
#include <hshfit/pictures/sphere_picture.h>
#include <hshfit/projection/albedo.h>

#include <jobs/source/quality.h>
#include <jobs/source/source.h>
#include <jobs/studies/convert.h>
#include <jobs/studies/eval.h>

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <atomic>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace hshfit::python {
namespace {

using Shared = std::shared_ptr<Brdf>;

py::dict lawsOf(const Brdf& brdf) {
    const Laws& laws = brdf.laws();
    py::dict out;
    out["non_negative"] = laws.nonNegative;
    out["reciprocal"] = laws.reciprocal;
    out["isotropic"] = laws.isotropic;
    out["mirror_symmetric"] = laws.mirrorSymmetric;
    out["energy_conserving"] = laws.energyConserving;
    return out;
}

py::dict factsOf(const Brdf& brdf) {
    py::dict out;
    for (const auto& [name, value] : brdf.facts()) out[py::str(name)] = py::cast(value);
    return out;
}

Shared openedBrdf(const py::object& spec, bool rgb) {
    const std::string text = pathOf(spec, "spec");
    const py::gil_scoped_release released;
    return jobs::openSource(text, rgb, jobs::Sides::eitherAndNamed);
}

Channels channelsOf(const py::object& argument) {
    if (py::isinstance<py::str>(argument)) {
        const auto word = argument.cast<std::string>();
        if (word == "grey") return Channels::grey();
        if (word == "rgb") return Channels::rgb();
    } else {
        std::vector<double> nanometres = numbersOf(argument, "channels");
        if (std::is_sorted(nanometres.begin(), nanometres.end()) && !nanometres.empty())
            return Channels::spectral(std::move(nanometres));
    }
    throw UsageError("channels: 'grey', 'rgb', or ascending wavelengths in nm");
}

Shared functionBrdf(const py::object& f, const py::object& name, const py::object& channels,
                    const Laws& laws, double halfwayWidth, double tolerance) {
    if (PyCallable_Check(f.ptr()) == 0)
        throw py::type_error("f: a function f(wi, wo) of wi (n, 3) and wo (3,) that returns (n,)");
    std::string called = "function";
    if (!name.is_none())
        called = name.cast<std::string>();
    else if (py::hasattr(f, "__name__"))
        called = f.attr("__name__").cast<std::string>();
    return std::make_shared<FunctionBrdf>(f, FunctionFacts{.name = called,
                                                           .channels = channelsOf(channels),
                                                           .laws = laws,
                                                           .halfwayWidth = halfwayWidth,
                                                           .tolerance = tolerance});
}

py::array_t<double> evaluated(const py::object& self, const py::object& wi, const py::object& wo,
                              bool cosine) {
    Source source(self);
    source.open();
    const auto [in, out] = broadcast(wi, "wi", wo, "wo");
    Shape shape = in.shape;
    shape.push_back(static_cast<py::ssize_t>(source.brdf().channels().count()));
    py::array_t<double> values(shape);
    double* to = values.mutable_data();
    Source* const sources[] = {&source};
    const auto work = [&, &in = in, &out = out] {
        jobs::evaluateArrays(source.brdf(), in.data, out.data, in.count, to, {.cosine = cosine});
        source.brdf().checkIntact();
    };
    if (in.count > jobs::pairsAtOnce)
        watched(py::none(), sources, [&](const jobs::Listener&) { work(); });
    else
        unwatched(sources, work);
    return values;
}

/// An integral over one hemisphere for directions of the other.
py::array_t<double> integrals(const py::object& self, const py::object& fixed, const char* name,
                              const char* what, double tolerance, const py::object& progress,
                              std::vector<double> (*integral)(const Brdf&, const Direction&,
                                                              double)) {
    Source source(self);
    const Vectors vectors = vectorsOf(fixed, name);
    const std::vector<Direction> directions = directionsIn(vectors, name);
    std::vector<double> values;
    Source* const sources[] = {&source};
    watched(progress, sources, [&](const jobs::Listener& listener) {
        const auto report = listener.part(what);
        // The viewers of a transmission are below the surface.
        const bool through = name == std::string_view("wo") && transmits(source.brdf());
        std::vector<std::vector<double>> found(directions.size());
        std::atomic<std::size_t> done = 0;
        eachInParallel(directions.size(), [&](std::size_t k) {
            if (through && directions[k].z > 0)
                throw InputError(
                    fmt::format("wo[{}] is above the surface; a transmission leaves "
                                "below it, expected z at most 0",
                                k));
            found[k] = integral(source.brdf(),
                                through ? throughSurface(directions[k]) : directions[k], tolerance);
            report(++done, directions.size());
        });
        for (const auto& one : found) values.insert(values.end(), one.begin(), one.end());
    });
    Shape shape = vectors.shape;
    shape.push_back(static_cast<py::ssize_t>(source.brdf().channels().count()));
    return arrayOf(std::move(values), shape);
}

py::array_t<double> albedos(const py::object& self, const py::object& wo, double tolerance,
                            const py::object& progress) {
    return integrals(self, wo, "wo", "albedo", tolerance, progress, directionalAlbedo);
}

py::array_t<double> reflectances(const py::object& self, const py::object& wi, double tolerance,
                                 const py::object& progress) {
    return integrals(self, wi, "wi", "reflectance", tolerance, progress, directionalReflectance);
}

SpherePicture sphereOf(const py::object& self, int size, int samples, const py::object& progress) {
    requireWithin("size", size, 1, 8192);
    requireWithin("samples", samples, 1, 64);
    Source source(self);
    SpherePicture picture;
    Source* const sources[] = {&source};
    watched(progress, sources, [&](const jobs::Listener& listener) {
        requireReflection(source.brdf(), "a lit sphere");
        picture = renderSphere(
            source.brdf(), {.size = size, .samples = samples, .progress = listener.part("sphere")});
    });
    return picture;
}

py::array_t<float> sphereArray(const py::object& self, int size, int samples,
                               const py::object& progress) {
    const SpherePicture picture = sphereOf(self, size, samples, progress);
    return py::array_t<float>(Shape{size, size, 3}, picture.radiance.data());
}

py::bytes spherePng(const py::object& self, int size, int samples) {
    const SpherePicture picture = sphereOf(self, size, samples, py::none());
    const SpherePicture one[] = {picture};
    return py::bytes(spheresPng(one, automaticExposure(one)));
}

py::dict writtenTo(const py::object& self, const py::object& path, const std::string& format,
                   bool measureLoss, bool force, const py::object& progress) {
    Source source(self);
    const std::string output = pathOf(path, "path");
    jobs::ConvertOptions options;
    options.format = format;
    options.measureLoss = measureLoss;
    options.force = force;
    jobs::Converted done;
    Source* const sources[] = {&source};
    watched(progress, sources, [&](const jobs::Listener& listener) {
        done = jobs::convertBrdf(source.brdf(), output, options, listener);
    });
    return convertedDict(done);
}

/// Unit vectors from angles in degrees, which broadcast.
py::array_t<double> directionArray(const py::object& theta, const py::object& phi) {
    const py::object numpy = py::module_::import("numpy");
    const py::tuple both =
        numpy.attr("broadcast_arrays")(doublesOf(theta, "theta"), doublesOf(phi, "phi"));
    const std::vector<double> thetas = numbersOf(both[0], "theta"),
                              phis = numbersOf(both[1], "phi");
    std::vector<double> values;
    for (std::size_t k = 0; k < thetas.size(); ++k) {
        const Direction d = jobs::Angles{thetas[k], phis[k]}.direction();
        values.insert(values.end(), {d.x, d.y, d.z});
    }
    const Doubles like(both[0]);
    Shape shape(like.shape(), like.shape() + like.ndim());
    shape.push_back(3);
    return arrayOf(std::move(values), shape);
}

void bindFunctions(py::module_& module) {
    module.def("open", openedBrdf, py::arg("spec"), py::kw_only(), py::arg("rgb") = false,
               R"(A BRDF from a specification: a model ("ggx:alpha=0.3"), a file (a measured one, a
preset, coefficients, an export), "preset:NAME", or a sum of them ("A + 0.5 * B").
rgb=True converts wavelengths to linear Rec. 709. Raises UsageError and InputError.)");
    module.def(
        "function",
        [](const py::object& f, const py::object& name, const py::object& channels, bool isotropic,
           bool reciprocal, bool mirrorSymmetric, bool nonNegative, double halfwayWidth,
           double tolerance) {
            return functionBrdf(f, name, channels,
                                {.nonNegative = nonNegative,
                                 .reciprocal = reciprocal,
                                 .isotropic = isotropic,
                                 .mirrorSymmetric = mirrorSymmetric},
                                halfwayWidth, tolerance);
        },
        py::arg("f"), py::kw_only(), py::arg("name") = py::none(), py::arg("channels") = "grey",
        py::arg("isotropic") = false, py::arg("reciprocal") = false,
        py::arg("mirror_symmetric") = false, py::arg("non_negative") = false,
        py::arg("halfway_width") = 0.0, py::arg("tolerance") = FunctionFacts{}.tolerance,
        R"(A BRDF from a function f(wi, wo) in 1/sr, without a cosine.

f is called with batches: wi of shape (n, 3) and wo of shape (3,), unit vectors that point away
from the surface, +z the normal. It returns shape (n,) for one channel, (n, channels) otherwise.
It may be called from several threads, one at a time. Values below the horizon are taken as 0.

channels          "grey", "rgb", or ascending wavelengths in nm
isotropic, mirror_symmetric, reciprocal, non_negative
                  laws that f keeps: projections skip work by the first two
halfway_width     of a lobe about the mirror direction, in slope of the half vector (alpha of GGX);
                  quadrature puts nodes there. 0: f is as smooth as Lambert's
tolerance         relative, of quadrature)");
    module.def(
        "direction", directionArray, py::arg("theta"), py::arg("phi") = 0.0,
        R"(Unit vectors (..., 3) from angles in degrees: theta from the normal +z, phi from the
tangent +x. The angles broadcast against each other. The z of theta = 90 is exactly 0.)");
}

void bindClass(py::module_& module) {
    py::class_<Brdf, Shared>(
        module, "Brdf",
        R"(f(wi, wo) in 1/sr, never f cos: analytic, measured, by coefficients or by a function.

Made by open() and function(). wi and wo point away from the surface, in a right-handed frame with
+z the normal and +x the tangent; f is 0 below the horizon. Safe to use from many threads.)")
        .def_property_readonly(
            "name", [](const Brdf& b) { return b.name(); },
            "The specification that opens it again, or the name of a function.")
        .def_property_readonly(
            "channels", [](const Brdf& b) { return b.channels().names(); },
            "Names: ['grey'], ['R', 'G', 'B'], or wavelengths such as '550nm'.")
        .def_property_readonly(
            "wavelengths",
            [](const Brdf& b) {
                const auto& nm = b.channels().wavelengths;
                return arrayOf(nm, {static_cast<py::ssize_t>(nm.size())});
            },
            "Wavelengths in nm, (n,); empty unless the channels are wavelengths.")
        .def_property_readonly("laws", lawsOf, "The laws that it promises to keep, name to bool.")
        .def_property_readonly("facts", factsOf, "What its file or model says, name to value.")
        .def("__call__", evaluated, py::arg("wi"), py::arg("wo"), py::kw_only(),
             py::arg("cosine") = false,
             R"(f at pairs of directions, (..., channels) in 1/sr; with cosine=True f cos(theta_i).

wi and wo have shape (..., 3) and broadcast against each other; arrays of float64 are read in
place. Lengths have to be 1 within 0.001 (InputError) and are made 1. The numbers are those of the
command eval, bit for bit; all threads work, without the interpreter's lock.)")
        .def(
            "albedo", albedos, py::arg("wo"), py::kw_only(), py::arg("tolerance") = 1e-4,
            py::arg("progress") = py::none(),
            R"(Directional albedo, the integral of f cos(theta_i) over wi: (..., channels) for wo of
shape (..., 3), to a relative tolerance. NumericError where it does not converge.)")
        .def("reflectance", reflectances, py::arg("wi"), py::kw_only(), py::arg("tolerance") = 1e-4,
             py::arg("progress") = py::none(),
             R"(Directional-hemispherical reflectance, the integral of f cos(theta_o) over wo: the
share of the light from wi that is reflected, at most 1 where energy is conserved. Shapes and
tolerance as of albedo, which it equals for a reciprocal BRDF.)")
        .def("sphere", sphereArray, py::arg("size") = SphereOptions{}.size, py::kw_only(),
             py::arg("samples") = SphereOptions{}.samples, py::arg("progress") = py::none(),
             R"(Radiance of a lit sphere of the material, float32 (size, size, 3), linear Rec. 709,
row 0 at the top, samples x samples per pixel. The lights are those of the program's reports.)")
        .def("_sphere_png", spherePng, py::arg("size"), py::arg("samples") = 2)
        .def("write", writtenTo, py::arg("path"), py::kw_only(), py::arg("format") = "",
             py::arg("measure_loss") = false, py::arg("force") = false,
             py::arg("progress") = py::none(),
             R"(Write it in the format of other programs (catalog("writers")), chosen by the
extension or by `format`. Returns a dict: `altered` (what the format leaves out), `error`
(relative L2 of f cos of the file read back, or None), with measure_loss every metric.
force replaces a file.)")
        .def("__repr__", [](const Brdf& b) { return "<hshfit.Brdf " + b.name() + ">"; });
}

}  // namespace

void bindBrdf(py::module_& module) {
    bindClass(module);
    bindFunctions(module);
}

}  // namespace hshfit::python
