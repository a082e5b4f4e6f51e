#include <brdfs/fit/parametric_sum.h>

#include <brdfs/spec.h>
#include <hshfit/error.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cassert>
#include <cctype>
#include <cmath>
#include <functional>
#include <numeric>

namespace hshfit::brdfs {
namespace {

/// Split at every '+' before a letter: the '+' of a number stands before a digit.
std::vector<std::string> splitModels(std::string_view spec) {
    std::vector<std::string> parts(1);
    for (std::size_t k = 0; k < spec.size(); ++k) {
        std::size_t next = k + 1;
        while (next < spec.size() && spec[next] == ' ') ++next;
        const bool letter =
            next < spec.size() && std::isalpha(static_cast<unsigned char>(spec[next]));
        if (spec[k] == '+' && letter) {
            parts.emplace_back();
        } else if (spec[k] != ' ') {
            parts.back() += spec[k];
        }
    }
    return parts;
}

const Model& modelNamed(std::string_view name) {
    const auto found = std::ranges::find(models(), name, &Model::name);
    if (found != models().end()) return *found;
    std::vector<std::string_view> known;
    for (const Model& model : models()) known.push_back(model.name);
    throw UsageError(fmt::format("unknown model '{}'{}; known: {}", name, suggestion(name, known),
                                 joined(known)));
}

void append(std::string& text, const std::string& item) {
    if (item.empty()) return;
    if (!text.empty()) text += ',';
    text += item;
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

/// Pairs of directions that show a function's dependence on a parameter: near the mirror direction,
/// at grazing angles and retroreflection.
struct ProbePairs {
    static constexpr int count = 8;
    double x[count], y[count], z[count];
    Direction wo = directionFromAngles(0.6, 0.3);

    ProbePairs() {
        constexpr double theta[count] = {0.6, 0.55, 0.9, 0.2, 1.3, 0.6, 0.05, 1.5};
        constexpr double turn[count] = {pi, pi + 0.1, pi - 0.3, 2, 1, 0, 0, 3};
        for (int k = 0; k < count; ++k) {
            const Direction d = directionFromAngles(theta[k], 0.3 + turn[k]);
            x[k] = d.x, y[k] = d.y, z[k] = d.z;
        }
    }
    /// [channel * count + k]
    std::vector<double> eval(const Brdf& brdf) const {
        std::vector<double> out(brdf.channels().count() * count);
        brdf.eval(wo, {x, y, z, count}, out.data());
        return out;
    }
};

}  // namespace

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

ParametricSum::ParametricSum(std::string_view spec, bool isotropic) {
    const std::vector<std::string> parts = splitModels(spec);
    for (const std::string& part : parts) {
        const std::size_t colon = part.find(':');
        const Model& model = modelNamed(std::string_view(part).substr(0, colon));
        Term term{.model = &model,
                  .stated = colon == std::string::npos ? "" : part.substr(colon + 1),
                  .shapes = {},
                  .linears = {},
                  .shapeKeys = {},
                  .linearKeys = {}};
        Parameters stated = statedParameters(model, term.stated);
        append(term.stated, heldParameters(model, stated, isotropic));
        stated = statedParameters(model, term.stated);
        checkGrey(model, stated);
        std::vector<FreeParameter> free =
            freeParameters(model, stated, isotropic, parts.size() > 1);
        const auto nameOf = [&](const std::string& key) {
            return parts.size() > 1 ? fmt::format("{}.{}", model.name, key) : key;
        };
        const std::size_t firstShape = shapes_.size(), index = terms_.size();
        const auto addShapes = [&] {
            term.shapes.clear();
            for (const FreeParameter& parameter : free) {
                ShapeParameter shape{
                    .term = index, .name = nameOf(parameter.keys.front()), .free = parameter};
                if (parameter.logarithmic && !(parameter.min > 0))
                    shape.offset = parameter.startLow / 10;
                term.shapes.push_back(shapes_.size());
                shapes_.push_back(std::move(shape));
            }
        };
        addShapes();
        findLinear(term, free);
        // What turned out to be linear leaves the shapes.
        shapes_.resize(firstShape);
        addShapes();
        for (const std::size_t k : term.linears) {
            linears_[k].name = nameOf(linears_[k].key);
            term.linearKeys.push_back(linears_[k].key);
        }
        for (const FreeParameter& parameter : free) term.shapeKeys.push_back(parameter.keys);
        term.byFormula = model.columns != nullptr;
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
        parseParameters(own.model->name, own.model->parameters, shapeText(own, shapes));
    ColumnRequest request{.values = values, .linears = own.linearKeys};
    if (derivatives) request.shapes = own.shapeKeys;
    return own.model->columns(request);
}

std::string ParametricSum::shapeText(const Term& term, std::span<const double> shapes) const {
    std::string text = term.stated;
    for (const std::size_t j : term.shapes)
        for (const std::string& key : shapes_[j].free.keys)
            append(text, fmt::format("{}={}", key, shapes[j]));
    return text;
}

std::unique_ptr<Brdf> ParametricSum::make(const Term& term, std::span<const double> shapes,
                                          const std::string& more) const {
    std::string text = shapeText(term, shapes);
    append(text, more);
    return term.model->make(parseParameters(term.model->name, term.model->parameters, text));
}

// f is linear in a set of parameters if it is in each, and none acts on the others: checked by
// second differences at two shapes. A colour has to act on its own channel alone. Scales, whose
// range is largest, come before reflectances, which multiply them.
void ParametricSum::findLinear(Term& term, std::vector<FreeParameter>& free) {
    const ProbePairs pairs;
    std::vector<std::size_t> accepted;  // of `free`
    const std::vector<std::size_t> shapesBefore = term.shapes;
    std::vector<double> values(shapes_.size(), 0.0);
    const auto at = [&](double share, const std::vector<std::pair<std::size_t, double>>& set) {
        for (std::size_t j = 0; j < free.size(); ++j) {
            const ShapeParameter& shape = shapes_[shapesBefore[j]];
            const double low = shape.toScale(free[j].startLow),
                         high = shape.toScale(free[j].startHigh);
            values[shapesBefore[j]] = shape.toValue(low + share * (high - low));
        }
        for (const std::size_t j : accepted) values[shapesBefore[j]] = free[j].min;
        for (const auto& [j, value] : set) values[shapesBefore[j]] = value;
        return pairs.eval(*make(term, values, ""));
    };
    const auto apart = [&](std::size_t j, double unit) {
        const double colour[] = {free[j].min, unit, free[j].min + 0.3 * (unit - free[j].min)};
        at(0.4, {});  // the others
        Term own = term;
        std::erase(own.shapes, shapesBefore[j]);
        const std::vector<double> whole = pairs.eval(*make(
            own, values,
            fmt::format("{}={}/{}/{}", free[j].keys.front(), colour[0], colour[1], colour[2])));
        for (std::size_t c = 0; c < 3; ++c) {
            const std::vector<double> grey = at(0.4, {{j, colour[c]}});
            for (std::size_t k = 0; k < ProbePairs::count; ++k) {
                const double value = whole[c * ProbePairs::count + k];
                if (std::abs(value - grey[k]) > 1e-11 * std::abs(value)) return false;
            }
        }
        return true;
    };
    const auto small = [](const std::vector<double>& a, const std::vector<double>& b,
                          const std::vector<double>& c, const std::vector<double>& d) {
        for (std::size_t k = 0; k < a.size(); ++k) {
            const double size = std::abs(a[k]) + std::abs(b[k]) + std::abs(c[k]) + std::abs(d[k]);
            if (std::abs(a[k] - b[k] - c[k] + d[k]) > 1e-11 * size) return false;
        }
        return true;
    };
    std::vector<std::size_t> order(free.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, std::greater(), [&](std::size_t j) { return free[j].max; });
    for (const std::size_t j : order) {
        if (!free[j].colour || free[j].keys.size() > 1 || free[j].min != 0) continue;
        const double low = free[j].min, unit = unitOf(low, free[j].max), half = (low + unit) / 2;
        bool linear = apart(j, unit);
        for (const double share : {0.3, 0.7}) {
            const auto base = at(share, {{j, low}}), middle = at(share, {{j, half}}),
                       full = at(share, {{j, unit}});
            linear = linear && small(full, middle, middle, base) && full != base;
            for (const std::size_t i : accepted) {
                const double other = unitOf(free[i].min, free[i].max);
                linear = linear && small(at(share, {{i, other}, {j, unit}}),
                                         at(share, {{i, other}, {j, low}}), full, base);
            }
        }
        if (linear) accepted.push_back(j);
    }
    std::ranges::sort(accepted);
    for (const double share : {0.3, 0.7})
        for (const double value : at(share, {})) scalable_ = scalable_ && value == 0;
    for (const std::size_t j : accepted) {
        term.linears.push_back(linears_.size());
        linears_.push_back({.term = terms_.size(),
                            .name = {},
                            .key = free[j].keys.front(),
                            .min = free[j].min,
                            .max = free[j].max});
    }
    for (auto j = accepted.rbegin(); j != accepted.rend(); ++j)
        free.erase(free.begin() + static_cast<std::ptrdiff_t>(*j));
}

// A colour has three channels: 0 has every linear parameter at its least, the next two one each at
// its unit.
void ParametricSum::addProbes(const Term& term, std::span<const double> shapes, Columns& columns,
                              std::size_t base) const {
    for (std::size_t first = 0; first == 0 || first < term.linears.size(); first += 2) {
        const std::size_t count = std::min<std::size_t>(2, term.linears.size() - first);
        Columns::Probe probe;
        std::string text;
        for (std::size_t i = 0; i < term.linears.size(); ++i) {
            const LinearParameter& linear = linears_[term.linears[i]];
            double value[3] = {linear.min, linear.min, linear.min};
            if (i >= first && i < first + count) {
                const double unit = unitOf(linear.min, linear.max);
                value[i - first + 1] = unit;
                probe.unit.push_back(unit - linear.min);
            }
            append(text, fmt::format("{}={}/{}/{}", linear.key, value[0], value[1], value[2]));
        }
        probe.brdf = make(term, shapes, text);
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
    const auto colour = [&](const std::string& key, const auto& value) {
        std::vector<double> values;
        for (std::size_t c = 0; c < channels; ++c) values.push_back(value(c));
        return fmt::format("{}={}", key, fmt::join(values, "/"));
    };
    const bool split = std::ranges::any_of(term.shapes, [&](std::size_t j) {
        bool differs = false;
        for (std::size_t c = 1; c < channels; ++c) differs |= shapeOf(j, c) != shapeOf(j, 0);
        return differs && !shapes_[j].free.colour;
    });
    std::string spec;
    for (std::size_t part = 0; part < (split ? channels : 1); ++part) {
        std::string text = term.stated;
        for (const std::size_t k : term.linears)
            append(text, colour(linears_[k].key, [&](std::size_t c) {
                       return split && c != part ? 0.0 : linear[k * channels + c];
                   }));
        for (const std::size_t j : term.shapes)
            for (const std::string& key : shapes_[j].free.keys)
                append(text, shapes_[j].free.colour && !split
                                 ? colour(key, [&](std::size_t c) { return shapeOf(j, c); })
                                 : fmt::format("{}={}", key, shapeOf(j, part)));
        const Model& model = *term.model;
        const std::string values = parseParameters(model.name, model.parameters, text).canonical();
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
