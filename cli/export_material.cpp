#include "export_material.h"

#include "measured_numbers.h"

#include <brdfs/fit/fit_json.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace hshfit::cli {
namespace {

using Json = nlohmann::ordered_json;

Json document(const jobs::ExportedMaterials& exported, const std::string& folder) {
    Json document = {{"format", "hshfit-export-materials"},
                     {"version", 1},
                     {"folder", folder},
                     {"name", exported.name},
                     {"source", exported.source},
                     {"vertices", exported.vertices},
                     {"triangles", exported.triangles},
                     {"files", Json::array()}};
    for (const jobs::ExportedMaterial& file : exported.files) {
        Json json = {{"target", file.target}, {"path", file.path},
                     {"bytes", file.bytes},   {"spec", file.spec},
                     {"fitted", file.fitted}, {"converged", file.converged}};
        if (file.search) {
            json["parts"] = {{"chosen", file.search->parts},
                             {"trials", brdfs::trialsJson(*file.search)}};
        }
        json["loss"] = file.loss ? jobs::lossJson(*file.loss) : Json{{"reason", file.reason}};
        document["files"].push_back(std::move(json));
    }
    return document;
}

std::string nameOf(const std::vector<std::string>& parts) {
    return parts.empty() ? "none" : fmt::format("{}", fmt::join(parts, " + "));
}

std::string text(const jobs::ExportedMaterials& exported, const std::string& folder) {
    std::string out;
    for (const jobs::ExportedMaterial& file : exported.files) {
        out += fmt::format("{}/{}: {} bytes, {}\n", folder, file.path, file.bytes, file.spec);
        if (!file.converged) out += "  the fit did not converge\n";
        if (file.search) {
            for (const brdfs::PartTrial& trial : file.search->trials)
                out += fmt::format("  extensions {}: {}\n", nameOf(trial.parts),
                                   brdfs::outcomeOf(trial));
        }
        if (!file.loss) {
            out += fmt::format("  no loss: {}\n", file.reason);
            continue;
        }
        const PairSummary& loss = *file.loss;
        out += fmt::format(
            "  against {}: mean log error {}, albedo off by at most "
            "{:.3g}\n  largest error of f cos(theta_i) {:.4g} at wi {:.4f} {:.4f} "
            "{:.4f}, wo {:.4f} {:.4f} {:.4f}\n",
            exported.source, withError(loss.meanLog.value, loss.meanLog.error), loss.albedo.value,
            loss.maximum, loss.at.wi.x, loss.at.wi.y, loss.at.wi.z, loss.at.wo.x, loss.at.wo.y,
            loss.at.wo.z);
    }
    return out;
}

}  // namespace

void runMaterialExport(const std::string& input, const std::string& folder,
                       const jobs::MaterialExportOptions& options, const Globals& globals) {
    const jobs::ExportedMaterials exported =
        jobs::exportMaterials(input, folder, options, listenerFor(globals));
    if (globals.json)
        printJson(document(exported, folder));
    else
        printText(text(exported, folder));
}

}  // namespace hshfit::cli
