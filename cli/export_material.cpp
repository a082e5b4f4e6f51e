#include "export_material.h"

#include "documents.h"
#include "measured_numbers.h"

#include <brdfs/fit/fit_json.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace hshfit::cli {
namespace {

std::string text(const jobs::ExportedMaterials& exported, const std::string& folder) {
    std::string out;
    for (const jobs::ExportedMaterial& file : exported.files) {
        out += fmt::format("{}/{}: {} bytes, {}\n", folder, file.path, file.bytes, file.spec);
        if (!file.converged) out += "  the fit did not converge\n";
        if (file.search) out += brdfs::textOf(*file.search);
        if (!file.loss) {
            out += fmt::format("  no loss: {}\n", file.reason);
            continue;
        }
        out += fmt::format("  against {}{}:\n", exported.source,
                           file.pictures.empty()
                               ? std::string()
                               : fmt::format(" (pictures: {}/{})", folder, file.pictures));
        if (file.picture) out += "  " + indented(textOf(*file.picture));
        const PairSummary& loss = *file.loss;
        out += fmt::format(
            "  mean log error {}; largest error of f cos(theta_i) {:.4g} at wi {:.4f} {:.4f} "
            "{:.4f}, wo {:.4f} {:.4f} {:.4f}\n",
            withError(loss.meanLog.value, loss.meanLog.error), loss.maximum, loss.at.wi.x,
            loss.at.wi.y, loss.at.wi.z, loss.at.wo.x, loss.at.wo.y, loss.at.wo.z);
    }
    return out;
}

}  // namespace

void runMaterialExport(const std::string& input, const std::string& folder,
                       const jobs::MaterialExportOptions& options, const Globals& globals) {
    const jobs::ExportedMaterials exported =
        jobs::exportMaterials(input, folder, options, listenerFor(globals));
    for (const jobs::ExportedMaterial& file : exported.files)
        if (file.poor) note(globals, fmt::format("{}: {}", file.path, file.poor->line()));
    if (globals.json)
        printJson(jobs::materialsJson(exported, folder));
    else
        printText(text(exported, folder));
}

}  // namespace hshfit::cli
