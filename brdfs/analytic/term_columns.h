// The columns of a fit (model_columns.h) from the formula of a model, several pairs of
// directions at a time. Compiled once for each instruction set.
//
// `Formula` is the formula of evaluation too: `Formula::Terms<T>`, the terms;
// `Formula::shape(Values<N>)`, their parameters; `Formula::weights(Values<N>)`, their weights,
// which contain the linear parameters.

#if defined(BRDFS_ANALYTIC_TERM_COLUMNS_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BRDFS_ANALYTIC_TERM_COLUMNS_H
#undef BRDFS_ANALYTIC_TERM_COLUMNS_H
#else
#define BRDFS_ANALYTIC_TERM_COLUMNS_H
#endif

#include <brdfs/analytic/model_columns.h>
#include <brdfs/analytic/term_values.h>

#include <algorithm>
#include <memory>
#include <vector>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

/// One vector of directions from k on; lanes past the end repeat the last.
HWY_INLINE Incoming<Lanes> incomingAt(const PairBatch& pairs, std::size_t k) {
    Incoming<Lanes> wi;
    if (k + lanesIn<Lanes>() <= pairs.wi.count) {
        load(pairs.wi.x + k, wi.x), load(pairs.wi.y + k, wi.y), load(pairs.wi.z + k, wi.z);
        return wi;
    }
    double all[3][HWY_MAX_BYTES / sizeof(double)];
    for (std::size_t i = 0; i < lanesIn<Lanes>(); ++i) {
        const std::size_t at = std::min(k + i, pairs.wi.count - 1);
        all[0][i] = pairs.wi.x[at], all[1][i] = pairs.wi.y[at], all[2][i] = pairs.wi.z[at];
    }
    load(all[0], wi.x), load(all[1], wi.y), load(all[2], wi.z);
    return wi;
}
HWY_INLINE Incoming<Lanes> outgoingAt(const PairBatch& pairs, std::size_t k) {
    double all[3][HWY_MAX_BYTES / sizeof(double)];
    for (std::size_t i = 0; i < lanesIn<Lanes>(); ++i) {
        const Direction& wo = pairs.wo[std::min(k + i, pairs.wi.count - 1)];
        all[0][i] = wo.x, all[1][i] = wo.y, all[2][i] = wo.z;
    }
    Incoming<Lanes> wo;
    load(all[0], wo.x), load(all[1], wo.y), load(all[2], wo.z);
    return wo;
}

/// Columns with their derivatives by `n` shapes at a time.
template <class Formula, int n>
class ColumnsOf final : public ModelColumns {
public:
    explicit ColumnsOf(const ColumnRequest& request)
        : shapes_(request.shapes.size()), linears_(request.linears.size()) {
        for (std::size_t first = 0; first == 0 || first < shapes_; first += std::max(n, 1))
            passes_.emplace_back(request, first);
    }

    HWY_ATTR void fill(const PairBatch& pairs, double* base, double* linear,
                       double* slopes) const override {
        for (std::size_t p = 0; p < passes_.size(); ++p) fillPass(p, pairs, base, linear, slopes);
    }

private:
    using N = Slopes<double, n>;
    using T = Slopes<Lanes, n>;

    struct Pass {
        decltype(Formula::shape(std::declval<Values<N>>())) shape;
        std::vector<Weights<N>> weights;  ///< of each column

        Pass(const ColumnRequest& request, std::size_t first)
            : shape(Formula::shape(Values<N>(request, {}, first))) {
            const Weights<N> least = Formula::weights(Values<N>(request, {}, first));
            weights.push_back(least);
            for (const std::string& key : request.linears) {
                Weights<N> unit = Formula::weights(Values<N>(request, key, first));
                unit.constant = unit.constant - least.constant;
                for (std::size_t t = 0; t < unit.count; ++t)
                    unit.term[t] = unit.term[t] - least.term[t];
                weights.push_back(unit);
            }
        }
        HWY_INLINE T weighted(std::size_t column, const T* term) const {
            const Weights<N>& w = weights[column];
            T sum(w.constant);
            for (std::size_t t = 0; t < w.count; ++t)
                if (!isZero(w.term[t])) sum = sum + T(w.term[t]) * bounded(term[t]);
            return sum;
        }
    };

    HWY_ATTR void fillPass(std::size_t p, const PairBatch& pairs, double* base, double* linear,
                           double* slopes) const {
        const Pass& pass = passes_[p];
        const std::size_t count = pairs.wi.count, columns = 1 + linears_;
        const std::size_t first = p * std::max(n, 1);
        for (std::size_t k = 0; k < count;) {
            const typename Formula::template Terms<T> terms(pass.shape, outgoingAt(pairs, k));
            for (const std::size_t end = endOfOutgoing(pairs, k); k < end; k += lanesIn<Lanes>()) {
                const std::size_t size = std::min(lanesIn<Lanes>(), count - k);
                T term[TermBatch::maxTerms];
                terms(incomingAt(pairs, k), term);
                for (std::size_t c = 0; c < columns; ++c) {
                    const T sum = pass.weighted(c, term);
                    if (p == 0)
                        put(sum.value, size, c == 0,
                            c == 0 ? base + k : linear + (c - 1) * count + k);
                    for (std::size_t i = 0; i < std::size_t(n) && first + i < shapes_; ++i)
                        put(sum.by[i], size, false,
                            slopes + ((first + i) * columns + c) * count + k);
                }
            }
        }
    }

    /// The end of the vectors from k on that have one outgoing direction in all lanes, and so share
    /// what depends on it alone; at least the end of the first vector.
    static std::size_t endOfOutgoing(const PairBatch& pairs, std::size_t k) {
        const Direction& wo = pairs.wo[k];
        std::size_t same = k + 1;
        while (same < pairs.wi.count && pairs.wo[same].x == wo.x && pairs.wo[same].y == wo.y &&
               pairs.wo[same].z == wo.z)
            ++same;
        const std::size_t lanes = lanesIn<Lanes>();
        if (same == pairs.wi.count) return same;
        return k + std::max(lanes, (same - k) / lanes * lanes);
    }

    static HWY_INLINE void put(Lanes value, std::size_t size, bool added, double* to) {
        if (size == lanesIn<Lanes>()) {
            Lanes before(0.0);
            if (added) load(to, before);
            store(added ? before + value : value, to);
            return;
        }
        double buffer[HWY_MAX_BYTES / sizeof(double)];
        store(value, buffer);
        for (std::size_t i = 0; i < size; ++i) to[i] = added ? to[i] + buffer[i] : buffer[i];
    }

    std::size_t shapes_, linears_;
    std::vector<Pass> passes_;
};

/// By `n` shapes at a time, or as few as `least` where that leaves fewer of them idle.
template <class Formula, int n, int least = n>
std::unique_ptr<ModelColumns> columnsOf(const ColumnRequest& request) {
    const std::size_t shapes = request.shapes.size(), passes = (shapes + n - 1) / n;
    if (shapes == 0) return std::make_unique<ColumnsOf<Formula, 0>>(request);
    if constexpr (n > least) {
        if (passes * (n - 1) >= shapes) return columnsOf<Formula, n - 1, least>(request);
    }
    return std::make_unique<ColumnsOf<Formula, n>>(request);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
