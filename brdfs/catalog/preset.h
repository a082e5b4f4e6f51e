#pragma once

#include <hshfit/brdf/brdf.h>

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::brdfs {

/// One row of the table of presets that are part of the program: parameter values from published
/// work, kept in brdfs/presets/NAME.json:
///     {"format": "hshfit-preset", "version": 1, "model": "ward",
///      "parameters": {"ax": 0.2, "kd": [0.1, 0.2, 0.3], "variant": "duer"}, "source": "…"}
/// In place of "model" and "parameters" a preset may have "spec": a model or a sum of models
/// (sum.h), such as a fit writes, or "spectrum": such a specification, of a grey BRDF, for each of
/// several wavelengths (spectrum.h):
///     {…, "spectrum": [{"wavelength": 550, "spec": "lambert:kd=0.2"}, …]}
struct Preset {
    std::string_view name;
    std::string_view help;
    std::string_view text;  ///< the JSON
};
std::span<const Preset> presets();

/// The content of a preset: the specification of its model or models, and the source of its values.
struct PresetContent {
    struct Line {
        double wavelength = 0;  ///< nm
        std::string spec;
    };
    std::string spec;  ///< empty for a spectrum
    std::string source;
    std::vector<Line> spectrum;  ///< by ascending wavelengths
};

/// Reads the JSON of a preset. `where` (a path or "preset:NAME") starts every message.
/// Throws InputError: not JSON, another format or version, a field absent or of the wrong type.
PresetContent parsePreset(std::string_view text, const std::string& where);

/// Opens the BRDF of a preset. Fields that Preset does not name are ignored, so that the result of
/// a fit is a preset too. Throws InputError as above, or for an invalid parameter.
std::unique_ptr<Brdf> openPreset(std::string_view text, const std::string& where);

/// Opens one material of a collection's JSON. Throws UsageError if `material` is empty or not among
/// them (naming the nearest), InputError as above.
std::unique_ptr<Brdf> openMaterial(std::string_view collection, const std::string& where,
                                   std::string_view material);

/// Opens "preset:NAME": a row of the table, or COLLECTION/MATERIAL. Throws UsageError for an
/// unknown name (naming the nearest).
std::unique_ptr<Brdf> openNamedPreset(std::string_view name);

/// Whether `name` is a row of the table, or begins with a collection: a specification that lacks
/// its "preset:".
bool namesPreset(std::string_view name);

}  // namespace hshfit::brdfs
