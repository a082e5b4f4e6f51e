#include <hshfit/choice/choice_files.h>
#include <hshfit/choice/row_text.h>

#include <hshfit/pages/report_files.h>

#include <fmt/format.h>

#include <algorithm>

namespace hshfit::choice {

std::string choiceText(const Choice& choice) {
    std::size_t width = 4;
    for (const Row& row : choice.rows) width = std::max(width, row.name.size());
    std::string text = fmt::format(
        "{}, for {}\n  {:>9} {:>6}  {:>5} {:>7} {:>6} {:>6}  {:<{}}  lost\n", choice.source,
        choice.renderer, "bytes", "cycles", "FLIP", "largest", "dip", "peak", "what", width);
    for (std::size_t k = 0; k < choice.rows.size(); ++k) {
        const Row& row = choice.rows[k];
        const PictureError& picture = row.picture;
        text +=
            fmt::format("{} {:>9} {:>6}  {:>5.3f} {:>7.3f} {:>6} {:>6}  {:<{}}  {}{}\n",
                        choice.recommended == k ? "*" : " ", row.made.bytes, cyclesText(row.cost),
                        picture.flip.mean, picture.flip.largest, shareText(picture.dip),
                        shareText(picture.peak), row.name, width, row.lost,
                        !row.unfit.empty() ? fmt::format(" ({})", row.unfit)
                        : row.poor         ? " (poor)"
                                           : "");
    }
    text += fmt::format("  cycles: {}\n",
                        choice.costs ? scaleText(*choice.costs) : "not stated: " + choice.noCosts);
    for (const LeftOut& line : choice.leftOut)
        text += fmt::format("  left out: {}: {}\n", line.name, line.reason);
    if (!choice.recommended) return text + fmt::format("no recommendation: {}\n", choice.why);
    const Row& row = choice.rows[*choice.recommended];
    text += fmt::format("take {}: {}\n  lost: {}\n", row.name, choice.why, row.lost);
    const std::string command = commandLineOf(row);
    return text + (command.empty() ? fmt::format("  no file is needed: {}\n", row.made.spec)
                                   : fmt::format("  {}\n", command));
}

}  // namespace hshfit::choice
