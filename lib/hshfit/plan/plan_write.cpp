#include <hshfit/choice/row_text.h>
#include <hshfit/coefficient_files/representation_file.h>
#include <hshfit/files/file_set.h>
#include <hshfit/pictures/poor.h>
#include <hshfit/plan/plan_files.h>

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace hshfit::plan {
namespace {

/// A field of a CSV file, in quotes.
std::string field(const std::string& text) {
    std::string out(1, '"');
    for (char c : text) out.append(c == '"' ? 2 : 1, c);
    out += '"';
    return out;
}

/// A line for the formula within the budget that is nearest; without one, for the nearest of all.
std::string formulaText(const MaterialPlan& plan) {
    const auto best = std::ranges::min_element(plan.formulas, {}, [](const PlannedFormula& each) {
        return std::pair(!each.within, std::max(each.error, each.verified));
    });
    if (best == plan.formulas.end()) return "";
    const std::string command = choice::commandLineOf(best->row);
    return fmt::format(
        "  {}: {}, {} bytes{}, error {:.3g}, FLIP {:.3f} ({:.3f} at most)\n    {}\n",
        best->within ? "as a formula" : "no formula keeps to the budget; the nearest",
        best->row.name, best->row.made.bytes,
        best->row.cost ? fmt::format(", {} cycles", best->row.cost->cycles) : "", best->verified,
        best->row.picture.flip.mean, best->row.picture.flip.largest,
        command.empty() ? "no file is needed: " + best->row.made.spec : command);
}

std::string pairOf(const Choice* choice) {
    return choice ? fmt::format("{},{:.6g}", choice->bytes, choice->error) : ",";
}

}  // namespace

std::string planCsv(const Plan& plan) {
    std::string out =
        "material,brdf,bytes,error,verified,budget,metric,cheaper_bytes,cheaper_error,"
        "dearer_bytes,dearer_error,command,refused,flip,flip_budget\n";
    for (const MaterialPlan& each : plan.materials) {
        const Material& material = each.material;
        const Accepted* accepted = each.accepted ? &*each.accepted : nullptr;
        out += fmt::format("{},{},", material.name, field(material.brdf));
        out += accepted ? fmt::format("{},{:.6g},{:.6g},", accepted->choice.bytes,
                                      accepted->choice.error, accepted->verified)
                        : std::string(",,,");
        out +=
            fmt::format("{:g},{},{},{},", material.budget.error, metricName(material.budget.metric),
                        pairOf(each.cheaper.empty() ? nullptr : &each.cheaper.back()),
                        pairOf(each.dearer ? &*each.dearer : nullptr));
        const std::string file = material.name + ".json";
        if (accepted) out += field(commandOf(accepted->choice, file));
        out += ',';
        if (!accepted) out += field(each.refused);
        out += accepted ? fmt::format(",{:.6g},", accepted->picture.flip.mean) : ",,";
        out += material.budget.flip ? fmt::format("{:g}\n", *material.budget.flip) : "\n";
    }
    return out;
}

std::string planText(const Plan& plan) {
    std::string out;
    for (const MaterialPlan& each : plan.materials) {
        const Material& material = each.material;
        const std::string seen =
            each.seen ? "  " + sentenceOf(*each.seen, plan.scene.cameras.size()) + "\n" : "";
        if (!each.accepted) {
            out += fmt::format("{}: no plan: {}\n{}", material.name, each.refused, seen);
            for (const std::string& text : each.instead) {
                out += fmt::format("  instead: {}\n", text);
            }
            out += formulaText(each);
            continue;
        }
        const Accepted& accepted = *each.accepted;
        out += fmt::format(
            "{}: {} bytes ({:.0f} x fewer), error {:.3g} of {:g}{}{}\n  {}\n", material.name,
            accepted.choice.bytes,
            static_cast<double>(baselineBytes) / static_cast<double>(accepted.choice.bytes),
            accepted.verified, material.budget.error,
            material.budget.flip ? fmt::format(", FLIP {:.3f} of {:g}", accepted.picture.flip.mean,
                                               *material.budget.flip)
                                 : "",
            accepted.choice.nanoseconds
                ? fmt::format(", {:.3g} ns a pair", *accepted.choice.nanoseconds)
                : "",
            commandOf(accepted.choice, material.name + ".json"));
        if (each.cut)
            out += fmt::format(
                "  the time was over after {} of {} forms: a cheaper one may keep to the budget\n",
                each.tried, each.rungs);
        out += formulaText(each);
        out += seen;
        if (accepted.cost) out += fmt::format("  its shader: {} cycles\n", accepted.cost->cycles);
        out += "  " + summaryOf(accepted.picture) + "\n";
        if (const auto reason = poorReason(1 - accepted.pairs.energyLeft.value, accepted.picture))
            out += fmt::format("  poor beyond the light of this scene: {}{}\n", *reason,
                               material.budget.flip ? "" : "; \"flip\" in the budget bounds it");
        const std::string lines = textOf(accepted.pairs);
        for (std::size_t at = 0, end = 0; at < lines.size(); at = end + 1) {
            end = std::min(lines.find('\n', at), lines.size());
            out += "  " + lines.substr(at, end - at) + "\n";
        }
        if (!each.cheaper.empty()) {
            const Choice& next = each.cheaper.back();
            out += fmt::format("  next cheaper: {} bytes, error {:.3g}{}\n", next.bytes, next.error,
                               next.flip ? fmt::format(", FLIP {:.3f}", next.flip->mean) : "");
        }
    }
    if (plan.costs) out += fmt::format("cycles: {}\n", choice::scaleText(*plan.costs));
    return out;
}

void writePlan(const Plan& plan, const std::string& folder) {
    FileSet files(folder, true, FileSet::Above::require);
    for (const MaterialPlan& each : plan.materials) {
        if (!each.accepted) continue;
        files.write(each.material.name + ".json", [&](AtomicFile& file) {
            writeRepresentation(each.accepted->representation, file);
        });
    }
    files.write("plan.json", planJson(plan));
    files.write("plan.csv", planCsv(plan));
    files.write("plan.html", planPage(plan));
    files.commit();
}

}  // namespace hshfit::plan
