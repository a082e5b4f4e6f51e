#include <brdfs/fit/free_parameters.h>

#include <brdfs/rows/spec.h>

#include <algorithm>

namespace hshfit::brdfs {
namespace {

/// Whether "key=word" is what the model does, stated or by default; "key" is a number that is
/// stated and not 0.
bool chosen(std::string_view choice, const Model& model, const Parameters& stated) {
    const std::size_t equals = choice.find('=');
    if (equals == choice.npos) return stated.given(choice) && stated.number(choice) != 0;
    const std::string_view key = choice.substr(0, equals);
    const auto declared = std::ranges::find(model.parameters, key, &Parameter::name);
    const auto found = stated.words.find(key);
    const std::string_view word =
        found != stated.words.end() ? found->second : declared->choices.front();
    return word == choice.substr(equals + 1);
}

const FitRange* rangeOf(const Parameter& parameter, const Model& model, const Parameters& stated,
                        bool isotropic) {
    using Data = FitRange::Data;
    const auto applies = [&](const FitRange& range) {
        return range.data != (isotropic ? Data::anisotropic : Data::isotropic) &&
               (range.choice.empty() || chosen(range.choice, model, stated)) &&
               (range.unless.empty() || !stated.given(range.unless));
    };
    const auto found = std::ranges::find_if(parameter.fit, applies);
    return found == parameter.fit.end() ? nullptr : &*found;
}

/// Whether it is an index of refraction of a standard material. Fits keep the index within the
/// range of their starts, the indices of usual dielectrics: beyond it the index only scales the
/// lobe, as other parameters do.
bool isIndex(const Model& model, const Parameter& parameter) {
    return !model.parts.empty() && parameter.min == 1;
}

/// Whether it adds a diffuse part that its model may do without: other terms of a sum have one.
bool addsDiffuse(const Parameter& parameter) {
    return (parameter.name == "kd" || parameter.name == "Rd") && parameter.fallback == 0.0;
}

/// Whether a colour in which f is not linear has to take a value for each channel. Its row says in
/// which cases f is linear in it. A reflectance under a free ks is one number: ks has the channels.
bool isAlbedo(const Model& model, const Parameter& parameter, const Parameters& values) {
    const bool scaled =
        std::ranges::find(model.parameters, "ks", &Parameter::name) != model.parameters.end();
    return parameter.kind == Parameter::Kind::colour && parameter.linear &&
           !parameter.linear(values) && !(scaled && !values.given("ks"));
}

/// Angles that turn a lobe are free within two whole turns, and start within the half turn after
/// which the lobe is the same.
double periodOf(const Parameter& parameter, const FitRange& range) {
    const bool turns = range.low == 0 && range.high == pi && parameter.min == -2 * pi;
    return turns ? pi : 0;
}

}  // namespace

std::vector<FreeParameter> freeParameters(const Model& model, const Parameters& stated,
                                          bool isotropic, bool inSum) {
    Parameters values = withDefaults(model, stated);
    for (const Parameter& parameter : model.parameters)
        if (inSum && addsDiffuse(parameter)) values.stated.emplace(parameter.name);
    std::vector<FreeParameter> free;
    for (const Parameter& parameter : model.parameters) {
        if (stated.given(parameter.name) || (inSum && addsDiffuse(parameter))) continue;
        const FitRange* range = rangeOf(parameter, model, stated, isotropic);
        if (!range || range->low == range->high) continue;
        if (isotropic && !range->follows.empty()) {
            const auto leader = std::ranges::find_if(free, [&](const FreeParameter& other) {
                return other.keys.front() == range->follows;
            });
            if (leader != free.end()) {
                leader->keys.emplace_back(parameter.name);
                continue;
            }
        }
        const bool usual = isIndex(model, parameter);
        free.push_back({.keys = {std::string(parameter.name)},
                        .min = usual ? range->low : parameter.min,
                        .max = usual ? range->high : parameter.max,
                        .logarithmic = range->logarithmic,
                        .startLow = range->low,
                        .startHigh = range->high,
                        .colour = parameter.kind == Parameter::Kind::colour,
                        .linear = parameter.linear && parameter.linear(values),
                        .albedo = isAlbedo(model, parameter, values),
                        .period = periodOf(parameter, *range)});
    }
    return free;
}

Parameters withHeldParameters(const Model& model, Parameters stated, bool isotropic) {
    Parameters all = stated;
    for (const Parameter& parameter : model.parameters) {
        const FitRange* range = rangeOf(parameter, model, stated, isotropic);
        if (stated.given(parameter.name) || !range || range->low != range->high) continue;
        all.set(parameter.name, {range->low});
    }
    return all;
}

Parameters withDefaults(const Model& model, const Parameters& stated) {
    std::vector<Parameter> optional = model.parameters;
    for (Parameter& parameter : optional)
        if (parameter.kind != Parameter::Kind::choice && !parameter.fallback)
            parameter.fallback = parameter.min;
    return completed(model.name, optional, stated);
}

}  // namespace hshfit::brdfs
