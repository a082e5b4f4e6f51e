#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::brdfs {

/// Many materials that were fitted with one model, from one JSON:
///     {"format": "hshfit-presets", "version": 1, "model": "ward", "help": "…", "source": "…",
///      "parameters": {"variant": "duer"},
///      "correction": "what was done to the published values, or is to be known of them",
///      "channel_scale": {"factors": [1, 1.15, 1.66], "parameters": ["kd", "ks"]},
///      "materials": {"blue-acrylic": {"kd": [0.1, 0.2, 0.3], "ks": 0.04, "ax": 0.1, "ay": 0.1}}}
/// All but format, version, model and materials may be left out. `parameters` are common to all
/// materials. The named parameters of every material that gives them are multiplied by the factors
/// for red, green and blue on opening; the values in the file stay as published.
struct PresetCollection {
    struct Material {
        std::string name;
        std::string spec;  ///< of the model, corrections applied
    };
    std::string model, help, source, correction;
    std::vector<Material> materials;  ///< in the order of their names
};

/// `where` (a path or "preset:NAME") starts every message. Throws InputError: not JSON, another
/// format or version, a field absent or of the wrong type. Parameters are checked against the
/// model on opening.
PresetCollection parsePresetCollection(std::string_view text, const std::string& where);

/// Whether a JSON text has the format of a collection.
bool isPresetCollection(std::string_view text);

/// The material of this name; null if there is none.
const PresetCollection::Material* findMaterial(const PresetCollection& collection,
                                               std::string_view name);

/// One row of the table of collections that are part of the program, brdfs/presets/NAME.json.
struct CollectionEntry {
    std::string_view name;
    std::string_view text;  ///< the JSON
};
std::span<const CollectionEntry> presetCollections();

/// The parsed collection `presetCollections()[index]`: read on the first call, from any thread.
const PresetCollection& presetCollection(std::size_t index);

/// The index of the collection of this name.
std::optional<std::size_t> findPresetCollection(std::string_view name);

/// The names most similar to `word`, at most `most` of them, ignoring case. Names that contain
/// it come first. Others are ranked by edits: at most two over all its words (split at '-' and
/// '/'), or a third of its length.
std::vector<std::string> nearestNames(std::string_view word, std::span<const std::string> names,
                                      std::size_t most);

}  // namespace hshfit::brdfs
