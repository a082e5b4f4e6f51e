#include <hshfit/files/file_set.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/stability/stress.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

namespace hshfit::stability {
namespace {

using Json = nlohmann::ordered_json;

constexpr double bounds[] = {1e-3, 1e-6, 1e-12};

Json degreesJson(const std::vector<DegreeErrors>& rows) {
    Json list = Json::array();
    for (const DegreeErrors& row : rows) {
        Json errors = Json::array();
        for (double e : row.error) errors.push_back(finiteOrNull(e));
        Json good = Json::object();
        for (double bound : bounds) good[fmt::format("{:g}", bound)] = row.goodUntil(bound);
        list.push_back({{"basis", row.basis},
                        {"precision", precisionName(row.precision)},
                        {"good_until_degree", good},
                        {"errors", errors}});
    }
    return list;
}

/// The degrees in tables: the degrees that the paper's applications use, and the last.
std::vector<std::size_t> shownDegrees(std::size_t count) {
    std::vector<std::size_t> degrees;
    for (std::size_t l : {6U, 64U, 300U})
        if (l + 1 < count) degrees.push_back(l);
    degrees.push_back(count - 1);
    return degrees;
}

std::string degreesTable(const std::vector<DegreeErrors>& rows) {
    if (rows.empty()) return {};
    std::size_t longest = 0;
    for (const DegreeErrors& row : rows) longest = std::max(longest, row.error.size());
    const std::vector<std::size_t> degrees = shownDegrees(longest);
    std::string text = "| basis | precision |";
    std::string rule = "|---|---|";
    for (std::size_t l : degrees) text += fmt::format(" degree {} |", l), rule += "---|";
    for (double bound : bounds) text += fmt::format(" {:g} until |", bound), rule += "---|";
    text += "\n" + rule + "\n";
    for (const DegreeErrors& row : rows) {
        text += fmt::format("| {} | {} |", row.basis, precisionName(row.precision));
        for (std::size_t l : degrees) {
            // A basis that lacks functions of a degree has no number there.
            const double error = l < row.error.size() ? row.error[l] : NAN;
            text += std::isnan(error) ? " |" : fmt::format(" {:.1e} |", error);
        }
        for (double bound : bounds) {
            const int good = row.goodUntil(bound);
            const bool all = good + 1 == static_cast<int>(row.error.size());
            if (all && row.error.size() < longest)
                text += fmt::format(" all, to {} |", good);
            else
                text += all ? " all |" : good < 0 ? " none |" : fmt::format(" {} |", good);
        }
        text += "\n";
    }
    return text;
}

std::string gramTable(const std::vector<GramPoint>& points) {
    std::string text = "| order | condition of G | kept | of |\n|---|---|---|---|\n";
    for (const GramPoint& point : points) {
        const double condition = point.gram.condition;
        text += fmt::format("| {} | {} | {} | {} |\n", point.order,
                            std::isinf(condition) ? "> 1e30" : fmt::format("{:.2g}", condition),
                            point.gram.kept, point.order * point.order);
    }
    return text;
}

template <class Cell>
std::string projectionTable(const std::vector<LobeProjection>& rows, const Cell& cell) {
    std::string text = "| lobe |", rule = "|---|";
    for (const LobeProjection& row : rows) {
        if (row.brdf != rows[0].brdf) break;
        text += fmt::format(" {:g}° |", row.thetaDegrees);
        rule += "---|";
    }
    text += "\n" + rule;
    const std::string* lobe = nullptr;
    for (const LobeProjection& row : rows) {
        if (!lobe || *lobe != row.brdf) text += fmt::format("\n| `{}` |", row.brdf);
        lobe = &row.brdf;
        text += row.converged ? fmt::format(" {} |", cell(row)) : " refused |";
    }
    return text + "\n";
}

std::string trialsTable(const std::vector<ErrorTrialSummary>& rows) {
    std::string text =
        "| of | trials | measured | coefficients hold | energy holds | both hold | worst | "
        "overstatement | evaluations |\n|---|---|---|---|---|---|---|---|---|\n";
    for (const ErrorTrialSummary& row : rows) {
        const std::string energies =
            row.energyMeasured > 0 ? fmt::format("{} of {}", row.energyHolds, row.energyMeasured)
                                   : std::string();
        const std::string overstatement = std::isfinite(row.medianOverstatement)
                                              ? fmt::format("{:.3g}", row.medianOverstatement)
                                              : std::string();
        text += fmt::format("| {} | {} | {} | {} | {} | {} | {:.2g} | {} | {} |\n", row.group,
                            row.trials, row.measured, row.coefficientsHold, energies, row.bothHold,
                            row.worst, overstatement, row.evaluations);
    }
    return text;
}

/// The cases in which a stated error does not hold, so that each can be projected again.
std::string exceptionsTable(const std::vector<ErrorTrialResult>& exceptions) {
    std::string text =
        "| BRDF | outgoing | basis, order | of | error stated | true | energy's stated | true |\n"
        "|---|---|---|---|---|---|---|---|\n";
    for (const ErrorTrialResult& row : exceptions) {
        const ErrorTrial& trial = row.trial;
        text +=
            fmt::format("| `{}` | {:.17g},{:.17g} | {} {} | {} | {:.2g} | {:.2g} |", trial.spec(),
                        trial.thetaDegrees, trial.phiDegrees, trial.basis, trial.order,
                        quantityName(trial.quantity), row.stated, row.coefficients);
        text += row.hasEnergy ? fmt::format(" {:.2g} | {:.2g} |\n", row.statedEnergy, row.energy)
                              : " | |\n";
    }
    std::set<std::string> commands;
    for (const ErrorTrialResult& row : exceptions)
        if (!row.trial.writtenBy.empty()) commands.insert(row.trial.writtenBy);
    if (!commands.empty()) text += "\nThe tables among them are written by:\n\n";
    for (const std::string& command : commands) text += "    " + command + "\n";
    return text;
}

Json exceptionsJson(const std::vector<ErrorTrialResult>& exceptions) {
    Json list = Json::array();
    for (const ErrorTrialResult& row : exceptions) {
        const ErrorTrial& trial = row.trial;
        list.push_back({{"brdf", trial.spec()},
                        {"theta_o", trial.thetaDegrees},
                        {"phi_o", trial.phiDegrees},
                        {"basis", trial.basis},
                        {"order", trial.order},
                        {"quantity", quantityName(trial.quantity)},
                        {"stated", row.stated},
                        {"true", finiteOrNull(row.coefficients)}});
        if (!trial.writtenBy.empty()) list.back()["written_by"] = trial.writtenBy;
        if (!row.hasEnergy) continue;
        list.back()["stated_energy"] = row.statedEnergy;
        list.back()["true_energy"] = finiteOrNull(row.energy);
    }
    return list;
}

Json trialsJson(const std::vector<ErrorTrialSummary>& rows) {
    Json list = Json::array();
    for (const ErrorTrialSummary& row : rows) {
        list.push_back({{"group", row.group},
                        {"trials", row.trials},
                        {"measured", row.measured},
                        {"coefficients_hold", row.coefficientsHold},
                        {"energies", row.energyMeasured},
                        {"energies_hold", row.energyHolds},
                        {"both_hold", row.bothHold},
                        {"worst", finiteOrNull(row.worst)},
                        {"median_overstatement", finiteOrNull(row.medianOverstatement)},
                        {"evaluations", row.evaluations},
                        {"exceptions", exceptionsJson(row.exceptions)}});
    }
    return list;
}

}  // namespace

std::string stressJson(const StressReport& report) {
    Json gram = Json::array(), projection = Json::array();
    for (const GramPoint& point : report.gram) {
        gram.push_back({{"order", point.order},
                        {"condition", finiteOrNull(point.gram.condition)},
                        {"kept", point.gram.kept},
                        {"functions", point.order * point.order}});
    }
    for (const LobeProjection& row : report.projection) {
        Json line = {
            {"brdf", row.brdf}, {"theta_o", row.thetaDegrees}, {"converged", row.converged}};
        if (row.converged) {
            line["error"] = row.error;
            line["captured"] = finiteOrNull(row.captured);
            line["evaluations"] = row.evaluations;
        } else {
            line["reason"] = row.reason;
        }
        projection.push_back(line);
    }
    const Json tried = report.triedTolerance > 0 ? Json(report.triedTolerance) : Json(nullptr);
    const Json document = {{"format", "hshfit-stress"},
                           {"version", 1},
                           {"max_order", report.maxOrder},
                           {"evaluation", degreesJson(report.evaluation)},
                           {"orthonormality", degreesJson(report.orthonormality)},
                           {"rotation", degreesJson(report.rotation)},
                           {"basis_change", degreesJson(report.basisChange)},
                           {"lsosh_gram", gram},
                           {"projection", projection},
                           {"tried_tolerance", tried},
                           {"stated_errors", trialsJson(report.statedErrors)}};
    return jsonText(document, 2) + "\n";
}

std::string stressMarkdown(const StressReport& report) {
    std::string text = fmt::format("# Numerical stability, orders to {}\n", report.maxOrder);
    if (!report.evaluation.empty()) {
        text += "\n## Evaluation\nLargest error of a function, relative to its largest value.\n\n" +
                degreesTable(report.evaluation);
        text += "\n## Orthonormality\nLargest deviation of the Gram matrix from the identity.\n\n" +
                degreesTable(report.orthonormality);
    }
    if (!report.rotation.empty())
        text +=
            "\n## Rotation\nSH in double: two rotations against their product. Hemispherical bases "
            "in double: the matrix against the transpose of that of the inverse rotation, which is "
            "its inverse for bases that are orthonormal over solid angle; others have no such row. "
            "Float: matrix times vector against double. All "
            "relative to the norm of a band.\n\n" +
            degreesTable(report.rotation);
    if (!report.basisChange.empty())
        text +=
            "\n## Change of basis\nLargest error of a coefficient of a function of norm 1, against "
            "extended precision.\n\n" +
            degreesTable(report.basisChange);
    if (!report.gram.empty())
        text += "\n## Least-squares spherical harmonics\n\n" + gramTable(report.gram);
    if (!report.statedErrors.empty()) {
        const std::string tolerance = report.triedTolerance > 0
                                          ? fmt::format("a tolerance of {}", report.triedTolerance)
                                          : std::string("the default tolerance");
        text += fmt::format(
            "\n## Stated errors\nRandom projections at {}, against ones at a hundredth of the "
            "default one or less.\n\n{}",
            tolerance, trialsTable(report.statedErrors));
    }
    if (!report.statedErrors.empty() && !report.statedErrors.back().exceptions.empty())
        text += "\nCases in which an error is larger than stated:\n\n" +
                exceptionsTable(report.statedErrors.back().exceptions);
    if (report.projection.empty()) return text;
    text += "\n## Projection of lobes\nf cos(theta_i) onto HSH, order 7, one outgoing direction.\n";
    text += "\nEstimated error:\n\n" + projectionTable(report.projection, [](const auto& row) {
                return fmt::format("{:.0e}", row.error);
            });
    text += "\nEvaluations of the BRDF:\n\n" +
            projectionTable(report.projection,
                            [](const auto& row) { return std::to_string(row.evaluations); });
    text += "\nShare of the energy that the 49 coefficients hold:\n\n" +
            projectionTable(report.projection, [](const auto& row) {
                return std::isfinite(row.captured) ? fmt::format("{:.4f}", row.captured)
                                                   : std::string("none");
            });
    return text;
}

std::string stressCsv(const StressReport& report) {
    std::string text = "quantity,basis,precision,degree,error\n";
    const auto add = [&](const char* quantity, const std::vector<DegreeErrors>& rows) {
        for (const DegreeErrors& row : rows) {
            for (std::size_t l = 0; l < row.error.size(); ++l) {
                if (std::isnan(row.error[l])) continue;
                text += fmt::format("{},{},{},{},{}\n", quantity, row.basis,
                                    precisionName(row.precision), l, row.error[l]);
            }
        }
    };
    add("evaluation", report.evaluation);
    add("orthonormality", report.orthonormality);
    add("rotation", report.rotation);
    add("basis_change", report.basisChange);
    return text;
}

void writeStress(const StressReport& report, const std::string& folder) {
    FileSet files(folder, true);
    files.write("stress.json", stressJson(report));
    files.write("stress.md", stressMarkdown(report));
    files.write("stress.csv", stressCsv(report));
    files.commit();
}

}  // namespace hshfit::stability
