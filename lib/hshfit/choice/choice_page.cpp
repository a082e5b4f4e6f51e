#include <hshfit/choice/choice_files.h>
#include <hshfit/choice/row_text.h>

#include <hshfit/files/checksum.h>
#include <hshfit/files/template_text.h>
#include <hshfit/pages/page_figures.h>
#include <hshfit/pages/report_files.h>
#include <hshfit/pictures/picture_strips.h>
#include <hshfit/version.h>

#include <fmt/format.h>

#include <string_view>

namespace hshfit::embedded {
extern const std::string_view choice_html;
}

namespace hshfit::choice {
namespace {

using kainjow::mustache::data;

/// Source, candidate and their difference under each light, at the exposure of the source.
data strips(const std::vector<SpherePicture>& source, const std::vector<SpherePicture>& other) {
    data list{data::type::list};
    for (const PictureStrip& own : pictureStrips(source, other)) {
        data strip("light", own.light);
        strip.set("png", base64(pngOf(own)));
        strip.set("times", fmt::format("{:g}", own.times));
        list.push_back(strip);
    }
    return list;
}

data rowData(const Choice& choice, std::size_t k, const std::vector<SpherePicture>& spheres) {
    const Row& row = choice.rows[k];
    const PictureError& picture = row.picture;
    data entry("name", row.name);
    entry.set("id", fmt::format("row{}", k + 1));
    entry.set("class", choice.recommended == k ? "best" : row.unfit.empty() ? "" : "unfit");
    entry.set("taken", choice.recommended == k);
    entry.set("bytes", std::to_string(row.made.bytes));
    entry.set("cycles", cyclesText(row.cost));
    if (row.cost) {
        entry.set("cost", fmt::format("{} instructions, {} vector registers{}",
                                      row.cost->instructions, row.cost->registers,
                                      row.cost->spilled > 0
                                          ? fmt::format(", {} of them spilled", row.cost->spilled)
                                          : ""));
    }
    entry.set("flip", fmt::format("{:.3f}", picture.flip.mean));
    entry.set("largest", fmt::format("{:.3f}", picture.flip.largest));
    entry.set("light", picture.flip.light);
    entry.set("dip", shareText(picture.dip));
    entry.set("peak", shareText(picture.peak));
    entry.set("lost", row.lost);
    if (row.poor) entry.set("poor", *row.poor);
    if (!row.unfit.empty()) entry.set("unfit", row.unfit);
    const std::string command = commandLineOf(row);
    if (!command.empty()) entry.set("command", commandMarkup(command));
    entry.set("spec", withoutFolders(row.made.spec));
    entry.set("strips", strips(spheres, row.made.brdf ? stripSpheres(*row.made.brdf) : spheres));
    return entry;
}

}  // namespace

std::string choicePage(const Choice& choice, const Brdf& source) {
    const std::vector<SpherePicture> spheres = stripSpheres(source);
    data page("style", std::string(pageStyle()));
    page.set("generator", std::string("hshfit ") + version);
    page.set("source", shortName(withoutFolders(choice.source), 120));
    page.set("renderer", choice.renderer);
    page.set("error", fmt::format("{:g}", choice.error));
    if (choice.maxBytes) page.set("maxBytes", std::to_string(*choice.maxBytes));
    if (choice.maxCycles) page.set("maxCycles", std::to_string(*choice.maxCycles));
    page.set("costs", choice.costs ? scaleText(*choice.costs) : "not stated: " + choice.noCosts);
    page.set("why", choice.why);
    page.set("recommends", choice.recommended.has_value());
    page.set("faithful", choice.faithful);
    if (choice.recommended) {
        const Row& row = choice.rows[*choice.recommended];
        page.set("best", row.name);
        page.set("bestId", fmt::format("row{}", *choice.recommended + 1));
        page.set("bestBytes", std::to_string(row.made.bytes));
        page.set("bestLost", row.lost);
    }
    data rows{data::type::list}, leftOut{data::type::list};
    for (std::size_t k = 0; k < choice.rows.size(); ++k)
        rows.push_back(rowData(choice, k, spheres));
    for (const LeftOut& line : choice.leftOut)
        leftOut.push_back(data("text", fmt::format("{}: {}", line.name, line.reason)));
    page.set("rows", rows);
    page.set("leftOut", leftOut);
    page.set("anyLeftOut", !choice.leftOut.empty());
    return filledPage(embedded::choice_html, page);
}

}  // namespace hshfit::choice
