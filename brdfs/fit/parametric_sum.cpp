#include <brdfs/fit/parametric_sum.h>
#include <brdfs/fit/split_models.h>

#include <brdfs/rows/spec.h>
#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace hshfit::brdfs {
namespace {

const Model& modelNamed(std::string_view name) {
    const auto found = std::ranges::find(models(), name, &Model::name);
    if (found != models().end()) return *found;
    std::vector<std::string_view> known;
    for (const Model& model : models()) known.push_back(model.name);
    throw UsageError(fmt::format("unknown model '{}'{}; known: {}", name, suggestion(name, known),
                                 joined(known)));
}

/// One function of the directions serves all channels, so that what is stated has to as well.
void checkGrey(const Model& model, const Parameters& stated) {
    for (const Parameter& parameter : model.parameters)
        if (stated.given(parameter.name) && parameter.kind == Parameter::Kind::colour &&
            stated.colour(parameter.name).size() > 1)
            throw UsageError(
                fmt::format("{}: {} is stated with three values; a fit keeps one for all "
                            "channels, or finds one for each if it is left out",
                            model.name, parameter.name));
}

double unitOf(double min, double max) {
    return std::min(max, std::max(1.0, 2 * min));
}

/// Whether f is 0 for pairs of directions near the mirror direction, at grazing angles and in
/// retroreflection.
bool isZero(const Brdf& brdf) {
    constexpr std::size_t count = 8;
    constexpr double theta[count] = {0.6, 0.55, 0.9, 0.2, 1.3, 0.6, 0.05, 1.5};
    constexpr double turn[count] = {pi, pi + 0.1, pi - 0.3, 2, 1, 0, 0, 3};
    for (std::size_t k = 0; k < count; ++k) {
        const std::vector<double> f = evaluate(brdf, directionFromAngles(theta[k], 0.3 + turn[k]),
                                               directionFromAngles(0.6, 0.3));
        if (std::ranges::any_of(f, [](double value) { return value != 0; })) return false;
    }
    return true;
}

/// Whether f in each channel depends on the value of `key` in that channel alone: a model with
/// tints mixes channels.
bool isSeparable(const Model& model, const Parameters& stated,
                 const std::vector<FreeParameter>& free, const std::string& key) {
    const std::vector<double> shares = {0.2, 0.5, 0.8};
    const auto at = [&](const std::vector<double>& values) {
        Parameters all = withDefaults(model, stated);
        for (const FreeParameter& other : free)
            for (const std::string& own : other.keys)
                all.set(own, own == key ? values : std::vector{other.startLow});
        const auto brdf = model.make(all);
        return evaluate(*brdf, directionFromAngles(0.7, 2.5), directionFromAngles(0.6, 0.3));
    };
    const std::vector<double> f = at(shares);
    if (f.size() != shares.size()) return false;
    for (std::size_t c = 0; c < shares.size(); ++c)
        if (std::abs(at({shares[c]}).front() - f[c]) > 1e-12 * std::abs(f[c])) return false;
    return true;
}

bool colours(const Model& model, const Parameters& stated) {
    return model.channelwise && model.channelwise(withDefaults(model, stated));
}

std::unique_ptr<Brdf> made(const Model& model, Parameters parameters) {
    return model.make(completed(model.name, model.parameters, std::move(parameters)));
}

}  // namespace

bool isChannelwise(std::string_view spec) {
    return std::ranges::any_of(splitModels(spec), [](const std::string& part) {
        const std::size_t colon = part.find(':');
        const auto found = std::ranges::find(models(), part.substr(0, colon), &Model::name);
        return found != models().end() && found->channelwise &&
               colours(*found, readParameters(found->name, found->parameters,
                                              colon == part.npos ? "" : part.substr(colon + 1)));
    });
}

double ShapeParameter::toScale(double value) const {
    return free.logarithmic ? std::log(value + offset) : value;
}

double ShapeParameter::toValue(double u) const {
    const double value = free.logarithmic ? std::exp(u) - offset : u;
    return std::clamp(value, free.min, free.max);
}

double ShapeParameter::step() const {
    return free.logarithmic ? 1e-5 : 1e-5 * (free.startHigh - free.startLow);
}

void Columns::eval(const Direction& wo, DirectionBatch wi, double* out) const {
    std::fill_n(out, count_ * wi.count, 0.0);
    double buffer[3 * 64];
    for (const Probe& probe : probes_) {
        const std::size_t channels = probe.brdf->channels().count();
        for (std::size_t start = 0; start < wi.count; start += 64) {
            const std::size_t n = std::min<std::size_t>(64, wi.count - start);
            probe.brdf->eval(wo, {wi.x + start, wi.y + start, wi.z + start, n}, buffer);
            for (std::size_t j = 0; j < n; ++j) {
                if (probe.first) out[start + j] += buffer[j];
                for (std::size_t i = 0; i < probe.linear; ++i) {
                    const double value = channels == 1 ? buffer[j] : buffer[(i + 1) * n + j];
                    out[(probe.base + 1 + i) * wi.count + start + j] =
                        (value - buffer[j]) / probe.unit[i];
                }
            }
        }
    }
}

ParametricSum::ParametricSum(std::string_view spec, bool isotropic, std::size_t channel,
                             bool coloured)
    : channel_(channel), coloured_(coloured) {
    const std::vector<std::string> parts = splitModels(spec), names = termNames(spec);
    for (const std::string& part : parts) {
        const std::size_t colon = part.find(':');
        const Model& model = modelNamed(std::string_view(part).substr(0, colon));
        const std::string text = colon == std::string::npos ? "" : part.substr(colon + 1);
        Term term{.model = &model,
                  .stated = withHeldParameters(
                      model, readParameters(model.name, model.parameters, text), isotropic),
                  .shapes = {},
                  .linears = {},
                  .shapeKeys = {},
                  .linearKeys = {},
                  .byFormula = model.columns != nullptr,
                  .channelwise = false};
        term.channelwise = colours(model, term.stated);
        hasColouredModel_ = hasColouredModel_ || term.channelwise;
        checkGrey(model, term.stated);
        const std::vector<FreeParameter> all =
            freeParameters(model, term.stated, isotropic, parts.size() > 1);
        for (const FreeParameter& free : all) {
            const std::string& key = free.keys.front();
            const std::string name = parameterName(names, terms_.size(), key);
            const bool linearised = coloured && free.albedo && model.columns &&
                                    isSeparable(model, term.stated, all, key);
            if (free.linear || linearised) {
                term.channelwise = term.channelwise || linearised;
                term.linears.push_back(linears_.size());
                term.linearKeys.push_back(key);
                linears_.push_back({.term = terms_.size(),
                                    .name = name,
                                    .key = key,
                                    .min = free.min,
                                    .max = free.max,
                                    .exact = free.linear});
                continue;
            }
            ShapeParameter shape{.term = terms_.size(), .name = name, .free = free};
            if (free.logarithmic && !(free.min > 0)) shape.offset = free.startLow / 10;
            term.shapes.push_back(shapes_.size());
            term.shapeKeys.push_back(free.keys);
            shapes_.push_back(std::move(shape));
        }
        scalable_ = scalable_ && vanishes(term);
        spec_ += (spec_.empty() ? "" : " + ") + part;
        terms_.push_back(std::move(term));
    }
    if (shapes_.empty() && linears_.empty())
        throw UsageError(
            fmt::format("'{}': every parameter is given, nothing is left to fit", spec));
}

const std::vector<std::size_t>& ParametricSum::linearsOf(std::size_t shape) const {
    return terms_[shapes_[shape].term].linears;
}

const std::vector<std::size_t>& ParametricSum::shapesOfTerm(std::size_t term) const {
    return terms_[term].shapes;
}

const std::vector<std::size_t>& ParametricSum::linearsOfTerm(std::size_t term) const {
    return terms_[term].linears;
}

void ParametricSum::forgetFormulas() {
    for (Term& term : terms_) term.byFormula = false;
}

std::unique_ptr<ModelColumns> ParametricSum::formulaColumns(std::size_t term,
                                                            std::span<const double> shapes,
                                                            bool derivatives) const {
    const Term& own = terms_[term];
    if (!own.byFormula) return nullptr;
    const Parameters values =
        completed(own.model->name, own.model->parameters, shaped(own, shapes));
    ColumnRequest request{.values = values, .linears = own.linearKeys};
    if (derivatives) request.shapes = own.shapeKeys;
    return own.model->columns(request);
}

std::vector<std::string> ParametricSum::sharedAlbedos() const {
    std::vector<std::string> names;
    for (const ShapeParameter& shape : shapes_)
        if (shape.free.albedo) names.push_back(shape.name);
    return names;
}

bool ParametricSum::channelwise() const {
    return std::ranges::any_of(terms_, &Term::channelwise);
}

std::unique_ptr<ModelColumns> ParametricSum::channelColumns(std::size_t term, std::size_t channel,
                                                            std::span<const double> shapes,
                                                            std::span<const double> linears,
                                                            bool derivatives) const {
    const Term& own = terms_[term];
    Parameters parameters = shaped(own, shapes);
    std::vector<std::vector<std::string>> keys;
    if (derivatives) keys = own.shapeKeys;
    for (const std::size_t k : own.linears) {
        parameters.set(linears_[k].key, {linears[k]});
        keys.push_back({linears_[k].key});
    }
    const Parameters values =
        completed(own.model->name, own.model->parameters, std::move(parameters));
    return own.model->columns({.values = values, .shapes = keys, .channel = channel_ + channel});
}

Parameters ParametricSum::shaped(const Term& term, std::span<const double> shapes) const {
    Parameters parameters = term.stated;
    for (const std::size_t j : term.shapes)
        for (const std::string& key : shapes_[j].free.keys) parameters.set(key, {shapes[j]});
    return parameters;
}

// With the linear parameters at 0, at two sets of shapes.
bool ParametricSum::vanishes(const Term& term) const {
    for (const double share : {0.3, 0.7}) {
        std::vector<double> values(shapes_.size(), 0.0);
        for (const std::size_t j : term.shapes) {
            const ShapeParameter& shape = shapes_[j];
            const double low = shape.toScale(shape.free.startLow),
                         high = shape.toScale(shape.free.startHigh);
            values[j] = shape.toValue(low + share * (high - low));
        }
        Parameters parameters = shaped(term, values);
        for (const std::size_t k : term.linears) parameters.set(linears_[k].key, {linears_[k].min});
        if (!isZero(*made(*term.model, std::move(parameters)))) return false;
    }
    return true;
}

// A colour has three channels: 0 has every linear parameter at its least, the next two one each at
// its unit.
void ParametricSum::addProbes(const Term& term, std::span<const double> shapes, Columns& columns,
                              std::size_t base) const {
    for (std::size_t first = 0; first == 0 || first < term.linears.size(); first += 2) {
        const std::size_t count = std::min<std::size_t>(2, term.linears.size() - first);
        Columns::Probe probe;
        Parameters parameters = shaped(term, shapes);
        for (std::size_t i = 0; i < term.linears.size(); ++i) {
            const LinearParameter& linear = linears_[term.linears[i]];
            std::vector<double> value(3, linear.min);
            if (i >= first && i < first + count) {
                const double unit = unitOf(linear.min, linear.max);
                value[i - first + 1] = unit;
                probe.unit.push_back(unit - linear.min);
            }
            parameters.set(linear.key, std::move(value));
        }
        probe.brdf = made(*term.model, std::move(parameters));
        probe.base = base + first;
        probe.first = first == 0;
        probe.linear = count;
        columns.probes_.push_back(std::move(probe));
    }
    columns.count_ += term.linears.size();
}

Columns ParametricSum::columnsOf(std::size_t term, std::span<const double> shapes) const {
    Columns columns;
    addProbes(terms_[term], shapes, columns, 0);
    return columns;
}

std::string ParametricSum::filledTerm(const Term& term,
                                      const std::vector<std::vector<double>>& shapes,
                                      std::span<const double> linear, std::size_t channels) const {
    const auto shapeOf = [&](std::size_t j, std::size_t c) {
        return shapes[shapes.size() == 1 ? 0 : c][j];
    };
    const auto colour = [&](const auto& value) {
        std::vector<double> values;
        for (std::size_t c = 0; c < channels; ++c) values.push_back(value(c));
        return values;
    };
    const bool split = std::ranges::any_of(term.shapes, [&](std::size_t j) {
        bool differs = false;
        for (std::size_t c = 1; c < channels; ++c) differs |= shapeOf(j, c) != shapeOf(j, 0);
        return differs && !shapes_[j].free.colour;
    });
    std::string spec;
    for (std::size_t part = 0; part < (split ? channels : 1); ++part) {
        Parameters parameters = term.stated;
        for (const std::size_t k : term.linears)
            parameters.set(linears_[k].key, colour([&](std::size_t c) {
                               return split && c != part ? 0.0 : linear[k * channels + c];
                           }));
        for (const std::size_t j : term.shapes)
            for (const std::string& key : shapes_[j].free.keys)
                parameters.set(key, shapes_[j].free.colour && !split
                                        ? colour([&](std::size_t c) { return shapeOf(j, c); })
                                        : std::vector{shapeOf(j, part)});
        const Model& model = *term.model;
        const std::string values =
            completed(model.name, model.parameters, std::move(parameters)).canonical();
        spec += fmt::format("{}{}{}{}", part > 0 ? " + " : "", model.name,
                            values.empty() ? "" : ":", values);
    }
    if (split && !scalable_)
        throw UsageError(fmt::format(
            "'{}': a lobe that does not vanish with its colours cannot have a shape per channel; "
            "leave out --per-channel",
            spec_));
    return spec;
}

std::string ParametricSum::filledIn(const std::vector<std::vector<double>>& shapes,
                                    std::span<const double> linear, std::size_t channels) const {
    assert(shapes.size() == 1 || shapes.size() == channels);
    std::string spec;
    for (const Term& term : terms_)
        spec += (spec.empty() ? "" : " + ") + filledTerm(term, shapes, linear, channels);
    return spec;
}

}  // namespace hshfit::brdfs
