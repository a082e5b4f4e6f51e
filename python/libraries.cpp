#include "answers.h"
#include "arrays.h"
#include "job_options.h"
#include "watched.h"

#include <hshfit/error.h>
#include <hshfit/material_library/library_file.h>
#include <hshfit/material_library/log_terms.h>

#include <jobs/library/library_options.h>

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <nlohmann/json.hpp>

#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace hshfit::python {
namespace {

namespace ml = material_library;

/// A library as its file has it.
struct Opened {
    std::string path;
    ml::Library library;
    std::vector<std::string> leftOut = {};  ///< specifications that `learn` had no time for
};

std::shared_ptr<Opened> opened(const std::string& path) {
    auto library = std::make_shared<Opened>(Opened{.path = path, .library = {}});
    unwatched({}, [&] { library->library = ml::readLibrary(path); });
    return library;
}

namespace of = jobs::libraries;

/// The options of some actions, as the rows of the command have them.
Options optionsOf(jobs::LibraryOptions& options, unsigned actions,
                  std::initializer_list<std::string_view> leftOut = {}) {
    Options all = without(boundOptions(jobs::libraryOptions(), options), leftOut);
    std::erase_if(all,
                  [&](const jobs::BoundOption& each) { return (each.row->inputs & actions) == 0; });
    return all;
}

/// The number of components, 0 for auto.
std::size_t componentsIn(const jobs::LibraryOptions& options) {
    return options.components == "0" ? 0 : options.componentCount();
}

std::shared_ptr<Opened> learned(const py::object& specs, const py::object& file,
                                const py::kwargs& keywords) {
    jobs::LibraryOptions options;
    const py::object progress = optionsFrom(keywords, optionsOf(options, of::learn));
    const bool one = py::isinstance<py::str>(specs) || py::hasattr(specs, "__fspath__");
    std::vector<std::string> sources;
    for (const py::handle spec : one ? py::object(py::make_tuple(specs)) : specs)
        sources.push_back(pathOf(py::reinterpret_borrow<py::object>(spec), "specs"));
    jobs::LearnLibraryOptions how = options.learn;
    how.learn.components = componentsIn(options);
    how.limits = {options.encode.log.value_or(how.limits.log),
                  options.encode.maximum.value_or(how.limits.maximum),
                  options.encode.flip.value_or(how.limits.flip)};
    auto library = std::make_shared<Opened>(Opened{.path = pathOf(file, "file"), .library = {}});
    watched(progress, {}, [&](const jobs::Listener& listener) {
        library->leftOut = jobs::learnLibrary(sources, library->path, how, listener).leftOut;
        library->library = ml::readLibrary(library->path);
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
                 const py::kwargs& keywords) {
    jobs::LibraryOptions options;
    const py::object progress = optionsFrom(keywords, optionsOf(options, of::encode));
    const std::string output = pathOf(file, "file");
    jobs::EncodeOptions how = options.encode;
    how.components = componentsIn(options);
    jobs::EncodedMaterial done;
    watched(progress, {}, [&](const jobs::Listener& listener) {
        done = jobs::encodeMaterial(self.path, spec, output, how, listener);
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

py::object mapped(const Opened& self, const py::object& file, const py::kwargs& keywords) {
    jobs::LibraryOptions options;
    const py::object progress = optionsFrom(keywords, optionsOf(options, of::map));
    const std::string output = pathOf(file, "file");
    jobs::LibraryMap map;
    watched(progress, {}, [&](const jobs::Listener& listener) {
        map = jobs::mapLibrary(self.path, output, options.map, listener);
    });
    return fromJson(jobs::libraryMapJson(map));
}

py::dict reconstructed(const Opened& self, const py::object& samples, const py::object& file,
                       const py::kwargs& keywords) {
    jobs::LibraryOptions options;
    const py::object progress =
        optionsFrom(keywords, optionsOf(options, of::reconstruct, {"library"}));
    options.reconstruct.library = self.path;
    const std::string from = pathOf(samples, "samples"), output = pathOf(file, "file");
    jobs::ReconstructedMaterial done;
    watched(progress, {}, [&](const jobs::Listener& listener) {
        done = jobs::reconstructMaterial(from, output, options.reconstruct, listener);
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

Options nextOptions(jobs::LibraryOptions& options) {
    return optionsOf(options, of::next, {"count", "library"});
}

py::array_t<double> nextOf(const Opened& self, std::size_t count, const py::kwargs& keywords) {
    jobs::LibraryOptions options;
    Keywords given(keywords);
    given.set(nextOptions(options));
    const py::object samples = given.take("samples");
    given.finish();
    requireWithin("count", static_cast<double>(count), 1, 1000);
    const std::string from = samples.is_none() ? std::string() : pathOf(samples, "samples");
    std::vector<ml::NextPair> pairs;
    unwatched({}, [&] {
        pairs = jobs::nextPairs(from, "",
                                {.library = self.path,
                                 .sigma = options.reconstruct.sigma,
                                 .count = count,
                                 .instrument = options.next.instrument});
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
    jobs::LibraryOptions options;
    py::class_<Opened, std::shared_ptr<Opened>>(
        module, "Library",
        "A library of materials: a basis learned from them, and their numbers in it.\n"
        "ln(f + 0.001) = mean + coefficients @ components, over functions of the library's form.")
        .def(py::init([](const py::object& path) { return opened(pathOf(path, "path")); }),
             py::arg("path"), "Reads a library. Raises InputError for a file that is none.")
        .def_property_readonly(
            "path", [](const Opened& self) { return self.path; }, "The file.")
        .def_property_readonly("names", namesOf, "The names of the materials, sorted.")
        .def_property_readonly(
            "left_out", [](const Opened& self) { return self.leftOut; },
            "Specifications that `learn` left out since the time was over; add_to adds them later.")
        .def_property_readonly("mean", meanOf, "The mean, (functions,).")
        .def_property_readonly("components", componentsOf,
                               "The components, (components, functions).")
        .def("coefficients", coefficientsOf, py::arg("name"),
             "Numbers of a material in the basis, (channels, components). Raises UsageError for\n"
             "a material with a form of its own.");
    const py::object type = module.attr("Library");
    const OptionFunction learn{
        "learn", "specs: Union[Path, Sequence[Path]], file: Path", optionsOf(options, of::learn),
        "Library",
        "Learns a library from specifications, files and folders, and writes it to a file."};
    {
        py::options signatures;
        signatures.disable_function_signatures();
        type.attr("learn") =
            py::staticmethod(py::cpp_function(learned, py::name("learn"), py::arg("specs"),
                                              py::arg("file"), docstring(learn).c_str()));
    }
    defineMethod(type,
                 {"encode", "spec: str, file: Path", optionsOf(options, of::encode), "Row",
                  R"(Encodes a material in the basis and writes a library of it alone.

The answer has name, kind, bytes, picture and fallback, why it has a form of its own, or None.)"},
                 encoded, py::arg("spec"), py::arg("file"));
    defineMethod(type,
                 {"map", "file: Path", optionsOf(options, of::map), "Row",
                  R"(Writes a page of all materials by similarity, .html.

The answer has the keys of `hshfit library map --json`.)"},
                 mapped, py::arg("file"));
    defineMethod(type,
                 {"reconstruct", "samples: Path, file: Path",
                  optionsOf(options, of::reconstruct, {"library"}), "Row",
                  R"(A material from a file of samples, the library as prior.

Writes a library of it alone. The answer has chi_square, degrees_of_freedom, usual, known,
expected_error.)"},
                 reconstructed, py::arg("samples"), py::arg("file"));
    defineMethod(type,
                 {"next",
                  "count: int = 10",
                  nextOptions(options),
                  "Floats",
                  R"(Directions to measure next, (count, 5).

theta_i, phi_i, theta_o, phi_o in degrees and the expected error of ln(f + 0.001).)",
                  {{"samples", "Optional[Path]"}},
                  false},
                 nextOf, py::arg("count") = jobs::NextPairsOptions{}.count);
}

}  // namespace hshfit::python
