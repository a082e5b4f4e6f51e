#pragma once

#include <jobs/common/listener.h>
#include <jobs/common/option_row.h>

#include <hshfit/choice/choice.h>
#include <hshfit/tradeoff/projection_folder.h>

#include <optional>
#include <string>
#include <vector>

namespace hshfit::jobs {

struct ChooseOptions {
    std::string renderer = "any";           ///< a row of choose_renderers.h
    std::vector<std::string> kinds = {};    ///< to try; empty: all
    std::optional<std::size_t> bytes = {};  ///< at most
    std::optional<std::size_t> cost = {};   ///< cycles at most: choice::ChoiceOptions::cycles
    std::optional<double> error = {};       ///< mean FLIP at most; none: PoorBounds::flip
    double seconds = choice::ChoiceOptions{}.cpuSeconds;  ///< of the processor, of all candidates
    tradeoff::ProjectionFolder folder = {};               ///< projections of earlier runs
};
OptionRows<ChooseOptions> chooseOptions();

/// The materials that a BRDF can be for a renderer, with their bytes and picture errors, and the
/// one to take:
///     model         the specification itself, where it is one of models
///     lobes         fits of Lambert and one or two GGX lobes
///     gltf, openpbr fits of the standard materials, as exportMaterials makes them
///     halfway       the halfway form of four sizes in half and unorm8
///     coefficients  both directions in one basis, and coefficients per outgoing direction
///     bsdf          a measured file of the RGL format, for renderers that read it
/// Colours are linear Rec. 709. `output` is a folder for choice.html, choice.json and the files of
/// the recommended row, or empty. Throws UsageError, InputError, NumericError and OutputError.
choice::Choice choose(const std::string& spec, const std::string& output,
                      const ChooseOptions& options, const Listener& listener = {});

}  // namespace hshfit::jobs
