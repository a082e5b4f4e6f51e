#include <hshfit/choice/choice_files.h>

#include <hshfit/files/json_fields.h>
#include <hshfit/pages/picture_error_json.h>
#include <hshfit/version.h>

#include <fmt/format.h>

namespace hshfit::choice {
namespace {

using Json = nlohmann::ordered_json;

Json textOrNull(const std::string& text) {
    return text.empty() ? Json(nullptr) : Json(text);
}

Json costJson(const gpu::ShaderCost& cost) {
    return {{"instructions", cost.instructions},
            {"registers", cost.registers},
            {"spilled", cost.spilled},
            {"cycles", cost.cycles}};
}

Json costsJson(const Choice& choice) {
    if (!choice.costs) return {{"device", nullptr}, {"reason", choice.noCosts}};
    return {{"device", choice.costs->device}, {"ggx", costJson(choice.costs->ggx)}};
}

Json rowJson(const Row& row) {
    return {{"kind", row.kind},
            {"name", row.name},
            {"spec", row.made.spec},
            {"bytes", row.made.bytes},
            {"cost", row.cost ? costJson(*row.cost) : Json(nullptr)},
            {"lost", row.lost},
            {"poor", row.poor ? Json(*row.poor) : Json(nullptr)},
            {"unfit", textOrNull(row.unfit)},
            {"command", textOrNull(commandLineOf(row))},
            {"captured", finiteOrNull(row.captured)},
            {"picture", pictureErrorJson(row.picture)}};
}

}  // namespace

std::string choiceJson(const Choice& choice) {
    Json rows = Json::array(), leftOut = Json::array();
    for (const Row& row : choice.rows) rows.push_back(rowJson(row));
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
