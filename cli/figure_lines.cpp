#include "figure_lines.h"

#include "command.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace hshfit::cli {

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

std::string figuresText(const jobs::FigureFiles& figures, const jobs::FigureArguments& arguments) {
    if (figures.names.empty()) return {};
    std::string text = fmt::format("written to {}: {} files of figures\n", arguments.figures,
                                   figures.names.size());
    if (figures.all > 0)
        text += fmt::format("  {} panels with {} samples; {} of {} lie in a plane of incidence\n",
                            figures.panels, figures.samples, figures.inPlane, figures.all);
    return text;
}

void noteFont(const jobs::FigureFiles& figures, const jobs::FigureArguments& arguments,
              const Globals& globals) {
    if (!figures.font.empty())
        note(globals, fmt::format("the font {} is not installed; the PDF files have {}",
                                  arguments.font, figures.font));
}

}  // namespace hshfit::cli
