#include <hshfit/choice/row_text.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace hshfit::choice {

std::string commandLineOf(const Row& row) {
    return fmt::format("{}", fmt::join(row.made.commands, " && "));
}

std::string cyclesText(const std::optional<gpu::ShaderCost>& cost) {
    return cost ? fmt::format("{}", cost->cycles) : "-";
}

std::string scaleText(const CostScale& scale) {
    return fmt::format(
        "of AMD's {} for 64 threads, by Mesa's compiler; Lambert with GGX takes {}; -: a renderer "
        "has its own shader",
        scale.device, scale.ggx.cycles);
}

}  // namespace hshfit::choice
