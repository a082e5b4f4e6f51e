#include "svbrdf_filtered.h"

#include <hshfit/percent.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace hshfit::cli {
namespace {

std::string formText(const std::string& form, int order) {
    return order > 0 ? fmt::format("{} of order {}", form, order) : form;
}

std::string textOf(const jobs::FilteredLevel& level, std::size_t index) {
    std::string text =
        fmt::format("  level {:>2}: {} x {}", index, level.size.width, level.size.height);
    if (level.texels == 0) return text + "\n";
    const jobs::FilteredError &stored = level.stored, &parameters = level.parameters;
    text += fmt::format(
        "; against samples of the reflectance {}, worst texel {} at ({}, {}), albedo {:.3f} of the "
        "true one (averaged parameters: {}, worst {}, albedo {:.3f}; {:.1f} x)",
        percent(stored.relative, 2), percent(stored.maximum, 2), stored.column, stored.row,
        stored.albedo, percent(parameters.relative, 2), percent(parameters.maximum, 2),
        parameters.albedo, stored.relative > 0 ? parameters.relative / stored.relative : 0);
    if (level.noise > 0)
        text += fmt::format("; the samples' own error {}", percent(level.noise, 2));
    return text + "\n";
}

}  // namespace

std::string textOf(const jobs::FilteredMapAnswer& done) {
    std::string text = fmt::format(
        "{}: {} x {} texels of {}; lobe {}, {} factors and {} albedos a texel\n", done.description,
        done.width, done.height, done.model,
        done.parameters.empty()
            ? "the same for all"
            : fmt::format("by {} at {} nodes, off by {} at most between them",
                          fmt::join(done.parameters, ", "), done.nodes, percent(done.nodeError, 2)),
        done.weights, done.albedos);
    if (!done.choices.empty()) {
        text += "forms, by the error of their worst level:\n";
        for (const jobs::FilteredChoice& choice : done.choices) {
            text += fmt::format(
                "  {:<24} {:>5} numbers, {:>5g} bytes a texel, error {} (level {}), "
                "worst texel {} at ({}, {}) of level {}\n",
                formText(choice.form, choice.order), choice.numbers, choice.bytesOfTexel,
                percent(choice.error, 2), choice.level, percent(choice.maximum, 2), choice.column,
                choice.row, choice.maximumLevel);
        }
    }
    text += fmt::format("{}, {:.4g} MB, {:.1f} s ({:.3g} texels a second)\n",
                        formText(done.form, done.order), static_cast<double>(done.bytes) / 1e6,
                        done.seconds, done.rate);
    for (std::size_t level = 0; level < done.levels.size(); ++level)
        text += textOf(done.levels[level], level);
    for (const std::string& file : done.files) text += fmt::format("  {}\n", file);
    return text;
}

}  // namespace hshfit::cli
