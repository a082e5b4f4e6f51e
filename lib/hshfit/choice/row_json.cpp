#include <hshfit/choice/row_json.h>

#include <hshfit/choice/row_text.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/pages/picture_error_json.h>

namespace hshfit::choice {

using Json = nlohmann::ordered_json;

Json rowJson(const Row& row) {
    const std::string command = commandLineOf(row);
    return {{"kind", row.kind},
            {"name", row.name},
            {"spec", row.made.spec},
            {"bytes", row.made.bytes},
            {"lost", row.lost},
            {"poor", row.poor ? Json(*row.poor) : Json(nullptr)},
            {"command", command.empty() ? Json(nullptr) : Json(command)},
            {"captured", finiteOrNull(row.captured)},
            {"picture", pictureErrorJson(row.picture)}};
}

Json costJson(const gpu::ShaderCost& cost) {
    return {{"instructions", cost.instructions},
            {"registers", cost.registers},
            {"spilled", cost.spilled},
            {"cycles", cost.cycles}};
}

Json scaleJson(const CostScale& scale) {
    return {{"device", scale.device}, {"ggx", costJson(scale.ggx)}};
}

}  // namespace hshfit::choice
