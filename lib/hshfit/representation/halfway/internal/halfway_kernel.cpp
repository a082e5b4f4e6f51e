#include <hshfit/representation/halfway/internal/halfway_kernel.h>
#include <hshfit/vector_targets.h>

#include <algorithm>

// Compiled once for every instruction set; the best one is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hshfit/representation/halfway/internal/halfway_kernel.cpp"
#include <hwy/foreach_target.h>
// foreach_target.h comes before these.
#include <hwy/aligned_allocator.h>
#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::inline representation::inline halfway::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
template <class T>
using Lanes = hn::ScalableTag<T>;
template <class T>
using Vector = hn::Vec<Lanes<T>>;

/// Vectors of pairs that share every coefficient loaded.
constexpr std::size_t unroll = 2;
template <class T>
constexpr std::size_t block = unroll* hn::MaxLanes(Lanes<T>());

/// One block's directions.
template <class T>
struct Pairs {
    HWY_ALIGN T values[6][block<T>];

    void load(const DirectionBatch& wi, const DirectionBatch& wo, std::size_t first) {
        const double* from[] = {wi.x, wi.y, wi.z, wo.x, wo.y, wo.z};
        const std::size_t count = std::min(block<T>, wi.count - first);
        for (std::size_t c = 0; c < 6; ++c) {
            for (std::size_t k = 0; k < count; ++k) {
                values[c][k] = static_cast<T>(from[c][first + k]);
            }
            for (std::size_t k = count; k < block<T>; ++k) values[c][k] = c % 3 == 2 ? T{1} : T{0};
        }
    }
};

template <class T>
Vector<T> set(double value) {
    return hn::Set(Lanes<T>(), static_cast<T>(value));
}

/// Rows out, out + block, … at one vector of pairs.
template <class T>
void legendre(const T* steps, Vector<T> x, int count, T* out) {
    const Lanes<T> lanes;
    const Vector<T> one = set<T>(1), t = hn::Sub(hn::Add(x, x), one);
    Vector<T> before = hn::Zero(lanes), now = one;
    for (int n = 0; n < count; ++n) {
        hn::Store(now, lanes, out + block<T> * n);
        const Vector<T> next =
            hn::NegMulAdd(hn::Set(lanes, steps[2 * n + 1]), before,
                          hn::Mul(hn::Mul(hn::Set(lanes, steps[2 * n]), t), now));
        before = now;
        now = next;
    }
}

template <class T>
void harmonics(Vector<T> cosine, Vector<T> sine, Vector<T> scale, int count, T* out) {
    const Lanes<T> lanes;
    Vector<T> c = scale, s = hn::Zero(lanes);
    for (int q = 0; q < count; ++q) {
        const Vector<T> turned = hn::NegMulAdd(s, sine, hn::Mul(c, cosine));
        s = hn::MulAdd(c, sine, hn::Mul(s, cosine));
        c = turned;
        hn::Store(c, lanes, out + 2 * block<T> * q);
        hn::Store(s, lanes, out + 2 * block<T> * q + block<T>);
    }
}

template <class T>
Vector<T> cubeRoot(Vector<T> x) {
    const Lanes<T> lanes;
    return hn::Exp(lanes, hn::Mul(hn::Log(lanes, x), set<T>(1.0 / 3)));
}

/// HalfwayAxes::at, and the functions along each axis, for the vector of pairs at k.
template <class T>
void fillTable(const HalfwayLayout<T>& layout, const Pairs<T>& pairs, std::size_t k, T* table) {
    const Lanes<T> lanes;
    const auto at = [&](int c) { return hn::Load(lanes, pairs.values[c] + k); };
    const auto row = [&](std::uint16_t n) { return table + block<T> * n + k; };
    const HalfwayAxes::Constants& constants = layout.axes;
    const Vector<T> zero = hn::Zero(lanes), one = set<T>(1), half = set<T>(0.5),
                    tiny = set<T>(1e-30);
    const auto above = hn::And(hn::Gt(at(2), zero), hn::Gt(at(5), zero));
    hn::Store(hn::IfThenElseZero(above, one), lanes, row(layout.rows.above));
    const Vector<T> mi = hn::Max(at(2), tiny), mo = hn::Max(at(5), tiny), sum = hn::Add(mi, mo);

    const Vector<T> hx = hn::Add(at(0), at(3)), hy = hn::Add(at(1), at(4));
    const Vector<T> across = hn::MulAdd(hx, hx, hn::Mul(hy, hy));
    const Vector<T> square = hn::Max(hn::MulAdd(sum, sum, across), tiny);
    const Vector<T> gx = hn::MulAdd(set<T>(constants.xx), hx, hn::Mul(set<T>(constants.xy), hy));
    const Vector<T> gy = hn::MulAdd(set<T>(constants.yx), hx, hn::Mul(set<T>(constants.yy), hy));
    const Vector<T> stretched = hn::MulAdd(gx, gx, hn::Mul(gy, gy));
    const Vector<T> q = hn::Div(stretched, square);
    const Vector<T> x = hn::Mul(hn::Log1p(lanes, q), set<T>(constants.perLog));
    const Vector<T> ei = cubeRoot<T>(mi), eo = cubeRoot<T>(mo);

    const T* steps = layout.steps.data();
    legendre(steps, hn::Mul(half, hn::Add(ei, eo)), layout.counts.mean, row(0));
    legendre(steps, x, layout.counts.x, row(layout.rows.x));
    legendre(steps, hn::Min(one, hn::Mul(half, hn::Sqrt(square))), layout.counts.v,
             row(layout.rows.v));
    legendre(steps, hn::Mul(ei, eo), layout.counts.product, row(layout.rows.product));
    hn::Store(hn::Sub(eo, ei), lanes, row(layout.rows.gap));
    hn::Store(hn::NegMulAdd(at(1), at(3), hn::Mul(at(0), at(4))), lanes, row(layout.rows.handed));

    const Vector<T> sine = hn::Sqrt(hn::Div(across, square));
    const Vector<T> kappa = hn::Div(hn::Sub(mo, mi), hn::MulAdd(set<T>(2), sine, set<T>(1e-9)));
    Vector<T> power = x;
    for (int n = 0; n < layout.powers; ++n) {
        power = hn::Mul(power, kappa);
        hn::Store(power, lanes, row(layout.rows.powers) + block<T> * n);
    }
    if (layout.harmonics > 0) {
        const Vector<T> radius = hn::Sqrt(stretched);
        const auto pole = hn::Le(radius, tiny);
        const Vector<T> inverse = hn::Div(one, hn::Max(radius, tiny));
        harmonics(hn::IfThenElse(pole, one, hn::Mul(gx, inverse)),
                  hn::IfThenZeroElse(pole, hn::Mul(gy, inverse)), x, layout.harmonics,
                  row(layout.rows.harmonics));
    }
    const Vector<T> tail = hn::Add(one, q), shelf = set<T>(constants.shelf);
    Vector<T> denominator = hn::MulAdd(mi, mo, hn::MulAdd(half, sum, shelf));
    if (constants.masked) {
        const auto masking = [&](Vector<T> wx, Vector<T> wy, Vector<T> m) {
            const Vector<T> slope =
                hn::MulAdd(set<T>(constants.lxx), wx, hn::Mul(set<T>(constants.lxy), wy));
            const Vector<T> rest = hn::Mul(set<T>(constants.lyy), hn::Mul(wy, wy));
            return hn::Sqrt(hn::MulAdd(m, m, hn::MulAdd(slope, wx, rest)));
        };
        denominator = hn::MulAdd(mo, masking(at(0), at(1), mi),
                                 hn::MulAdd(mi, masking(at(3), at(4), mo), shelf));
    }
    hn::Store(hn::Div(set<T>(constants.amplitude), hn::Mul(hn::Mul(tail, tail), denominator)),
              lanes, row(layout.rows.weight));
}

/// The sums of runs first .. last - 1 of a group of channels at the vectors from k on.
template <std::size_t Channels, class T>
void addRuns(const HalfwayLayout<T>& layout, std::size_t first, std::size_t last, const T* table,
             std::size_t k, const T* values, Vector<T> (&total)[Channels][unroll]) {
    const Lanes<T> lanes;
    const std::size_t step = hn::Lanes(lanes);
    const auto load = [&](std::size_t row, std::size_t n) {
        return hn::Load(lanes, table + block<T> * row + k + n * step);
    };
    for (std::size_t r = first; r < last; ++r) {
        const typename HalfwayLayout<T>::Run& run = layout.runs[r];
        Vector<T> part[Channels][unroll];
        for (auto& row : part) {
            for (auto& p : row) p = hn::Zero(lanes);
        }
        const T* value = values + Channels * run.value;
        for (std::size_t i = 0; i < run.length; ++i, ++value) {
            Vector<T> along[unroll];
            for (std::size_t n = 0; n < unroll; ++n) along[n] = load(run.first + i, n);
            for (std::size_t c = 0; c < Channels; ++c) {
                const Vector<T> coefficient = hn::Set(lanes, value[c * run.stored]);
                for (std::size_t n = 0; n < unroll; ++n) {
                    part[c][n] = hn::MulAdd(coefficient, along[n], part[c][n]);
                }
            }
        }
        for (std::size_t n = 0; n < unroll; ++n) {
            Vector<T> factor = load(run.factors[0], n);
            for (std::size_t m = 1; m < run.factorCount; ++m)
                factor = hn::Mul(factor, load(run.factors[m], n));
            for (std::size_t c = 0; c < Channels; ++c) {
                total[c][n] = hn::MulAdd(part[c][n], factor, total[c][n]);
            }
        }
    }
}

template <std::size_t Channels, class T>
void sumChannels(const HalfwayLayout<T>& layout, const T* table, std::size_t firstChannel,
                 const T* values, T (*out)[block<T>]) {
    const Lanes<T> lanes;
    const std::size_t step = hn::Lanes(lanes);
    for (std::size_t k = 0; k < block<T>; k += unroll * step) {
        Vector<T> total[2][Channels][unroll];
        for (auto& part : total) {
            for (auto& row : part) {
                for (auto& t : row) t = hn::Zero(lanes);
            }
        }
        addRuns<Channels, T>(layout, 0, layout.smoothRuns, table, k, values, total[0]);
        addRuns<Channels, T>(layout, layout.smoothRuns, layout.runs.size(), table, k, values,
                             total[1]);
        for (std::size_t c = 0; c < Channels; ++c) {
            const T* ceilings = layout.ceilings.data() + 3 * (firstChannel + c);
            for (std::size_t n = 0; n < unroll; ++n) {
                const std::size_t place = k + n * step;
                const auto load = [&](std::uint16_t row) {
                    return hn::Load(lanes, table + block<T> * row + place);
                };
                const auto part = [&](std::size_t which) {
                    return hn::Exp(lanes,
                                   hn::Min(total[which][c][n], hn::Set(lanes, ceilings[which])));
                };
                const Vector<T> f = hn::Min(hn::MulAdd(load(layout.rows.weight), part(1), part(0)),
                                            hn::Set(lanes, ceilings[2]));
                const auto above = hn::Gt(load(layout.rows.above), hn::Zero(lanes));
                hn::Store(hn::IfThenElseZero(above, f), lanes, out[c] + place);
            }
        }
    }
}

template <class T>
void evaluateHalfway(const HalfwayLayout<T>& layout, const DirectionBatch& wi,
                     const DirectionBatch& wo, std::size_t stride, T* out) {
    const auto table = hwy::AllocateAligned<T>(block<T> * layout.rows.count);
    Pairs<T> pairs;
    HWY_ALIGN T sums[3][block<T>];
    for (std::size_t first = 0; first < wi.count; first += block<T>) {
        pairs.load(wi, wo, first);
        for (std::size_t k = 0; k < block<T>; k += hn::Lanes(Lanes<T>()))
            fillTable(layout, pairs, k, table.get());
        const std::size_t count = std::min(block<T>, wi.count - first);
        for (std::size_t c = 0; c < layout.channels; c += 3) {
            const T* values = layout.values.data() + c * layout.stored;
            const std::size_t group = std::min<std::size_t>(3, layout.channels - c);
            if (group == 3) {
                sumChannels<3, T>(layout, table.get(), c, values, sums);
            } else if (group == 2) {
                sumChannels<2, T>(layout, table.get(), c, values, sums);
            } else {
                sumChannels<1, T>(layout, table.get(), c, values, sums);
            }
            for (std::size_t n = 0; n < group; ++n) {
                std::copy_n(sums[n], count, out + (c + n) * stride + first);
            }
        }
    }
}

}  // namespace

void HalfwayInSingle(const HalfwayLayout<float>& layout, const DirectionBatch& wi,
                     const DirectionBatch& wo, std::size_t stride, float* out) {
    evaluateHalfway(layout, wi, wo, stride, out);
}
void HalfwayInDouble(const HalfwayLayout<double>& layout, const DirectionBatch& wi,
                     const DirectionBatch& wo, std::size_t stride, double* out) {
    evaluateHalfway(layout, wi, wo, stride, out);
}

}  // namespace hshfit::inline representation::inline halfway::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hshfit::inline representation::inline halfway {

HWY_EXPORT(HalfwayInSingle);
HWY_EXPORT(HalfwayInDouble);

namespace {

/// One pair fills a vector with its own functions and channels instead of other pairs.
template <class T>
bool evaluatedAlone(const HalfwayLayout<T>& layout, const DirectionBatch& wi,
                    const DirectionBatch& wo, std::size_t stride, T* out) {
    if (wi.count != 1 || layout.oneRows > HalfwayLayout<T>::mostOneRows) return false;
    if (*wi.z > 0 && *wo.z > 0) {
        evaluateHalfwayPair(layout, {*wi.x, *wi.y, *wi.z}, {*wo.x, *wo.y, *wo.z}, stride, out);
    } else {
        for (std::size_t c = 0; c < layout.channels; ++c) out[c * stride] = 0;
    }
    return true;
}

}  // namespace

void evaluateHalfwayPairs(const HalfwayLayout<float>& layout, const DirectionBatch& wi,
                          const DirectionBatch& wo, std::size_t stride, float* out) {
    if (evaluatedAlone(layout, wi, wo, stride, out)) return;
    HWY_DYNAMIC_DISPATCH(HalfwayInSingle)(layout, wi, wo, stride, out);
}

void evaluateHalfwayPairs(const HalfwayLayout<double>& layout, const DirectionBatch& wi,
                          const DirectionBatch& wo, std::size_t stride, double* out) {
    if (evaluatedAlone(layout, wi, wo, stride, out)) return;
    HWY_DYNAMIC_DISPATCH(HalfwayInDouble)(layout, wi, wo, stride, out);
}

}  // namespace hshfit::inline representation::inline halfway
#endif
