#include "figures.h"

#include <hshfit/error.h>
#include <hshfit/wording.h>

#include <fmt/format.h>

namespace hshfit::jobs {
namespace {

using options::at;

std::vector<Word> axisWords() {
    return {{"auto"}, {"linear"}, {"log"}};
}

std::vector<Word> widthWords() {
    return {{"column", "84 mm"}, {"page", "174 mm"}};
}

std::vector<Word> panelWords() {
    return {{"auto", "at most six"}, {"all"}};
}

constexpr OptionRow figureRows[] = {
    OptionRow{"figures", at<&FigureArguments::figures>,
              "Folder for figures for print (.pdf, .svg), their data and a table (.tex) of the "
              "parameters of a fit, made if absent"}
        .takes({.files = Files::folder}),
    OptionRow{"figure-width", at<&FigureArguments::figureWidth>,
              "column (84mm), page (174mm), or a width in mm, cm, in or pt"}
        .takes({.words = widthWords}),
    OptionRow{"font", at<&FigureArguments::font>,
              "Font of the figures, a name that fontconfig knows"},
    OptionRow{"font-size", at<&FigureArguments::fontSize>, "Points, 4 to 24"},
    OptionRow{"axis", at<&FigureArguments::axis>, "Axis of f in the figures: auto, linear or log"}
        .takes({.words = axisWords}),
    OptionRow{"panels", at<&FigureArguments::panels>,
              "Planes of incidence to draw: auto (at most six), all, or elevations in degrees "
              "(15,45)"}
        .takes({.words = panelWords}),
};

}  // namespace

OptionRows<FigureArguments> figureOptions() {
    return {figureRows};
}

std::optional<FigureOptions> FigureArguments::parsed() const {
    const FigureArguments none;
    const std::pair<bool, Setting> looks[] = {
        {figureWidth != none.figureWidth, {"FigureArguments::figureWidth"}},
        {font != none.font, {"FigureArguments::font"}},
        {fontSize != none.fontSize, {"FigureArguments::fontSize"}},
        {axis != none.axis, {"FigureArguments::axis"}},
        {panels != none.panels, {"FigureArguments::panels"}}};
    FigureOptions options{.folder = figures,
                          .style = {.width = parseFigureWidth(figureWidth),
                                    .font = font,
                                    .fontSize = parseFontSize(fontSize),
                                    .axis = findFigureAxis(axis)},
                          .panels = panels};
    checkFigures(options);
    for (const auto& [given, name] : looks)
        if (given && figures.empty())
            throw UsageError(fmt::format("{} is about figures; give {}, their folder", name,
                                         Setting{"FigureArguments::figures", "DIR"}));
    if (figures.empty()) return std::nullopt;
    return options;
}

}  // namespace hshfit::jobs
