#include <brdfs/fit/lobe_formula.h>

#include <brdfs/fit/lobe_row.h>

#include <algorithm>

namespace hshfit::brdfs {
namespace {

/// A Lambert term alone.
class Constant final : public LobeFormula {
public:
    std::unique_ptr<LobeColumns> at(std::span<const double>, bool) const override {
        return std::make_unique<Columns>();
    }

private:
    class Columns final : public LobeColumns {
        void fill(const FitSamples&, std::size_t, std::size_t size, double*, double* linear,
                  double*) const override {
            std::fill_n(linear, size, 1 / pi);
        }
    };
};

LobeWords wordsOf(const Model& model, const Parameters& stated) {
    LobeWords words;
    for (const Parameter& parameter : model.parameters)
        if (parameter.kind == Parameter::Kind::choice) {
            const auto found = stated.words.find(parameter.name);
            words[std::string(parameter.name)] = found != stated.words.end()
                                                     ? found->second
                                                     : std::string(parameter.choices.front());
        }
    return words;
}

/// The one value that a parameter has if it is not free: as stated, or by default.
std::optional<double> fixedValue(const Parameter& parameter, const Parameters& stated) {
    if (!stated.given(parameter.name)) {
        const bool within = parameter.fallback && *parameter.fallback >= parameter.min &&
                            *parameter.fallback <= parameter.max;
        return within ? parameter.fallback : std::nullopt;
    }
    const std::vector<double>& values = stated.numbers.find(parameter.name)->second;
    return values.size() == 1 ? std::optional(values.front()) : std::nullopt;
}

bool chosen(const LobeRow& row, const LobeWords& words) {
    if (row.choice.empty()) return true;
    const std::size_t equals = row.choice.find('=');
    return words.at(std::string(row.choice.substr(0, equals))) == row.choice.substr(equals + 1);
}

/// Whether every parameter that a formula takes for the same as this one is.
bool takesFollowers(const Model& model, const FreeParameter& shape) {
    return std::ranges::all_of(model.parameters, [&](const Parameter& parameter) {
        const bool follows = std::ranges::any_of(parameter.fit, [&](const FitRange& range) {
            return range.follows == shape.keys.front();
        });
        return !follows || std::ranges::find(shape.keys, parameter.name) != shape.keys.end();
    });
}

std::optional<LobePlaces> placesIn(const LobeRow& row, const Model& model, const Parameters& stated,
                                   const std::vector<FreeParameter>& shapes,
                                   const std::vector<std::string>& linearKeys) {
    LobePlaces places;
    places.words = wordsOf(model, stated);
    if (row.model != model.name || !chosen(row, places.words)) return {};
    places.linears = linearKeys.size();
    places.values.assign(row.parameters.size(), 0.0);
    places.free.assign(shapes.size(), row.parameters.size());
    for (const Parameter& parameter : model.parameters) {
        if (parameter.kind == Parameter::Kind::choice) continue;
        const auto in = std::ranges::find(row.parameters, parameter.name);
        const auto shape = std::ranges::find(shapes, parameter.name,
                                             [](const FreeParameter& s) { return s.keys.front(); });
        const auto linear = std::ranges::find(linearKeys, parameter.name);
        const auto at = static_cast<std::size_t>(in - row.parameters.begin());
        if (shape != shapes.end()) {
            if (in == row.parameters.end() || !takesFollowers(model, *shape)) return {};
            places.free[static_cast<std::size_t>(shape - shapes.begin())] = at;
        } else if (linear != linearKeys.end()) {
            const auto column = static_cast<std::size_t>(linear - linearKeys.begin());
            if (parameter.name == row.linear)
                places.lobe = column;
            else if (parameter.name == "kd")
                places.diffuse = column;
            else
                return {};
        } else {
            const std::optional<double> value = fixedValue(parameter, stated);
            if (in != row.parameters.end() || parameter.name == row.linear ||
                parameter.name == "kd") {
                if (!value) return {};
                if (in != row.parameters.end())
                    places.values[at] = *value;
                else
                    (parameter.name == "kd" ? places.diffuseValue : places.lobeValue) = *value;
            } else if (stated.given(parameter.name)) {
                return {};
            }
        }
    }
    return places;
}

}  // namespace

std::unique_ptr<LobeFormula> makeLobeFormula(const Model& model, const Parameters& stated,
                                             const std::vector<FreeParameter>& shapes,
                                             const std::vector<std::string>& linearKeys) {
    if (model.name == "lambert" && linearKeys.size() == 1) return std::make_unique<Constant>();
    for (const auto table : {cosineLobes(), facetLobes(), fittedLobes(), disneyLobes()})
        for (const LobeRow& row : table)
            if (auto places = placesIn(row, model, stated, shapes, linearKeys))
                return row.make(std::move(*places));
    return nullptr;
}

}  // namespace hshfit::brdfs
