#pragma once

#include <hshfit/plan/plan.h>

#include <string>

namespace hshfit::plan {

/// The document of `plan --json` (docs/schemas/plan.schema.json), with a line feed at the end.
std::string planJson(const Plan& plan);

/// One row for each material: material, brdf, form, bytes, error, verified, budget, metric, then
/// the next cheaper and dearer bytes and errors, the command, and why there is no plan.
std::string planCsv(const Plan& plan);

/// The HTML page of a plan.
std::string planPage(const Plan& plan);

/// The summary for the terminal.
std::string planText(const Plan& plan);

/// MATERIAL.json for each material that has a plan, then plan.json, plan.csv and plan.html; the
/// folder is made if it is absent. They appear together or not at all. Throws OutputError.
void writePlan(const Plan& plan, const std::string& folder);

}  // namespace hshfit::plan
