#include <hshfit/choice/choice_files.h>
#include <hshfit/choice/row_json.h>

#include <hshfit/files/json_fields.h>
#include <hshfit/version.h>

#include <fmt/format.h>

namespace hshfit::choice {
namespace {

using Json = nlohmann::ordered_json;

Json costsJson(const Choice& choice) {
    if (!choice.costs) return {{"device", nullptr}, {"reason", choice.noCosts}};
    return scaleJson(*choice.costs);
}

}  // namespace

std::string choiceJson(const Choice& choice) {
    Json rows = Json::array(), leftOut = Json::array();
    for (const Row& row : choice.rows) {
        rows.push_back(rowJson(row));
        rows.back()["cost"] = row.cost ? costJson(*row.cost) : Json(nullptr);
        rows.back()["unfit"] = row.unfit.empty() ? Json(nullptr) : Json(row.unfit);
    }
    for (const LeftOut& line : choice.leftOut)
        leftOut.push_back({{"kind", line.kind}, {"name", line.name}, {"reason", line.reason}});
    const Json json = {
        {"format", "hshfit-choice"},
        {"version", 1},
        {"generator", std::string("hshfit ") + version},
        {"source", choice.source},
        {"renderer", choice.renderer},
        {"max_bytes", choice.maxBytes ? Json(*choice.maxBytes) : Json(nullptr)},
        {"max_cycles", choice.maxCycles ? Json(*choice.maxCycles) : Json(nullptr)},
        {"error", choice.error},
        {"costs", costsJson(choice)},
        {"recommended", choice.recommended ? Json(*choice.recommended) : Json(nullptr)},
        {"faithful", choice.faithful},
        {"why", choice.why},
        {"rows", rows},
        {"left_out", leftOut}};
    return jsonText(json, 2) + "\n";
}

}  // namespace hshfit::choice
