#include "answers.h"
#include "arrays.h"
#include "job_options.h"
#include "rotation.h"
#include "watched.h"

#include <hshfit/coefficient_files/light_file.h>
#include <hshfit/error.h>
#include <hshfit/irradiance/conventions.h>

#include <jobs/lighting/irradiance.h>
#include <jobs/lighting/light.h>

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace hshfit::python {
namespace {

/// Light with what the projection found beside its coefficients; nothing of that after reading a
/// file or a rotation.
struct Lit {
    LightCoefficients light;
    std::vector<double> bands = {};
    std::vector<std::optional<int>> enough = {};
    std::optional<LightCurve> wavelets = {};
    std::optional<jobs::SplitLight> split = {};
};

py::array_t<double> valuesOf(const py::object& self) {
    const LightCoefficients& light = self.cast<const Lit&>().light;
    return viewOf(
        light.values.data(),
        {static_cast<py::ssize_t>(light.channels.count()), static_cast<py::ssize_t>(light.slots())},
        self);
}

py::array_t<double> accuracyOf(const LightCurve& curve) {
    std::vector<double> values;
    for (const LightCurve::Point& point : curve.points) values.push_back(point.accuracy);
    const auto count = static_cast<py::ssize_t>(values.size());
    return arrayOf(std::move(values), {count});
}

py::dict curvesOf(const Lit& lit) {
    py::dict out;
    for (const LightCurve& curve : lit.light.curves) out[py::str(curve.basis)] = accuracyOf(curve);
    if (lit.wavelets) out[py::str(lit.wavelets->basis)] = accuracyOf(*lit.wavelets);
    return out;
}

py::dict enoughOf(const Lit& lit) {
    py::dict out;
    for (std::size_t k = 0; k < lit.enough.size(); ++k)
        out[py::cast(jobs::lightShares[k])] = py::cast(lit.enough[k]);
    return out;
}

std::vector<std::string> specificationsOf(const py::object& specs) {
    std::vector<std::string> texts = pathsOf(specs, "spec");
    if (texts.empty()) throw UsageError("spec: no light; catalog('lights') lists them");
    return texts;
}

/// The options of light(), but for the normal, which may be an array, and the sun, which is split
/// off with the name of a file.
Options optionsOf(jobs::LightOptions& options) {
    return without(boundOptions(jobs::lightOptions(), options), {"normal", "split-sun"});
}

std::shared_ptr<Lit> projected(const py::object& specs, const py::kwargs& keywords) {
    jobs::LightOptions options;
    Keywords given(keywords);
    given.set(optionsOf(options));
    const py::object normal = given.take("normal"), splitSun = given.take("split_sun");
    const py::object progress = given.take("progress");
    given.finish();
    options.splitSun = !splitSun.is_none();
    const std::string output = options.splitSun ? pathOf(splitSun, "split_sun") : "";
    if (options.splitSun && output.empty())
        throw UsageError("split_sun: an empty path; valid: None or NAME.json");
    if (!normal.is_none()) {
        const std::vector<double> angles = numbersOf(normal, "normal");
        if (angles.size() != 2) throw UsageError("normal: (theta, phi) in degrees");
        options.normal = Orientation{.theta = radians(angles[0]), .phi = radians(angles[1])};
    }
    const std::vector<std::string> texts = specificationsOf(specs);
    jobs::ProjectedLight done;
    watched(progress, {},
            [&](const jobs::Listener&) { done = jobs::light(texts, output, options); });
    return std::make_shared<Lit>(Lit{.light = std::move(done.light),
                                     .bands = std::move(done.bands),
                                     .enough = std::move(done.enough),
                                     .wavelets = std::move(done.wavelets),
                                     .split = std::move(done.split)});
}

std::pair<std::shared_ptr<Lit>, py::dict> rotated(const Lit& lit, const Rotation& rotation,
                                                  const py::kwargs& keywords) {
    const jobs::RotateOptions options = rotationBy(rotation, keywords);
    auto turned = std::make_shared<Lit>(Lit{.light = lit.light});
    jobs::Rotated done;
    watched(py::none(), {}, [&](const jobs::Listener&) {
        done = jobs::rotate(turned->light, options, lit.light.source);
    });
    return {turned, rotatedDict(done)};
}

py::object normalOf(const Lit& lit) {
    if (lit.light.domain == LightCoefficients::Domain::sphere) return py::none();
    return py::cast(std::pair(degrees(lit.light.normalTheta), degrees(lit.light.normalPhi)));
}

void bindClass(py::module_& module) {
    py::class_<Lit, std::shared_ptr<Lit>>(
        module, "Light",
        R"(Coefficients of incident radiance L, W / (m^2 sr), linear Rec. 709 or grey:
    c_{l,m} = integral over the domain of L B_{l,m} d omega
over the sphere (world frame, right-handed, +z up) or the hemisphere about a normal. Made by
light() and read().)")
        .def_property_readonly("basis", [](const Lit& l) { return l.light.basis; })
        .def_property_readonly("order", [](const Lit& l) { return l.light.order; })
        .def_property_readonly("condon_shortley",
                               [](const Lit& l) { return l.light.condonShortley; })
        .def_property_readonly("normal", normalOf,
                               "(theta, phi) in degrees of a hemisphere; None for the sphere.")
        .def_property_readonly("channels", [](const Lit& l) { return l.light.channels.names(); })
        .def_property_readonly("values", valuesOf,
                               "Read-only (channels, slots), slot l(l+1)+m, in place.")
        .def_property_readonly(
            "energy", [](const Lit& l) { return energyDict(l.light.energy); },
            "Integral of L^2 over the domain; not finite for lights that are\n"
            "points.")
        .def_property_readonly(
            "error", [](const Lit& l) { return l.light.error; },
            "Estimated relative error of the coefficients.")
        .def_property_readonly(
            "bands",
            [](const Lit& l) {
                return arrayOf(l.bands, {static_cast<py::ssize_t>(l.bands.size())});
            },
            "(order,), energy of each band; empty for light that was read or rotated.")
        .def_property_readonly("curves", curvesOf,
                               "{basis: (order,)}, the captured share of the energy by order.")
        .def_property_readonly("enough", enoughOf,
                               "{share: least order that captures it, or None}.")
        .def_property_readonly(
            "split",
            [](const Lit& l) -> py::object {
                if (!l.split) return py::none();
                return fromJson(jobs::splitJson(*l.split));
            },
            "Of light(split_sun=...): \"sun\", \"rest\" and their sum \"specification\", with\n"
            "what the command's JSON says of them; else None.")
        .def_property_readonly("source", [](const Lit& l) { return l.light.source; })
        .def(
            "save",
            [](const Lit& l, const py::object& path) {
                const std::string output = pathOf(path, "path");
                const py::gil_scoped_release released;
                writeLight(l.light, output);
            },
            py::arg("path"), "Write .json, the bytes of the command light.")
        .def("__repr__", [](const Lit& l) {
            return fmt::format("<hshfit.Light {} order {}, {}>", l.light.basis, l.light.order,
                               l.light.source);
        });
    defineMethod(module.attr("Light"),
                 rotateMethod("Light",
                              "Returns (Light, {\"method\", \"lost_energy\", \"error\", "
                              "\"bands\"})."),
                 rotated, py::arg("rotation"));
}

py::array_t<double> nineArray(const NineRgb& nine) {
    std::vector<double> values;
    for (const Rgb& rgb : nine) values.insert(values.end(), rgb.begin(), rgb.end());
    return arrayOf(std::move(values), {9, 3});
}

py::dict errorsDict(const IrradianceErrors& errors) {
    py::dict out;
    out["maximum"] = errors.maximum;
    out["mean"] = errors.mean;
    out["worst"] = angles(errors.worst);
    out["negative"] = errors.negative;
    return out;
}

/// The options of irradiance(), which writes no file and has no conventions unless asked.
Options optionsOf(jobs::IrradianceOptions& options) {
    return without(boundOptions(jobs::irradianceOptions(), options),
                   {"by-normal", "convention", "for"});
}

std::string wordOf(const py::object& word) {
    return word.is_none() ? std::string() : py::str(word).cast<std::string>();
}

py::dict irradianceOfSpecs(const py::object& specs, const py::kwargs& keywords) {
    jobs::IrradianceOptions options;
    Keywords given(keywords);
    given.set(optionsOf(options));
    options.convention = wordOf(given.take("convention"));
    options.engine = wordOf(given.take("engine"));
    const py::object progress = given.take("progress");
    given.finish();
    const std::vector<std::string> texts = specificationsOf(specs);
    if (!options.convention.empty() && !options.engine.empty())
        throw UsageError("irradiance: convention and engine are both given; valid: one of the two");
    jobs::LitSurface done;
    watched(progress, {},
            [&](const jobs::Listener&) { done = jobs::irradianceOfLight(texts, options); });
    py::dict out, engines;
    out["light"] = done.light;
    out["radiance"] = nineArray(done.radiance);
    out["irradiance"] = nineArray(done.irradiance);
    out["window"] = done.window;
    out["factors"] = done.factors;
    out["mean_irradiance"] = done.meanIrradiance;
    out["error"] = errorsDict(done.error);
    out["nine_error"] = errorsDict(done.nineError);
    for (const Convention* one : done.conventions) {
        py::dict row;
        row["values"] = engineValues(*one, done.radiance);
        row["shader"] = engineShader(*one, done.radiance);
        engines[py::str(std::string(one->name))] = row;
    }
    out["engines"] = engines;
    return out;
}

}  // namespace

void bindLight(py::module_& module) {
    bindClass(module);
    jobs::LightOptions options;
    define(module,
           {"light",
            "spec: LightLike",
            optionsOf(options),
            "Light",
            R"(Project light onto a basis.

spec: a picture, coefficients of light, or a kind of catalog("lights") ("sky:type=12,elevation=40");
joined by " + ", or as a sequence, they add up. basis: "sh" for the sphere; any for the hemisphere
about normal=(theta, phi) in degrees. split_sun: NAME.json for the coefficients of one picture,
which NAME_rest.exr beside it and a sun: add up to; InputError where it has no sun.

Returns a Light.)",
            {{"normal", "Optional[ArrayLike]"}, {"split_sun", "Optional[Path]"}}},
           projected, py::arg("spec"));
    jobs::IrradianceOptions irradiance;
    define(module,
           {"irradiance",
            "spec: LightLike",
            optionsOf(irradiance),
            "Row",
            R"(The irradiance of light by nine coefficients (Ramamoorthi & Hanrahan 2001).

Returns a dict: "radiance" and "irradiance" (9, 3) in the order l(l+1)+m, "error" against direct
integration ("maximum", "mean", relative to the mean irradiance), "nine_error" likewise of these
nine coefficients, whatever order is asked for, and for `convention` (a
name of `hshfit irradiance --convention`, or "all") "engines" with their numbers and shader code.
`engine` in its place turns the light as that engine's own import of panoramas does.)",
            {{"convention", "Optional[str]"}, {"engine", "Optional[str]"}}},
           irradianceOfSpecs, py::arg("spec"));
    module.def(
        "_read_light",
        [](const std::string& path) {
            const py::gil_scoped_release released;
            return std::make_shared<Lit>(Lit{.light = readLight(path)});
        },
        py::arg("path"));
}

}  // namespace hshfit::python
