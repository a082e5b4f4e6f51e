#include "command.h"
#include "command_rows.h"
#include "job_options.h"

#include <jobs/scenes/render_json.h>
#include <jobs/scenes/sheet_options.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <variant>

namespace hshfit::cli {
namespace {

using Kind = jobs::RenderedPicture::Kind;

struct RenderArguments {
    std::vector<std::string> specs;
    std::string output;
    jobs::SheetOptions options;
};

std::string textOf(const std::string& output, const jobs::SphereSheetOptions& options,
                   const jobs::SphereSheet& sheet) {
    return fmt::format("{}: {} sphere{} of {} x {} pixels, exposure {:+.1f} stops\n", output,
                       sheet.spheres.size(), sheet.spheres.size() == 1 ? "" : "s", options.size,
                       options.size, sheet.stops);
}

std::string textOf(const std::string& output, const jobs::RenderOptions& options,
                   const jobs::Rendered& rendered) {
    std::string text =
        fmt::format("{}: {} picture{} of {} x {} pixels, exposure {:+.1f} stops\n", output,
                    rendered.pictures.size(), rendered.pictures.size() == 1 ? "" : "s",
                    options.size, options.size, rendered.stops);
    for (const auto& picture : rendered.pictures) {
        text += fmt::format("  {},{}  {}  {}", picture.column, picture.row, picture.brdf,
                            jobs::kindName(picture.kind));
        if (!picture.basis.empty()) text += fmt::format(" {} {}", picture.basis, picture.order);
        if (picture.exposure != 0) text += fmt::format(" {:+g} stops", picture.exposure);
        if (picture.kind == Kind::difference) {
            text += fmt::format(
                " x {:g}: relative L2 {:.4f}, at most {:.3f} of the mean radiance "
                "{:.4g}",
                picture.amplification, picture.difference->relativeL2, picture.difference->maximum,
                picture.difference->meanRadiance);
        } else if (picture.kind == Kind::integration) {
            text += fmt::format(": error {:.2g}, of a pixel at most {:.2g} at {},{}", picture.error,
                                picture.largest.error, picture.largest.column, picture.largest.row);
        }
        text += "\n";
    }
    return text;
}

void runRender(const CLI::App& command, const RenderArguments& arguments, const Globals& globals) {
    namespace sheets = jobs::sheets;
    const auto misplaced = [&](unsigned kinds) {
        return misplacedOption(command, jobs::sheetOptions().rows, kinds);
    };
    const bool surface = misplaced(sheets::spheres | sheets::details).has_value();
    const auto sheet = jobs::sheetOf(arguments.options, surface);
    if (std::holds_alternative<jobs::SphereSheetOptions>(sheet))
        if (const auto given = misplaced(sheets::spheres)) jobs::refuseDetail(given->name);

    const auto render = [&](const auto& options) {
        const auto done =
            jobs::render(arguments.specs, arguments.output, options, listenerFor(globals));
        if (globals.json)
            printJson(jobs::renderJson(done, options, arguments.output));
        else
            printText(textOf(arguments.output, options, done));
    };
    std::visit(render, sheet);
}

constexpr ArgumentRow renderArguments[] = {
    required("SPEC", at<&RenderArguments::specs>,
             "One or more BRDFs or coefficient files; of a folder, those in it", brdfRead),
    requiredOutput(at<&RenderArguments::output>, "Picture to write, .png or .exr",
                   {.files = Files::written, .dash = ".png"}),
};

}  // namespace

CommandRows renderRows() {
    return {renderArguments, {jobs::sheetOptions().rows}};
}

void addRender(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<RenderArguments>();
    addArguments(command, renderArguments, *arguments);
    addOptions(command, jobs::sheetOptions(), arguments->options);
    command.callback([arguments, &globals, &command] { runRender(command, *arguments, globals); });
}

}  // namespace hshfit::cli
