// Terms of oren_nayar.h. Included by oren_nayar.cpp once for each instruction set.

#include <brdfs/analytic/term_columns.h>
#include <brdfs/lanes/lanes_angles.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

template <class T>
class SimplifiedTerms {
public:
    static constexpr std::size_t count = 1;

    HWY_INLINE SimplifiedTerms(const OrenNayarShape<ParameterOf<T>>&, const OutgoingOf<T>& wo)
        : wo_(wo) {}

    HWY_INLINE void operator()(const Incoming<RealOf<T>>& wi, T* term) const {
        using R = RealOf<T>;
        term[0] = T(max(R(0.0), wi.x * wo_.x + wi.y * wo_.y) / max(wi.z, R(wo_.z)));
    }

private:
    OutgoingOf<T> wo_;
};

/// Polar angle, its complement and the azimuth as a unit vector.
template <class T>
struct Polar {
    T sine, cosine, theta, complement, azimuthX, azimuthY;

    HWY_INLINE explicit Polar(const Incoming<T>& w) : cosine(w.z) {
        sine = sqrt(w.x * w.x + w.y * w.y);
        const PolarAngle<T> angle(sine, cosine);
        theta = angle.theta, complement = angle.complement;
        const auto pole = sine > T(0.0);
        azimuthX = select(pole, w.x / sine, T(1.0));
        azimuthY = select(pole, w.y / sine, T(0.0));
    }
};

template <class T>
class FullTerms {
    using R = RealOf<T>;

public:
    static constexpr std::size_t count = 2;

    HWY_INLINE FullTerms(const OrenNayarShape<ParameterOf<T>>& shape, const OutgoingOf<T>& wo)
        : r_(shape), o_(Incoming<R>{R(wo.x), R(wo.y), R(wo.z)}) {}

    HWY_INLINE void operator()(const Incoming<R>& wi, T* term) const {
        const Polar<R> i(wi);
        const R cosine =
            min(max(i.azimuthX * o_.azimuthX + i.azimuthY * o_.azimuthY, R(-1.0)), R(1.0));
        // 1 - |cos D| from the distance between the unit vectors of azimuth, or to the opposite
        // one.
        const R side = select(cosine >= R(0.0), R(1.0), R(-1.0));
        const R dx = i.azimuthX - side * o_.azimuthX, dy = i.azimuthY - side * o_.azimuthY;
        const R aside = 0.5 * (dx * dx + dy * dy);
        const auto lower = o_.cosine < i.cosine;
        const auto ofAlpha = [&](R o, R own) HWY_ATTR { return select(lower, o, own); };
        const auto ofBeta = [&](R o, R own) HWY_ATTR { return select(lower, own, o); };
        const R alphaSine = ofAlpha(o_.sine, i.sine), alphaCosine = ofAlpha(o_.cosine, i.cosine);
        const R betaSine = ofBeta(o_.sine, i.sine), betaCosine = ofBeta(o_.cosine, i.cosine);
        const R betaTheta = ofBeta(o_.theta, i.theta);
        const R bend = 4 / (pi * pi) * ofAlpha(o_.theta, i.theta) * betaTheta;
        const R tilt = 2 / pi * betaTheta;

        // (sin alpha - [cos D < 0] (2 beta/pi)^3) tan beta. The distances of both terms from 1
        // are subtracted, because tan beta amplifies rounding errors at the horizon.
        const R e = 2 / pi * ofBeta(o_.complement, i.complement);
        const R cubeBelowOne = e * (3.0 - 3.0 * e + e * e);
        const R sineBelowOne = alphaCosine / (1.0 + alphaSine) * alphaCosine;
        const R rise = select(cosine >= R(0.0), alphaSine, cubeBelowOne - sineBelowOne) * betaSine;
        // tan((alpha + beta)/2) from the tangents of half the angles to the horizon.
        const R a = alphaCosine / (1.0 + alphaSine), b = betaCosine / (1.0 + betaSine);
        const R halfwaySlope = bounded((1.0 - a * b) / (a + b));
        term[0] = T(r_.direct) + T(r_.sameSide) * cosine * bounded(rise / betaCosine) +
                  T(r_.across) * (bend * bend) * aside * halfwaySlope;
        term[1] = T(r_.interreflected) * (1.0 - cosine * (tilt * tilt));
    }

private:
    OrenNayarShape<ParameterOf<T>> r_;
    Polar<R> o_;
};

template <class N>
OrenNayarShape<N> orenNayarShape(const Values<N>& p) {
    const N sigma = p("sigma") * (pi / 180), s = sigma * sigma;
    return {1 - 0.5 * s / (s + 0.33), 0.45 * s / (s + 0.09), 0.125 * s / (s + 0.09),
            0.17 * s / (s + 0.13)};
}

struct SimplifiedFormula {
    template <class T>
    using Terms = SimplifiedTerms<T>;

    template <class N>
    static OrenNayarShape<N> shape(const Values<N>& p) {
        return orenNayarShape(p);
    }
    template <class N>
    static Weights<N> weights(const Values<N>& p) {
        const OrenNayarShape<N> own = shape(p);
        const N kd = p("kd") / pi;
        return {kd * own.direct, {kd * own.sameSide}};
    }
};

struct FullFormula {
    template <class T>
    using Terms = FullTerms<T>;

    template <class N>
    static OrenNayarShape<N> shape(const Values<N>& p) {
        return orenNayarShape(p);
    }
    template <class N>
    static Weights<N> weights(const Values<N>& p) {
        const N kd = p("kd");
        return {N(0.0), {kd / pi, kd * kd / pi}};
    }
};

void evalSimplified(const OrenNayarShape<double>& shape, const TermBatch& batch) {
    evalLanes<SimplifiedTerms>(shape, batch);
}

void evalFull(const OrenNayarShape<double>& shape, const TermBatch& batch) {
    evalLanes<FullTerms>(shape, batch);
}
std::unique_ptr<ModelColumns> orenNayarColumns(const ColumnRequest& request) {
    if (request.values.choice("variant") == "full") return columnsOf<FullFormula, 2>(request);
    return columnsOf<SimplifiedFormula, 1>(request);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
