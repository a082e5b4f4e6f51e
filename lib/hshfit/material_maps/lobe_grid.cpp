#include <hshfit/material_maps/lobe_grid.h>

#include <hshfit/each_in_parallel.h>
#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>

namespace hshfit::inline material_maps {
namespace {

constexpr std::size_t firstIntervals = 4;
constexpr std::size_t padding = 16;  // floats that vector code may read beyond a row

/// Every combination of one index per axis, the last axis fastest.
template <class Visit>
void eachIndex(const std::vector<std::size_t>& sizes, const Visit& visit) {
    std::vector<std::size_t> index(sizes.size(), 0);
    while (true) {
        visit(index);
        std::size_t a = sizes.size();
        while (a > 0 && ++index[a - 1] == sizes[a - 1]) index[--a] = 0;
        if (a == 0) return;
    }
}

}  // namespace

/// Computed lobes by place, and the refinement of the grid.
struct LobeGrid::Builder {
    const LobeFunction& function;
    const LobeGridOptions& options;
    std::vector<Axis>& axes;
    std::map<std::vector<double>, std::vector<double>> known = {};
    double error = 0;  ///< of the last test

    std::vector<double> parameters(const std::vector<double>& place) const {
        std::vector<double> p(place);
        for (std::size_t a = 0; a < p.size(); ++a) {
            if (axes[a].logarithmic) p[a] = std::exp(p[a]);
            p[a] = std::clamp(p[a], function.axes[a].low, function.axes[a].high);
        }
        return p;
    }

    void compute(std::vector<std::vector<double>> places) {
        std::erase_if(places, [&](const auto& place) { return known.contains(place); });
        std::ranges::sort(places);
        places.erase(std::unique(places.begin(), places.end()), places.end());
        if (known.size() + places.size() > options.mostNodes) {
            throw NumericError(fmt::format(
                "a table of lobes over {} parameters has an error of {:.2g} after {} evaluations; "
                "{:.2g} would take more than {}",
                axes.size(), error, known.size(), options.tolerance, options.mostNodes));
        }
        std::vector<std::vector<double>> values(places.size());
        std::atomic<std::size_t> done = 0;
        eachInParallel(places.size(), [&](std::size_t k) {
            values[k] = function.at(parameters(places[k]));
            if (options.progress) options.progress(++done, places.size());
        });
        for (std::size_t k = 0; k < places.size(); ++k) known[places[k]] = std::move(values[k]);
    }

    std::vector<std::size_t> sizes() const {
        std::vector<std::size_t> result;
        for (const Axis& axis : axes) result.push_back(axis.places.size());
        return result;
    }
    std::vector<double> placeOf(const std::vector<std::size_t>& index) const {
        std::vector<double> place(index.size());
        for (std::size_t a = 0; a < index.size(); ++a) place[a] = axes[a].places[index[a]];
        return place;
    }
    void computeNodes() {
        std::vector<std::vector<double>> places;
        eachIndex(sizes(), [&](const auto& index) { places.push_back(placeOf(index)); });
        compute(std::move(places));
    }

    /// The relative error of interpolation along one axis at a place between two of its nodes.
    double errorAt(const std::vector<double>& place, std::size_t axis) const {
        const std::vector<double>& exact = known.at(place);
        std::vector<double> sum(exact.size(), 0.0);
        const Stencil stencil = stencilOf(axes[axis], place[axis]);
        std::vector<double> node(place);
        for (std::size_t k = 0; k < stencil.count; ++k) {
            node[axis] = axes[axis].places[stencil.first + k];
            const std::vector<double>& values = known.at(node);
            for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += stencil.weight[k] * values[i];
        }
        double worst = 0;
        for (std::size_t lobe = 0; lobe < function.lobes; ++lobe) {
            double off = 0, whole = 0;
            for (std::size_t i = 0; i < function.length; ++i) {
                const std::size_t at = lobe * function.length + i;
                off += function.weights[i] * (sum[at] - exact[at]) * (sum[at] - exact[at]);
                whole += function.weights[i] * exact[at] * exact[at];
            }
            if (off > 0) worst = std::max(worst, std::sqrt(off / whole));
        }
        return worst;
    }

    /// Halves the intervals of an axis in which interpolation is too far off; false without any.
    bool refine(std::size_t axis) {
        const std::vector<double> nodes = axes[axis].places;
        std::vector<std::size_t> counts = sizes();
        counts[axis] = nodes.size() - 1;
        std::vector<std::vector<double>> tests;
        std::vector<std::size_t> interval;
        eachIndex(counts, [&](const auto& index) {
            std::vector<double> place = placeOf(index);
            place[axis] = (nodes[index[axis]] + nodes[index[axis] + 1]) / 2;
            tests.push_back(std::move(place));
            interval.push_back(index[axis]);
        });
        compute(tests);
        std::vector<bool> halved(nodes.size(), false);
        bool any = false;
        for (std::size_t k = 0; k < tests.size(); ++k) {
            const double off = errorAt(tests[k], axis);
            if (!std::isfinite(off)) {
                throw NumericError("a lobe has coefficients that are not finite");
            }
            error = std::max(error, off);
            if (off > options.tolerance) any = halved[interval[k]] = true;
        }
        std::vector<double>& places = axes[axis].places;
        for (std::size_t k = 0; k + 1 < nodes.size(); ++k)
            if (halved[k]) places.push_back((nodes[k] + nodes[k + 1]) / 2);
        std::ranges::sort(places);
        findFactors(axes[axis]);
        return any;
    }
};

LobeGrid::Stencil LobeGrid::stencilOf(const Axis& axis, double place) {
    const std::vector<double>& x = axis.places;
    Stencil stencil{.count = std::min<std::size_t>(x.size(), 4)};
    const auto above = static_cast<std::size_t>(std::ranges::upper_bound(x, place) - x.begin());
    // Two nodes on each side, fewer at the ends.
    const std::size_t wanted = above > 2 ? above - 2 : 0;
    stencil.first = std::min(wanted, x.size() - stencil.count);
    const double* factors = axis.factors.data() + 4 * stencil.first;
    for (std::size_t k = 0; k < stencil.count; ++k) {
        double weight = factors[k];
        for (std::size_t j = 0; j < stencil.count; ++j)
            weight *= j == k ? 1 : place - x[stencil.first + j];
        stencil.weight[k] = weight;
    }
    return stencil;
}

void LobeGrid::findFactors(Axis& axis) {
    const std::vector<double>& x = axis.places;
    const std::size_t count = std::min<std::size_t>(x.size(), 4);
    axis.factors.assign(4 * (x.size() - count + 1), 1.0);
    for (std::size_t first = 0; first + count <= x.size(); ++first)
        for (std::size_t k = 0; k < count; ++k)
            for (std::size_t j = 0; j < count; ++j)
                if (j != k) axis.factors[4 * first + k] /= x[first + k] - x[first + j];
}

LobeGrid::LobeGrid(const LobeFunction& function, const LobeGridOptions& options)
    : lobes_(function.lobes), length_(function.length) {
    if (function.axes.size() > 3) {
        throw UsageError(fmt::format(
            "{} parameters act on f in other ways than as factors, and at most 3 can vary from "
            "texel to texel",
            function.axes.size()));
    }
    for (const LobeAxis& axis : function.axes) {
        Axis made{.logarithmic = axis.logarithmic};
        const double low = axis.logarithmic ? std::log(axis.low) : axis.low;
        const double high = axis.logarithmic ? std::log(axis.high) : axis.high;
        made.places.push_back(low);
        if (high > low) {
            for (std::size_t k = 1; k <= firstIntervals; ++k)
                made.places.push_back(low + (high - low) * static_cast<double>(k) / firstIntervals);
        }
        findFactors(made);
        nodes_.push_back(std::move(made));
    }
    Builder builder{function, options, nodes_};
    builder.computeNodes();
    for (bool refined = true; refined;) {
        refined = false;
        builder.error = 0;
        for (std::size_t axis = 0; axis < nodes_.size(); ++axis) {
            if (nodes_[axis].places.size() > 1 && builder.refine(axis)) refined = true;
            builder.computeNodes();
        }
    }
    error_ = builder.error;
    evaluations_ = builder.known.size();
    stride_ = lobes_ * length_ + padding;
    eachIndex(builder.sizes(), [&](const auto& index) {
        const std::vector<double>& row = builder.known.at(builder.placeOf(index));
        for (const double value : row) values_.push_back(static_cast<float>(value));
        values_.resize(++rows_ * stride_, 0.0F);
    });
}

void LobeGrid::find(const float* p, Place& place) const {
    place.count = 1;
    place.row[0] = 0;
    place.weight[0] = 1;
    for (std::size_t a = 0; a < nodes_.size(); ++a) {
        const Axis& axis = nodes_[a];
        const double value = static_cast<double>(p[a]);
        const double at = std::clamp(axis.logarithmic ? std::log(value) : value,
                                     axis.places.front(), axis.places.back());
        const Stencil stencil = stencilOf(axis, at);
        const std::uint32_t before = place.count;
        const auto size = static_cast<std::uint32_t>(axis.places.size());
        // From the last to the first, so that no entry is overwritten before it is read.
        for (std::uint32_t k = before; k-- > 0;) {
            const std::uint32_t row =
                place.row[k] * size + static_cast<std::uint32_t>(stencil.first);
            const float weight = place.weight[k];
            for (std::size_t j = stencil.count; j-- > 0;) {
                const std::size_t slot = k * stencil.count + j;
                place.row[slot] = row + static_cast<std::uint32_t>(j);
                place.weight[slot] = weight * static_cast<float>(stencil.weight[j]);
            }
        }
        place.count = before * static_cast<std::uint32_t>(stencil.count);
    }
}

}  // namespace hshfit::inline material_maps
