#include "answers.h"
#include "arrays.h"
#include "watched.h"

#include <hshfit/error.h>
#include <hshfit/material_library/library_file.h>
#include <hshfit/material_library/log_terms.h>

#include <jobs/library/library_map.h>
#include <jobs/library/material_library.h>
#include <jobs/library/material_samples.h>

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <nlohmann/json.hpp>

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace hshfit::python {
namespace {

namespace ml = material_library;

/// A library as its file has it.
struct Opened {
    std::string path;
    ml::Library library;
};

std::shared_ptr<Opened> opened(const std::string& path) {
    auto library = std::make_shared<Opened>(Opened{path, {}});
    unwatched({}, [&] { library->library = ml::readLibrary(path); });
    return library;
}

std::shared_ptr<Opened> learned(const py::object& specs, const py::object& file,
                                std::size_t components, std::size_t bytes, double heldOut,
                                double limit, double limitMaximum, double limitFlip,
                                const py::object& addTo, const py::object& progress) {
    requireWithin("components", static_cast<double>(components), 0, 512);
    requireWithin("bytes", static_cast<double>(bytes), 6, 65536);
    requireWithin("held_out", heldOut, 0.01, 0.5);
    const bool one = py::isinstance<py::str>(specs) || py::hasattr(specs, "__fspath__");
    std::vector<std::string> sources;
    for (const py::handle spec : one ? py::object(py::make_tuple(specs)) : specs)
        sources.push_back(pathOf(py::reinterpret_borrow<py::object>(spec), "specs"));
    jobs::LearnLibraryOptions options{
        .learn = {.components = components, .bytes = bytes, .heldOut = heldOut},
        .limits = {.log = limit, .maximum = limitMaximum, .flip = limitFlip}};
    if (!addTo.is_none()) options.addTo = pathOf(addTo, "add_to");
    auto library = std::make_shared<Opened>(Opened{pathOf(file, "file"), {}});
    watched(progress, {}, [&](const jobs::Listener& listener) {
        library->library = jobs::learnLibrary(sources, library->path, options, listener).library;
    });
    return library;
}

std::vector<std::string> namesOf(const Opened& self) {
    std::vector<std::string> names;
    for (const ml::Material& material : self.library.materials) names.push_back(material.name);
    return names;
}

py::array_t<double> componentsOf(const py::object& self) {
    const ml::Basis& basis = self.cast<const Opened&>().library.basis;
    return viewOf(
        basis.components.data(),
        {static_cast<py::ssize_t>(basis.size()), static_cast<py::ssize_t>(basis.mean.size())},
        self);
}

py::array_t<double> meanOf(const py::object& self) {
    const ml::Basis& basis = self.cast<const Opened&>().library.basis;
    return viewOf(basis.mean.data(), {static_cast<py::ssize_t>(basis.mean.size())}, self);
}

py::array_t<double> coefficientsOf(const Opened& self, const std::string& name) {
    const ml::Material* material = ml::find(self.library, name);
    if (!material) throw UsageError(fmt::format("{}: has no material '{}'", self.path, name));
    if (material->kind != ml::Kind::coded)
        throw UsageError(fmt::format("{}: '{}' has a form of its own, not coefficients: it {}",
                                     self.path, name, material->fallback));
    const ml::Basis& basis = self.library.basis;
    std::vector<double> all;
    for (std::size_t c = 0; c < material->channels; ++c) {
        const ml::ChannelCode code = ml::unpack(
            basis,
            std::span(material->codes).subspan(c * basis.channelBytes(), basis.channelBytes()));
        all.insert(all.end(), code.coordinates.begin(), code.coordinates.end());
    }
    return arrayOf(std::move(all), {static_cast<py::ssize_t>(material->channels),
                                    static_cast<py::ssize_t>(basis.size())});
}

py::dict encoded(const Opened& self, const std::string& spec, const py::object& file,
                 std::size_t components, const py::object& progress) {
    const std::string output = pathOf(file, "file");
    jobs::EncodedMaterial done;
    watched(progress, {}, [&](const jobs::Listener& listener) {
        done = jobs::encodeMaterial(self.path, spec, output, {.components = components}, listener);
    });
    py::dict answer;
    answer["name"] = done.material.name;
    answer["kind"] = std::string(ml::nameOf(done.material.kind));
    answer["bytes"] = done.material.bytes;
    answer["picture"] = pictureDict(done.picture);
    answer["fallback"] =
        done.material.fallback.empty() ? py::object(py::none()) : py::cast(done.material.fallback);
    return answer;
}

py::object mapped(const Opened& self, const py::object& file, double near,
                  const py::object& progress) {
    requireWithin("near", near, 0, 1);
    const std::string output = pathOf(file, "file");
    jobs::LibraryMap map;
    watched(progress, {}, [&](const jobs::Listener& listener) {
        map = jobs::mapLibrary(self.path, output, {.near = near}, listener);
    });
    return fromJson(jobs::libraryMapJson(map));
}

py::dict reconstructed(const Opened& self, const py::object& samples, const py::object& file,
                       const std::string& sigma, const py::object& progress) {
    const std::string from = pathOf(samples, "samples"), output = pathOf(file, "file");
    jobs::ReconstructedMaterial done;
    watched(progress, {}, [&](const jobs::Listener& listener) {
        done = jobs::reconstructMaterial(from, output, {.library = self.path, .sigma = sigma},
                                         listener);
    });
    py::dict answer;
    answer["name"] = done.name;
    answer["samples"] = done.samples;
    answer["chi_square"] = done.agreement.chiSquare;
    answer["degrees_of_freedom"] = done.agreement.degreesOfFreedom;
    answer["usual"] = done.agreement.usual;
    answer["known"] = done.agreement.known;
    answer["expected_error"] = done.expectedError;
    return answer;
}

py::array_t<double> nextOf(const Opened& self, std::size_t count, const py::object& samples,
                           const std::string& instrument, const std::string& sigma) {
    requireWithin("count", static_cast<double>(count), 1, 1000);
    if (instrument != "free" && instrument != "in-plane")
        throw UsageError(fmt::format("instrument '{}': expected free or in-plane", instrument));
    const std::string from = samples.is_none() ? std::string() : pathOf(samples, "samples");
    std::vector<ml::NextPair> pairs;
    unwatched({}, [&] {
        pairs = jobs::nextPairs(
            from, "",
            {.library = self.path, .sigma = sigma, .count = count, .instrument = instrument});
    });
    std::vector<double> rows;
    for (const ml::NextPair& next : pairs)
        rows.insert(rows.end(), {degrees(polarAngle(next.pair.wi)), degrees(azimuth(next.pair.wi)),
                                 degrees(polarAngle(next.pair.wo)), degrees(azimuth(next.pair.wo)),
                                 next.expectedError});
    return arrayOf(std::move(rows), {static_cast<py::ssize_t>(pairs.size()), 5});
}

}  // namespace

void bindLibraries(py::module_& module) {
    const ml::LearnOptions learn;
    const ml::Limits limits;
    const py::none none;
    py::class_<Opened, std::shared_ptr<Opened>>(
        module, "Library",
        "A library of materials: a basis learned from them, and their numbers in it.\n"
        "ln(f + 0.001) = mean + coefficients @ components, over functions of the library's form.")
        .def(py::init([](const py::object& path) { return opened(pathOf(path, "path")); }),
             py::arg("path"), "Reads a library. Raises InputError for a file that is none.")
        .def_static("learn", learned, py::arg("specs"), py::arg("file"), py::kw_only(),
                    py::arg("components") = learn.components, py::arg("bytes") = learn.bytes,
                    py::arg("held_out") = learn.heldOut, py::arg("limit") = limits.log,
                    py::arg("limit_maximum") = limits.maximum, py::arg("limit_flip") = limits.flip,
                    py::arg("add_to") = none, py::arg("progress") = none,
                    "Learns a library from specifications, files and folders, and writes it to a\n"
                    "file; arguments are the options of `hshfit library learn`, components 0 auto.")
        .def_property_readonly(
            "path", [](const Opened& self) { return self.path; }, "The file.")
        .def_property_readonly("names", namesOf, "The names of the materials, sorted.")
        .def_property_readonly("mean", meanOf, "The mean, (functions,).")
        .def_property_readonly("components", componentsOf,
                               "The components, (components, functions).")
        .def("coefficients", coefficientsOf, py::arg("name"),
             "Numbers of a material in the basis, (channels, components). Raises UsageError for\n"
             "a material with a form of its own.")
        .def("encode", encoded, py::arg("spec"), py::arg("file"), py::kw_only(),
             py::arg("components") = 0, py::arg("progress") = none,
             "Encodes a material in the basis and writes a library of it alone; the answer has\n"
             "name, kind, bytes, picture and fallback, why it has a form of its own, or None.")
        .def("map", mapped, py::arg("file"), py::kw_only(),
             py::arg("near") = jobs::LibraryMapOptions{}.near, py::arg("progress") = none,
             "Writes a page of all materials by similarity, .html; the answer has the keys of\n"
             "`hshfit library map --json`. near: the FLIP of near duplicates, at most.")
        .def("reconstruct", reconstructed, py::arg("samples"), py::arg("file"), py::kw_only(),
             py::arg("sigma") = jobs::ReconstructOptions{}.sigma, py::arg("progress") = none,
             "A material from a file of samples, the library as prior; writes a library of it\n"
             "alone. The answer has chi_square, degrees_of_freedom, usual, known, expected_error.")
        .def("next", nextOf, py::arg("count") = jobs::NextPairsOptions{}.count, py::kw_only(),
             py::arg("samples") = none, py::arg("instrument") = "free",
             py::arg("sigma") = jobs::NextPairsOptions{}.sigma,
             "Directions to measure next, (count, 5): theta_i, phi_i, theta_o, phi_o in degrees\n"
             "and the expected error of ln(f + 0.001). instrument: free or in-plane.");
}

}  // namespace hshfit::python
