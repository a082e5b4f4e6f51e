#include <hshfit/choice/row_text.h>
#include <hshfit/files/template_text.h>
#include <hshfit/pages/page_figures.h>
#include <hshfit/pages/report_files.h>
#include <hshfit/plan/plan_files.h>
#include <hshfit/version.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hshfit::embedded {
extern const std::string_view plan_html;
}  // namespace hshfit::embedded

namespace hshfit::plan {
namespace {

using kainjow::mustache::data;

std::string errorText(double error) {
    return std::isfinite(error) ? fmt::format("{:.3g}", error) : "–";
}

std::string timesSmaller(std::size_t bytes) {
    return fmt::format("{:.0f} ×", static_cast<double>(baselineBytes) / static_cast<double>(bytes));
}

/// Width of a bar, in percent, of which `full` fills three quarters.
std::string bar(double value, double full) {
    const double share = full > 0 && std::isfinite(value) ? 75 * value / full : 0;
    return fmt::format("{:.1f}", std::clamp(share, 0.0, 100.0));
}

data listOf(const std::vector<std::string>& texts) {
    data list{data::type::list};
    for (const std::string& text : texts) list.push_back(data("text", text));
    return list;
}

data choiceRow(const std::string& label, const Choice& choice, std::optional<double> flip,
               const std::string& file, bool chosen) {
    data row("label", label);
    row.set("class", chosen ? "best" : "");
    row.set("bytes", std::to_string(choice.bytes));
    row.set("times", timesSmaller(choice.bytes));
    row.set("error", errorText(choice.error));
    if (flip) row.set("flip", fmt::format("{:.3f}", *flip));
    row.set("command", commandMarkup(commandOf(choice, file)));
    return row;
}

data choiceRows(const MaterialPlan& plan) {
    const std::string file = plan.material.name + ".json";
    data rows{data::type::list};
    const auto flipOf = [](const Choice& choice) {
        return choice.flip ? std::optional(choice.flip->mean) : std::nullopt;
    };
    for (const Choice& each : plan.cheaper) {
        const std::string label = plan.accepted ? "cheaper" : "tried";
        rows.push_back(choiceRow(label, each, flipOf(each), file, false));
    }
    if (plan.accepted) {
        const Accepted& chosen = *plan.accepted;
        rows.push_back(choiceRow("chosen", chosen.choice, chosen.picture.flip.mean, file, true));
    }
    if (plan.dearer)
        rows.push_back(
            choiceRow("half the error", *plan.dearer, flipOf(*plan.dearer), file, false));
    return rows;
}

data formulaRows(const MaterialPlan& plan, bool costs) {
    data rows{data::type::list};
    for (const PlannedFormula& formula : plan.formulas) {
        data row("formula", formula.row.name);
        row.set("class", formula.within ? "" : "unfit");
        row.set("formulaBytes", std::to_string(formula.row.made.bytes));
        row.set("formulaError", errorText(formula.verified));
        row.set("flip", fmt::format("{:.3f}", formula.row.picture.flip.mean));
        row.set("largest", fmt::format("{:.3f}", formula.row.picture.flip.largest));
        row.set("lost", formula.row.lost);
        if (costs) row.set("cycles", choice::cyclesText(formula.row.cost));
        const std::string command = choice::commandLineOf(formula.row);
        row.set("madeBy",
                commandMarkup(command.empty() ? withoutFolders(formula.row.made.spec) : command));
        rows.push_back(row);
    }
    return rows;
}

data elevationRows(const Accepted& accepted, double budget) {
    data rows{data::type::list};
    for (std::size_t k = 0; k < accepted.thetas.size(); ++k) {
        data row("theta", fmt::format("{:.1f}°", degrees(accepted.thetas[k])));
        row.set("error", errorText(accepted.errors[k]));
        row.set("bar", bar(accepted.errors[k], budget));
        rows.push_back(row);
    }
    return rows;
}

data bandRows(const std::vector<double>& power) {
    data rows{data::type::list};
    const double most = power.empty() ? 0 : *std::max_element(power.begin(), power.end());
    double held = 0;
    for (std::size_t l = 0; l < power.size(); ++l) {
        held += power[l];
        data row("order", std::to_string(l + 1));
        row.set("share", fmt::format("{:.2g} %", 100 * power[l]));
        row.set("left", fmt::format("{:.2g} %", 100 * std::max(0.0, 1 - held)));
        row.set("bar", bar(power[l], most));
        rows.push_back(row);
        if (1 - held < 1e-6) break;
    }
    return rows;
}

data materialData(const MaterialPlan& plan, bool costs) {
    const Material& material = plan.material;
    data entry("name", material.name);
    entry.set("brdf", withoutFolders(material.brdf));
    entry.set("budget",
              fmt::format("{:g}, {}{}", material.budget.error,
                          material.budget.metric == Budget::Metric::log ? "mean of the logarithm’s"
                                                                        : "relative L2",
                          material.budget.flip
                              ? fmt::format("; FLIP {:g}, mean over lights", *material.budget.flip)
                              : ""));
    entry.set("orientations", std::to_string(material.orientations.size()));
    entry.set("views", std::to_string(plan.views));
    entry.set("samples", std::to_string(plan.lightSamples));
    entry.set("samplingError", errorText(plan.referenceError));
    entry.set("rungs", std::to_string(plan.rungs));
    entry.set("tried", std::to_string(plan.tried));
    if (plan.cut) entry.set("cut", true);
    entry.set("rules", listOf(plan.rules));
    entry.set("choices", choiceRows(plan));
    entry.set("hasChoices", plan.accepted.has_value() || !plan.cheaper.empty());
    entry.set("formulas", formulaRows(plan, costs));
    entry.set("hasFormulas", !plan.formulas.empty());
    entry.set("bands", bandRows(plan.lightPower));
    entry.set("planned", plan.accepted.has_value());
    if (plan.accepted) {
        const Accepted& accepted = *plan.accepted;
        entry.set("bytes", std::to_string(accepted.choice.bytes));
        entry.set("times", timesSmaller(accepted.choice.bytes));
        entry.set("verified", errorText(accepted.verified));
        entry.set("file", material.name + ".json");
        if (accepted.cost) entry.set("shader", choice::cyclesText(accepted.cost));
        entry.set("elevations", elevationRows(accepted, material.budget.error));
    } else {
        entry.set("refused", plan.refused);
        entry.set("instead", listOf(plan.instead));
    }
    return entry;
}

}  // namespace

std::string planPage(const Plan& plan) {
    data page("style", std::string(pageStyle()));
    page.set("generator", std::string("hshfit ") + version);
    page.set("scene", plan.scene.file);
    const ViewRange& views = plan.scene.views;
    page.set("views", fmt::format("{:.4g}° to {:.4g}° off the normal, azimuths {:.4g}° to {:.4g}°",
                                  degrees(views.thetaMin), degrees(views.thetaMax),
                                  degrees(views.phiMin), degrees(views.phiMax)));
    page.set("tangent", views.anyTangent ? "turned in any way" : "fixed");
    page.set("limit", std::to_string(plan.scene.limits.bytes));
    page.set("lights", std::to_string(plan.scene.lights.size()));
    if (plan.costs) page.set("scale", choice::scaleText(*plan.costs));
    page.set("baseline", std::to_string(baselineBytes));
    data materials{data::type::list};
    for (const MaterialPlan& each : plan.materials)
        materials.push_back(materialData(each, plan.costs.has_value()));
    page.set("materials", materials);
    return filledPage(embedded::plan_html, page);
}

}  // namespace hshfit::plan
