#include <brdfs/presets/preset_collection.h>

#include <brdfs/presets/preset_json.h>
#include <brdfs/rows/spec.h>
#include <hshfit/error.h>
#include <hshfit/files/json_format.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <mutex>

namespace hshfit::embedded {
extern const std::string_view preset_ngan_ward, preset_ngan_ward_duer, preset_ngan_blinn_phong,
    preset_ngan_cook_torrance, preset_ngan_ashikhmin_shirley, preset_ngan_lafortune, preset_ngan_he,
    preset_low_ashikhmin_shirley_e1, preset_low_ashikhmin_shirley_e2, preset_low_cook_torrance_e1,
    preset_low_cook_torrance_e2, preset_low_abc_smooth_e2, preset_low_abc_microfacet_e2,
    preset_bagher_sgd;
}  // namespace hshfit::embedded

namespace hshfit::brdfs {
namespace {

constexpr std::string_view collectionFormat = "hshfit-presets";

struct ChannelScale {
    std::array<double, 3> factors{1, 1, 1};
    std::vector<std::string> parameters;

    bool applies(const std::string& parameter) const {
        return std::ranges::find(parameters, parameter) != parameters.end();
    }
};

ChannelScale parseScale(const JsonFields& collection) {
    if (!collection.has("channel_scale")) return {};
    const JsonFields fields = collection.object("channel_scale");
    ChannelScale scale;
    std::ranges::copy(fields.numbers("factors", 3), scale.factors.begin());
    scale.parameters = fields.words("parameters");
    return scale;
}

/// A number or three of them, times the factors.
Json scaled(const Json& value, const ChannelScale& scale) {
    Json product = Json::array();
    for (std::size_t c = 0; c < 3; ++c) {
        const Json& factor = value.is_array() && value.size() == 3 ? value[c] : value;
        if (!factor.is_number()) return value;  // the check of values reports it
        product.push_back(factor.get<double>() * scale.factors[c]);
    }
    return product;
}

std::string materialSpec(const PresetCollection& collection, const Json& common,
                         const Json& material, const ChannelScale& scale,
                         const std::string& where) {
    if (!material.is_object())
        throw InputError(where + ": a material has to be an object of parameters");
    Json values = common;
    for (const auto& [key, value] : material.items())
        values[key] = scale.applies(key) ? scaled(value, scale) : value;
    return presetSpec(collection.model, values, where);
}

std::string lowered(std::string_view text) {
    std::string lower(text);
    for (char& c : lower)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return lower;
}

std::vector<std::string> wordsOf(std::string_view text) {
    std::vector<std::string> words(1);
    for (const char c : text) {
        if (c != '-' && c != '/')
            words.back() += c;
        else if (!words.back().empty())
            words.emplace_back();
    }
    if (words.back().empty()) words.pop_back();
    return words;
}

/// The edits that make every one of `parts` a word of `candidate`.
std::size_t wordDistance(const std::vector<std::string>& parts, const std::string& candidate) {
    std::size_t sum = 0;
    for (const std::string& part : parts) {
        std::size_t least = part.size();
        for (const std::string& word : wordsOf(candidate))
            least = std::min(least, editDistance(part, word));
        sum += least;
    }
    return sum;
}

}  // namespace

bool isPresetCollection(std::string_view text) {
    return jsonFormat(text) == collectionFormat;
}

PresetCollection parsePresetCollection(std::string_view text, const std::string& where) {
    const Json json = parsePresetJson(text, std::string(collectionFormat), where);
    PresetCollection collection;
    const JsonFields fields(json, "", where);
    collection.model = modelField(fields);
    for (const auto& [name, field] :
         {std::pair{"help", &collection.help}, std::pair{"source", &collection.source},
          std::pair{"correction", &collection.correction}})
        if (fields.has(name)) *field = fields.word(name);
    Json common = Json::object();
    if (fields.has("parameters")) common = fields.object("parameters").json();
    const ChannelScale scale = parseScale(fields);
    for (const auto& [name, material] : fields.object("materials").json().items()) {
        if (name.empty()) throw InputError(where + ": a material without a name");
        collection.materials.push_back(
            {name, materialSpec(collection, common, material, scale, where + "/" + name)});
    }
    return collection;
}

const PresetCollection::Material* findMaterial(const PresetCollection& collection,
                                               std::string_view name) {
    const auto found =
        std::ranges::find(collection.materials, name, &PresetCollection::Material::name);
    return found == collection.materials.end() ? nullptr : &*found;
}

std::span<const CollectionEntry> presetCollections() {
    using namespace embedded;
    static const std::array table{
        CollectionEntry{"ngan-ward", preset_ngan_ward},
        CollectionEntry{"ngan-ward-duer", preset_ngan_ward_duer},
        CollectionEntry{"ngan-blinn-phong", preset_ngan_blinn_phong},
        CollectionEntry{"ngan-cook-torrance", preset_ngan_cook_torrance},
        CollectionEntry{"ngan-ashikhmin-shirley", preset_ngan_ashikhmin_shirley},
        CollectionEntry{"ngan-lafortune", preset_ngan_lafortune},
        CollectionEntry{"ngan-he", preset_ngan_he},
        CollectionEntry{"low-ashikhmin-shirley-e1", preset_low_ashikhmin_shirley_e1},
        CollectionEntry{"low-ashikhmin-shirley-e2", preset_low_ashikhmin_shirley_e2},
        CollectionEntry{"low-cook-torrance-e1", preset_low_cook_torrance_e1},
        CollectionEntry{"low-cook-torrance-e2", preset_low_cook_torrance_e2},
        CollectionEntry{"low-abc-smooth-e2", preset_low_abc_smooth_e2},
        CollectionEntry{"low-abc-microfacet-e2", preset_low_abc_microfacet_e2},
        CollectionEntry{"bagher-sgd", preset_bagher_sgd},
    };
    return table;
}

const PresetCollection& presetCollection(std::size_t index) {
    struct Slot {
        std::once_flag once;
        PresetCollection parsed;
    };
    static std::vector<Slot> slots(presetCollections().size());
    const CollectionEntry& entry = presetCollections()[index];
    Slot& slot = slots[index];
    std::call_once(slot.once, [&] {
        slot.parsed = parsePresetCollection(entry.text, fmt::format("preset:{}", entry.name));
    });
    return slot.parsed;
}

std::optional<std::size_t> findPresetCollection(std::string_view name) {
    const auto table = presetCollections();
    const auto found = std::ranges::find(table, name, &CollectionEntry::name);
    if (found == table.end()) return std::nullopt;
    return static_cast<std::size_t>(found - table.begin());
}

std::vector<std::string> nearestNames(std::string_view word, std::span<const std::string> names,
                                      std::size_t most) {
    const std::string wanted = lowered(word);
    const std::vector<std::string> parts = wordsOf(wanted);
    const std::size_t furthest = std::max<std::size_t>(2, wanted.size() / 3);
    constexpr std::size_t furthestWords = 2;
    std::vector<std::pair<std::size_t, std::string>> ranked;
    for (const std::string& name : names) {
        const std::string candidate = lowered(name);
        const std::size_t words = wordDistance(parts, candidate);
        const std::size_t whole = editDistance(wanted, candidate);
        if (candidate.find(wanted) != std::string::npos)
            ranked.emplace_back(0, name);
        else if (words <= furthestWords && words < wanted.size())
            ranked.emplace_back(1 + words, name);
        else if (whole <= furthest && whole < wanted.size())
            ranked.emplace_back(1 + whole, name);
    }
    std::ranges::stable_sort(ranked, {}, &std::pair<std::size_t, std::string>::first);
    std::vector<std::string> nearest;
    for (const auto& [rank, name] : ranked)
        if (nearest.size() < most) nearest.push_back(name);
    return nearest;
}

}  // namespace hshfit::brdfs
