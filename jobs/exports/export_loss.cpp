#include "export_loss.h"

#include <jobs/source/source.h>

#include <hshfit/accuracy/pair_errors.h>
#include <hshfit/error.h>
#include <hshfit/representation/forms/represented_brdf.h>

#include <fmt/format.h>

#include <algorithm>

namespace hshfit::jobs {

ExportLoss exportLoss(const Brdf& source, const Representation& file, const Brdf& exported) {
    const PairReference reference(source, spreadPairs());
    const auto of = [&](const Brdf& g) {
        return summaryOf(reference.pairs(), reference.errorsOf(g)).meanLog.value;
    };
    return {reference.pairs().size(), of(*reconstruct(file, sourceOpener())), of(exported)};
}

void refuseLoss(const ExportLoss& loss, const std::string& path,
                const std::optional<Setting>& cause) {
    if (loss.exported <= std::max(mostLoss * loss.file, smallLoss)) return;
    const std::string advice =
        cause ? fmt::format("leave out {}, or accept it", *cause) : "accept it";
    throw NumericError(fmt::format(
        "the export's mean log error is {:.3g}, that of {} is {:.3g}: more than {} times as large; "
        "{} with {}",
        loss.exported, path, loss.file, mostLoss, advice, Setting{"ExportOptions::allowLoss"}));
}

}  // namespace hshfit::jobs
