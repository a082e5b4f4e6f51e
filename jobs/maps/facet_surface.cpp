#include "facet_surface.h"

#include <hshfit/brdf/vectors.h>
#include <hshfit/error.h>
#include <hshfit/normal_filtering/surface_frame.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hshfit::jobs {
namespace {

constexpr double nodeTolerance = 0.01;  // of D between nodes, relative to its norm
constexpr std::size_t mostNodes = 65;
constexpr int nodeOrder = 33;

/// The factors of the terms of the lobe, and of the smooth part last, of a grey BRDF.
std::vector<double> factorsOf(const brdfs::FacetNormals& normals) {
    std::vector<double> lobe;
    double smooth = normals.weights.constant[0] * pi;
    for (std::size_t t = 0; t < normals.ofLobe.size(); ++t) {
        const double weight = normals.weights.terms[t][0];
        if (normals.ofLobe[t])
            lobe.push_back(weight);
        else if (weight != 0)
            smooth += weight * pi;
    }
    lobe.push_back(smooth);
    return lobe;
}

}  // namespace

/// The ratio of column i to column j, over the texels where either is not 0.
struct FacetSurface::ColumnRatio {
    double first = 0;  ///< in the order of texels
    double low = INFINITY, high = -INFINITY;
    double undefined = 0;  ///< whether column i has a value where j has none

    bool known() const { return high >= low; }
    bool holds() const {
        const auto near = [&](double value) {
            return std::abs(value - first) <= 1e-6 * std::abs(value);
        };
        return undefined == 0 && (!known() || (near(low) && near(high)));
    }
    /// Holds for no first value of texels before these either.
    bool varies() const {
        return undefined != 0 || high - low > 1e-5 * std::max(std::abs(low), std::abs(high));
    }
    void add(double a, double b) {
        if (b == 0) {
            if (a != 0) undefined = 1;
            return;
        }
        const double ratio = a / b;
        if (!known()) first = ratio;
        low = std::min(low, ratio);
        high = std::max(high, ratio);
    }
    /// Takes up the rows that follow.
    void add(const ColumnRatio& later) {
        if (!known()) first = later.first;
        low = std::min(low, later.low);
        high = std::max(high, later.high);
        undefined = std::max(undefined, later.undefined);
    }
};

FacetSurface::FacetSurface(ParameterMaps& maps, const std::string& file, Processes& processes,
                           const Listener& listener)
    : maps_(maps), common_(maps.common()) {
    try {
        classify(maps);
        findCorners();
        findNodes();
    } catch (const Error& error) {
        throw InputError(fmt::format("{}: {}", file, error.what()));
    }
    if (nodeError_ > nodeTolerance) {
        listener.say(fmt::format(
            "{}: the lobe varies so much that D between its {} nodes is off by up to {:.2g} of its "
            "norm (asked: {})",
            file, mostNodes, nodeError_, nodeTolerance));
    }
    findEqualColumns(processes, listener);
}

std::string FacetSurface::specification(const std::vector<double>& values) const {
    std::string spec = common_;
    for (std::size_t k = 0; k < varying_.size(); ++k) {
        spec += fmt::format("{}{}={}", spec.find(':') == std::string::npos ? ':' : ',',
                            varying_[k].name, values[k]);
    }
    return spec;
}

/// Values at which no term vanishes.
std::vector<double> FacetSurface::middle() const {
    std::vector<double> values;
    for (std::size_t k = 0; k < varying_.size(); ++k) {
        const double share = 0.4 + 0.07 * static_cast<double>(k % 4);
        values.push_back(varying_[k].low + share * (varying_[k].high - varying_[k].low));
    }
    return values;
}

void FacetSurface::classify(const ParameterMaps& maps) {
    std::size_t first = 0;
    for (const VaryingParameter& v : maps.varying()) {
        varying_.push_back({.name = std::string(v.row->name),
                            .first = first,
                            .channels = v.channels,
                            .low = v.low,
                            .high = v.high});
        first += v.channels;
        channels_ = std::max(channels_, v.channels);
    }
    const FacetLobe lobe(specification(middle()));
    turn_ = lobe.normals().turn;
    for (std::size_t k = 0; k < varying_.size(); ++k) {
        Varying& v = varying_[k];
        const Parameter& row = *maps.varying()[k].row;
        switch (row.role) {
            case Parameter::Role::turn:
                throw InputError(fmt::format(
                    "{} turns the lobe; state \"direction\" in the description", v.name));
            case Parameter::Role::both:
                throw InputError(fmt::format(
                    "{} changes both the lobe and its weight, so that it has to be the same for "
                    "all texels of a filtered map",
                    v.name));
            case Parameter::Role::weight:
                v.factor = true;
                v.low = std::max(row.min, 0.0);
                v.high = std::min(row.max, v.low + 1);
                factors_.push_back(k);
                continue;
            case Parameter::Role::shape:
                break;
        }
        if (v.channels > 1) {
            throw InputError(fmt::format(
                "{} changes the lobe, so that it has to be one number for all channels", v.name));
        }
        v.node = nodes_.size();
        nodes_.push_back({v.name, {}});
    }
    if (nodes_.size() > 2) throw InputError("more than two maps change the lobe; two are possible");
    if (factors_.size() > 8) throw InputError("more than 8 of its maps are factors");
}

/// Weights are affine in each parameter with that role: the corners of their ranges give the
/// others.
void FacetSurface::findCorners() {
    std::vector<double> values = middle();
    const auto at = [&] { return factorsOf(FacetLobe(specification(values)).normals()); };
    for (std::size_t corner = 0; corner < std::size_t{1} << factors_.size(); ++corner) {
        for (std::size_t i = 0; i < factors_.size(); ++i) {
            const Varying& v = varying_[factors_[i]];
            values[factors_[i]] = (corner >> i & 1) != 0 ? v.high : v.low;
        }
        corners_.push_back(at());
    }
    lobeTerms_ = corners_.front().size() - 1;
}

/// The distance of D at the middle of each interval of nodes from the mean of its ends, relative to
/// its norm: the largest at the ends and the middle of the other parameter.
std::vector<double> FacetSurface::intervalErrors(const std::string& model, std::size_t node) const {
    std::vector<LobeNodes> halved = nodes_;
    std::vector<double>& values = halved[node].values;
    for (std::size_t i = values.size(); i-- > 1;)
        values.insert(values.begin() + static_cast<std::ptrdiff_t>(i),
                      (values[i - 1] + values[i]) / 2);
    if (nodes_.size() > 1) {
        std::vector<double>& other = halved[1 - node].values;
        if (other.size() > 3) other = {other.front(), other[other.size() / 2], other.back()};
    }
    const std::size_t others = nodes_.size() > 1 ? halved[1 - node].values.size() : 1;
    const auto table = FacetLobes(model, halved).table(nodeOrder);
    const auto slots = static_cast<std::size_t>(nodeOrder * nodeOrder);
    std::vector<double> low(slots), middle(slots), high(slots);
    std::vector<double> errors;
    for (std::size_t i = 1; i < values.size(); i += 2) {
        double largest = 0;
        for (std::size_t other = 0; other < others; ++other) {
            const auto read = [&](std::size_t k, std::vector<double>& out) {
                LobePlace place{0, 0};
                place[1 - node] = static_cast<double>(other);
                place[node] = static_cast<double>(k);
                table->coefficients(place, out);
            };
            read(i - 1, low), read(i, middle), read(i + 1, high);
            double off = 0, whole = 0;
            for (std::size_t s = 0; s < slots; ++s) {
                const double difference = middle[s] - (low[s] + high[s]) / 2;
                off += difference * difference;
                whole += middle[s] * middle[s];
            }
            largest = std::max(largest, std::sqrt(off / whole));
        }
        errors.push_back(largest);
    }
    return errors;
}

/// Intervals are halved where they are too wide, of one parameter and the other in turns.
void FacetSurface::findNodes() {
    const std::vector<double> values = middle();
    std::string model = common_;
    for (std::size_t k = 0; k < varying_.size(); ++k) {
        if (!varying_[k].factor) continue;
        model += fmt::format("{}{}={}", model.find(':') == std::string::npos ? ':' : ',',
                             varying_[k].name, values[k]);
    }
    for (const Varying& v : varying_) {
        if (v.factor) continue;
        nodes_[v.node].values = {v.low};
        if (v.high > v.low) nodes_[v.node].values.push_back(v.high);
    }
    for (bool more = true; more;) {
        more = false;
        nodeError_ = 0;
        for (std::size_t node = 0; node < nodes_.size(); ++node) {
            std::vector<double>& nodes = nodes_[node].values;
            const std::vector<double> errors = intervalErrors(model, node);
            for (const double error : errors) nodeError_ = std::max(nodeError_, error);
            if (nodes.size() >= mostNodes) continue;
            for (std::size_t i = errors.size(); i-- > 0;) {
                if (errors[i] <= nodeTolerance) continue;
                more = true;
                nodes.insert(nodes.begin() + static_cast<std::ptrdiff_t>(i + 1),
                             (nodes[i] + nodes[i + 1]) / 2);
            }
        }
    }
    lobes_ = std::make_unique<FacetLobes>(model, nodes_);
}

std::vector<double> FacetSurface::columns(const std::vector<float>& values,
                                          std::size_t width) const {
    const std::size_t terms = lobeTerms_ + 1;
    std::vector<double> out(terms * channels_ * width, 0.0);
    for (std::size_t c = 0; c < channels_; ++c) {
        for (std::size_t x = 0; x < width; ++x) {
            double shares[8];
            for (std::size_t i = 0; i < factors_.size(); ++i) {
                const Varying& v = varying_[factors_[i]];
                const std::size_t at = v.first + (v.channels > 1 ? c : 0);
                shares[i] =
                    (static_cast<double>(values[at * width + x]) - v.low) / (v.high - v.low);
            }
            for (std::size_t corner = 0; corner < corners_.size(); ++corner) {
                double share = 1;
                for (std::size_t i = 0; i < factors_.size(); ++i)
                    share *= (corner >> i & 1) != 0 ? shares[i] : 1 - shares[i];
                for (std::size_t t = 0; t < terms; ++t)
                    out[(t * channels_ + c) * width + x] += share * corners_[corner][t];
            }
        }
    }
    // Rounding may leave less than 0.
    for (double& value : out) value = std::abs(value) < 1e-12 ? 0 : value;
    return out;
}

/// The ratios of each column to those before it, [column][column], and to 1: black where all are 0.
std::vector<FacetSurface::ColumnRatio> FacetSurface::columnRatios(const ItemRange& rows,
                                                                  const Listener& listener) {
    const std::size_t count = columnCount(), width = maps_.width();
    std::vector<ColumnRatio> ratios(count * count);
    const auto progress = listener.part("factors of lobes");
    for (std::size_t y = rows.first; y < rows.last; ++y) {
        const std::vector<double> all = columns(maps_.row(y), width);
        for (std::size_t i = 0; i < count; ++i) {
            const double* a = all.data() + i * width;
            for (std::size_t x = 0; x < width; ++x) ratios[i * count + i].add(a[x], 1);
            for (std::size_t j = 0; j < i; ++j) {
                ColumnRatio& ratio = ratios[i * count + j];
                const double* b = all.data() + j * width;
                for (std::size_t x = 0; !ratio.varies() && x < width; ++x) ratio.add(a[x], b[x]);
            }
        }
        if (progress) progress(y + 1 - rows.first, rows.last - rows.first);
    }
    return ratios;
}

/// Columns that are proportional in all texels become one weight.
void FacetSurface::findEqualColumns(Processes& processes, const Listener& listener) {
    const std::size_t count = columnCount(), all = count * count;
    const std::vector<ColumnRatio> own = columnRatios(processes.share(maps_.height()), listener);
    std::vector<ColumnRatio> ofAll(processes.count() * all), ratios(all);
    std::ranges::copy(own, ofAll.begin() + static_cast<std::ptrdiff_t>(processes.number() * all));
    gatherValues(processes, processes.count(), ofAll);
    for (std::size_t k = 0; k < ofAll.size(); ++k) ratios[k % all].add(ofAll[k]);
    const auto black = [&](std::size_t i) {
        const ColumnRatio& values = ratios[i * count + i];
        return values.low == 0 && values.high == 0;
    };
    terms_.assign(lobeTerms_, std::vector<LobeWeight>(channels_));
    for (std::size_t i = 0; i < lobeTerms_ * channels_; ++i) {
        LobeWeight& weight = terms_[i / channels_][i % channels_];
        if (black(i)) continue;
        std::size_t k = 0;
        while (k < columnOfWeight_.size() && !ratios[i * count + columnOfWeight_[k]].holds()) ++k;
        weight = {k, 1};
        if (k == columnOfWeight_.size())
            columnOfWeight_.push_back(i);
        else
            weight.scale = ratios[i * count + columnOfWeight_[k]].first;
    }
    const std::size_t smooth = lobeTerms_ * channels_;
    bool grey = true, none = true;
    for (std::size_t c = 0; c < channels_; ++c) {
        none = none && black(smooth + c);
        const ColumnRatio& ratio = ratios[(smooth + c) * count + smooth];
        if (c > 0) grey = grey && ((ratio.known() && ratio.holds() && ratio.first == 1) || none);
    }
    albedos_ = none ? 0 : grey ? 1 : static_cast<int>(channels_);
}

std::vector<SurfaceTexel> FacetSurface::row(std::size_t row) {
    const std::size_t width = maps_.width();
    const std::vector<float> values = maps_.row(row);
    const std::vector<double> all = columns(values, width);
    const std::vector<TexelTurn> turns = maps_.turns().row(row, width);
    std::vector<SurfaceTexel> texels(width);
    for (std::size_t x = 0; x < width; ++x) {
        SurfaceTexel& texel = texels[x];
        texel.normal = turns[x].normal;
        // The model's x axis is the direction's part in the tangent plane, where the lobe turns.
        const double azimuth = turns[x].azimuth;
        const SurfaceFrame frame(texel.normal, {std::cos(azimuth), std::sin(azimuth), 0});
        texel.tangent = std::cos(turn_) * frame.x + std::sin(turn_) * frame.y;
        for (const Varying& v : varying_) {
            if (v.factor) continue;
            texel.lobe[v.node] =
                nodes_[v.node].placeOf(static_cast<double>(values[v.first * width + x]));
        }
        for (std::size_t k = 0; k < columnOfWeight_.size(); ++k)
            texel.weights[k] = std::max(0.0, all[columnOfWeight_[k] * width + x]);
        for (std::size_t c = 0; c < static_cast<std::size_t>(albedos_); ++c)
            texel.albedos[c] = std::max(0.0, all[(lobeTerms_ * channels_ + c) * width + x]);
    }
    return texels;
}

}  // namespace hshfit::jobs
