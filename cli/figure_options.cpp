#include "figure_options.h"

#include "command.h"

#include <hshfit/error.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace hshfit::cli {

std::optional<jobs::FigureOptions> FigureArguments::parsed() const {
    const FigureArguments none;
    const std::pair<bool, const char*> looks[] = {{width != none.width, "--figure-width"},
                                                  {font != none.font, "--font"},
                                                  {size != none.size, "--font-size"},
                                                  {axis != none.axis, "--axis"},
                                                  {panels != none.panels, "--panels"}};
    jobs::FigureOptions options{.folder = folder,
                                .style = {.width = parseFigureWidth(width),
                                          .font = font,
                                          .fontSize = parseFontSize(size),
                                          .axis = findFigureAxis(axis)},
                                .panels = panels};
    jobs::checkFigures(options);
    for (const auto& [given, name] : looks)
        if (given && folder.empty())
            throw UsageError(
                fmt::format("{} is about figures; give --figures DIR, their folder", name));
    if (folder.empty()) return std::nullopt;
    return options;
}

void addFigureOptions(CLI::App& command, FigureArguments& arguments) {
    command.add_option(
        "--figures", arguments.folder,
        "Folder for figures for print (.pdf, .svg), their data and a table (.tex) of "
        "the parameters of a fit, made if absent");
    command
        .add_option("--figure-width", arguments.width,
                    "column (84mm), page (174mm), or a width in mm, cm, in or pt")
        ->capture_default_str();
    command
        .add_option("--font", arguments.font, "Font of the figures, a name that fontconfig knows")
        ->capture_default_str();
    command.add_option("--font-size", arguments.size, "Points, 4 to 24")->capture_default_str();
    command.add_option("--axis", arguments.axis, "Axis of f in the figures: auto, linear or log")
        ->capture_default_str();
    command
        .add_option("--panels", arguments.panels,
                    "Planes of incidence to draw: auto (at most six), all, or elevations in "
                    "degrees (15,45)")
        ->capture_default_str();
}

nlohmann::ordered_json figuresJson(const jobs::FigureFiles& figures, const std::string& folder) {
    nlohmann::ordered_json json = {{"folder", folder}, {"files", figures.names}};
    if (figures.all > 0) {
        json["panels"] = figures.panels;
        json["samples"] = {
            {"drawn", figures.samples}, {"in_planes", figures.inPlane}, {"all", figures.all}};
    }
    if (!figures.font.empty()) json["font"] = figures.font;
    return json;
}

std::string figuresText(const jobs::FigureFiles& figures, const FigureArguments& arguments) {
    if (figures.names.empty()) return {};
    std::string text =
        fmt::format("written to {}: {} files of figures\n", arguments.folder, figures.names.size());
    if (figures.all > 0)
        text += fmt::format("  {} panels with {} samples; {} of {} lie in a plane of incidence\n",
                            figures.panels, figures.samples, figures.inPlane, figures.all);
    return text;
}

void noteFont(const jobs::FigureFiles& figures, const FigureArguments& arguments,
              const Globals& globals) {
    if (!figures.font.empty())
        note(globals, fmt::format("the font {} is not installed; the PDF files have {}",
                                  arguments.font, figures.font));
}

}  // namespace hshfit::cli
