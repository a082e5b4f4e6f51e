#include "arrays.h"
#include "job_options.h"
#include "watched.h"

#include <hshfit/error.h>

#include <jobs/maps/map_answers.h>
#include <jobs/maps/map_options.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <string>
#include <variant>

namespace hshfit::python {
namespace {

nlohmann::ordered_json jsonOf(const jobs::Svbrdf& done) {
    return jobs::svbrdfJson(done);
}

nlohmann::ordered_json jsonOf(const jobs::FilteredMapAnswer& done) {
    return jobs::filteredMapJson(done);
}

py::object mapped(const py::object& description, const py::object& folder,
                  const py::kwargs& keywords) {
    jobs::MapOptions options;
    py::dict stated;
    for (const auto& [name, value] : keywords)
        if (!value.is_none()) stated[name] = value;
    Keywords given(stated);
    given.set(boundOptions(jobs::mapOptions(), options));
    const py::object progress = given.take("progress");
    given.finish();
    const std::string path = pathOf(description, "description"), output = pathOf(folder, "folder");
    nlohmann::ordered_json answer;
    watched(progress, {}, [&](const jobs::Listener& listener) {
        options.form = jobs::mapFormOf(path, options);
        if (const jobs::OptionRow* row = given.misplaced(jobs::mapFormBit(options.form)))
            throw UsageError(fmt::format("{} is for the form {}, not for {}", keywordOf(*row),
                                         jobs::mapFormNames(row->inputs), options.form));
        const auto done = jobs::makeMap(path, output, options, listener);
        answer = std::visit([](const auto& made) { return jsonOf(made); }, done);
    });
    return fromJson(answer);
}

}  // namespace

void bindMaterialMaps(py::module_& module) {
    jobs::MapOptions options;
    define(module,
           {"svbrdf", "description: Path, folder: Path", boundOptions(jobs::mapOptions(), options),
            "Row",
            R"(Maps of materials as a texture of coefficients with mip levels.

description is a file (JSON) of a model and its parameters: numbers or pictures. Writes
material.ktx2, material.json and errors.png to folder, and the shared materials of the form
"halfway". Returns the answer of the command: choices with bytes and errors, levels with their
errors against samples, rates and files. The files are those of the program, byte for byte.)"},
           mapped, py::arg("description"), py::arg("folder"));
}

}  // namespace hshfit::python
