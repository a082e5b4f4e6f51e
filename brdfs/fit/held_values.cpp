#include <brdfs/fit/held_values.h>

#include <brdfs/fit/free_parameters.h>
#include <brdfs/fit/split_models.h>
#include <brdfs/rows/spec.h>

#include <algorithm>
#include <cassert>
#include <utility>

namespace hshfit::brdfs {

std::vector<HeldValue> heldValues(std::string_view model, bool isotropic) {
    const std::vector<std::string> parts = splitModels(model), names = termNames(model);
    std::vector<HeldValue> held;
    for (std::size_t term = 0; term < parts.size(); ++term) {
        const std::string& part = parts[term];
        const std::size_t colon = part.find(':');
        const auto found =
            std::ranges::find(models(), std::string_view(part).substr(0, colon), &Model::name);
        assert(found != models().end());
        const Model& own = *found;
        const auto named = [&](std::string_view key) { return parameterName(names, term, key); };
        // A metal, which stands for n and k at each wavelength, is no parameter of the model.
        std::string text;
        for (std::size_t at = colon; at < part.size(); at = part.find(',', at + 1)) {
            const std::string item = part.substr(at + 1, part.find(',', at + 1) - at - 1);
            const std::string key = item.substr(0, item.find('='));
            if (std::ranges::find(own.parameters, key, &Parameter::name) != own.parameters.end())
                text += (text.empty() ? "" : ",") + item;
            else if (!item.empty())
                held.push_back({.name = named(key),
                                .numbers = {},
                                .word = item.substr(std::min(item.size(), key.size() + 1)),
                                .isStated = true});
        }
        const Parameters stated = readParameters(own.name, own.parameters, text),
                         values = withHeldParameters(own, stated, isotropic);
        for (const Parameter& parameter : own.parameters) {
            if (!values.given(parameter.name)) continue;
            HeldValue value{.name = named(parameter.name),
                            .numbers = {},
                            .word = {},
                            .isStated = stated.given(parameter.name)};
            const auto numbers = values.numbers.find(parameter.name);
            const auto word = values.words.find(parameter.name);
            if (numbers != values.numbers.end()) {
                value.numbers = numbers->second;
                value.isDefault =
                    parameter.fallback && value.numbers == std::vector<double>{*parameter.fallback};
            } else if (word != values.words.end()) {
                value.word = word->second;
                value.isDefault =
                    !parameter.choices.empty() && value.word == parameter.choices.front();
            }
            held.push_back(std::move(value));
        }
    }
    return held;
}

}  // namespace hshfit::brdfs
