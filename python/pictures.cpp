#include "arrays.h"
#include "job_options.h"
#include "watched.h"

#include <jobs/scenes/render_json.h>
#include <jobs/scenes/sheet_options.h>

#include <nlohmann/json.hpp>

#include <string>
#include <variant>
#include <vector>

namespace hshfit::python {
namespace {

py::object render(const py::object& specs, const py::object& path, const py::kwargs& keywords) {
    jobs::SheetOptions asked;
    Keywords given(keywords);
    given.dropNone();
    given.set(boundOptions(jobs::sheetOptions(), asked));
    const py::object progress = given.take("progress");
    given.finish();
    namespace sheets = jobs::sheets;
    const bool surface = given.misplaced(sheets::spheres | sheets::details) != nullptr;
    const auto sheet = jobs::sheetOf(asked, surface);
    if (std::holds_alternative<jobs::SphereSheetOptions>(sheet))
        if (const auto* row = given.misplaced(sheets::spheres)) jobs::refuseDetail(keywordOf(*row));
    const std::vector<std::string> sources = pathsOf(specs, "specs");
    const std::string output = pathOf(path, "path");
    nlohmann::ordered_json answer;
    watched(progress, {}, [&](const jobs::Listener& listener) {
        const auto draw = [&](const auto& options) {
            answer =
                jobs::renderJson(jobs::render(sources, output, options, listener), options, output);
        };
        std::visit(draw, sheet);
    });
    return fromJson(answer);
}

}  // namespace

void bindPictures(py::module_& module) {
    jobs::SheetOptions options;
    define(module,
           {"render", "specs: Union[Path, Sequence[Path]], path: Path",
            boundOptions(jobs::sheetOptions(), options), "Row",
            R"(Pictures of materials on spheres or a mesh, written to path (.png or .exr).

specs: specifications or paths, one or a sequence; of a folder, the files in it. Point lights may be
(theta, phi[, strength]) in degrees. With a light that is no point, or with mesh, view,
field_of_view, by, bases, orders, exposures or seconds: a row for each material, direct integration,
then each basis and order, in W/(m^2 sr) per unit of light. None stands for what is not given.

Returns the answer of the command: of each picture its place, error, relative L2 and largest
difference.)"},
           render, py::arg("specs"), py::arg("path"));
}

}  // namespace hshfit::python
