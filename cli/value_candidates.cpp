#include "candidates.h"

#include <hshfit/light/catalog.h>

#include <brdfs/catalog.h>
#include <brdfs/catalog/preset.h>
#include <brdfs/presets/preset_collection.h>

#include <fmt/format.h>

#include <algorithm>

namespace hshfit::cli {
namespace {

/// The parameters of a model or a light that `typed`, the text after its ':', may go on with.
std::vector<Word> parameterWords(std::span<const Parameter> parameters, const std::string& typed) {
    const std::size_t comma = typed.rfind(',');
    const std::string before = comma == std::string::npos ? "" : typed.substr(0, comma + 1);
    const std::string last = typed.substr(before.size());
    const std::size_t equals = last.find('=');
    std::vector<Word> words;
    for (const Parameter& parameter : parameters) {
        const std::string key = fmt::format("{}=", parameter.name);
        if (equals == std::string::npos) {
            if (("," + before).find("," + key) == std::string::npos)
                words.push_back({before + key, std::string(parameter.help)});
        } else if (last.substr(0, equals + 1) == key && parameter.kind == Parameter::Kind::choice) {
            for (const std::string_view choice : parameter.choices)
                words.push_back({fmt::format("{}{}{}", before, key, choice)});
        }
    }
    return words;
}

/// Rows by their names or, behind the name of a row and a colon, its parameters.
template <class Row>
void addRows(std::vector<Word>& words, std::span<const Row> rows, const std::string& typed) {
    const std::size_t colon = typed.find(':');
    for (const Row& row : rows) {
        const std::string name(row.name);
        if (colon == std::string::npos) words.push_back({name, std::string(row.help)});
        if (colon == std::string::npos || typed.substr(0, colon) != name) continue;
        for (const Word& word : parameterWords(row.parameters, typed.substr(colon + 1)))
            words.push_back({name + ":" + word.text, word.help});
    }
}

/// Presets and collections, or the materials of the collection before the '/'.
std::vector<Word> presetWords(const std::string& typed) {
    std::vector<Word> words;
    for (const brdfs::Preset& preset : brdfs::presets())
        words.push_back({fmt::format("preset:{}", preset.name), std::string(preset.help)});
    for (std::size_t k = 0; k < brdfs::presetCollections().size(); ++k) {
        const std::string name = fmt::format("preset:{}/", brdfs::presetCollections()[k].name);
        const brdfs::PresetCollection& collection = brdfs::presetCollection(k);
        if (!typed.starts_with(name)) {
            words.push_back({name, collection.help});
            continue;
        }
        for (const auto& material : collection.materials)
            words.push_back({name + material.name, material.spec});
    }
    return words;
}

void addBrdfs(std::vector<Word>& words, const std::string& typed) {
    if (typed.starts_with("preset:")) {
        words = presetWords(typed);
        return;
    }
    addRows(words, brdfs::models(), typed);
    if (typed.find(':') != std::string::npos) return;
    words.push_back({"preset:", "published materials"});
    words.push_back({"rgb:", "wavelengths as linear Rec. 709"});
    words.push_back({"grey:", "the mean of the channels"});
}

/// The end of what stands before the last term of a sum: its weight and prefixes are left out too.
std::size_t lastTerm(const std::string& typed, Syntax syntax) {
    const std::size_t plus = typed.rfind('+');
    std::size_t begin = plus == std::string::npos ? 0 : plus + 1;
    const auto skip = [&](std::size_t end) { begin = std::max(begin, end); };
    skip(std::min(typed.find_first_not_of(' ', begin), typed.size()));
    if (syntax != Syntax::brdf && syntax != Syntax::either) return begin;
    if (const std::size_t star = typed.find("* ", begin); star != std::string::npos) skip(star + 2);
    for (bool found = true; found;) {
        found = false;
        for (const std::string prefix : {"rgb:", "grey:"}) {
            if (typed.compare(begin, prefix.size(), prefix) != 0) continue;
            begin += prefix.size();
            found = true;
        }
    }
    return begin;
}

}  // namespace

Candidates valuesOf(const Values& row, const std::string& typed) {
    Candidates candidates{.words = {}, .files = row.files, .open = row.syntax != Syntax::word};
    std::size_t begin = 0;
    if (row.syntax == Syntax::list) {
        begin = typed.rfind(',') + 1;
    } else if (row.syntax != Syntax::word) {
        begin = lastTerm(typed, row.syntax);
    }
    const std::string last = typed.substr(begin);
    if (row.words) candidates.words = row.words();
    if (row.syntax == Syntax::brdf || row.syntax == Syntax::either)
        addBrdfs(candidates.words, last);
    if (row.syntax == Syntax::light || row.syntax == Syntax::either) {
        addRows(candidates.words, lightKinds(), last);
        addRows(candidates.words, std::span(&studioKind(), 1), last);
    }
    if (row.syntax == Syntax::list) candidates.open = begin > 0 || !row.words;
    for (Word& word : candidates.words) word.text = typed.substr(0, begin) + word.text;
    std::erase_if(candidates.words,
                  [&](const Word& word) { return !word.text.starts_with(typed); });
    if (begin > 0) candidates.files = Files::none;
    return candidates;
}

}  // namespace hshfit::cli
