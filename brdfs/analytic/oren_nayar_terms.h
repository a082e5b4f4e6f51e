// Terms of oren_nayar.h. Included by oren_nayar.cpp once for each instruction set.

#include <brdfs/analytic/term_batch.h>
#include <brdfs/lanes/lanes_angles.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

template <class T>
class SimplifiedTerms {
public:
    static constexpr std::size_t count = 1;

    HWY_INLINE SimplifiedTerms(const OrenNayarShape&, const Direction& wo) : wo_(wo) {}

    HWY_INLINE void operator()(const Incoming<T>& wi, T* term) const {
        term[0] = max(T(0.0), wi.x * wo_.x + wi.y * wo_.y) / max(wi.z, T(wo_.z));
    }

private:
    Direction wo_;
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
public:
    static constexpr std::size_t count = 2;

    HWY_INLINE FullTerms(const OrenNayarShape& shape, const Direction& wo)
        : r_(shape), o_(Incoming<T>{T(wo.x), T(wo.y), T(wo.z)}) {}

    HWY_INLINE void operator()(const Incoming<T>& wi, T* term) const {
        const Polar<T> i(wi);
        const T cosine =
            min(max(i.azimuthX * o_.azimuthX + i.azimuthY * o_.azimuthY, T(-1.0)), T(1.0));
        // 1 - |cos D| from the distance between the unit vectors of azimuth, or to the opposite
        // one.
        const T side = select(cosine >= T(0.0), T(1.0), T(-1.0));
        const T dx = i.azimuthX - side * o_.azimuthX, dy = i.azimuthY - side * o_.azimuthY;
        const T aside = 0.5 * (dx * dx + dy * dy);
        const auto lower = o_.cosine < i.cosine;
        const auto ofAlpha = [&](T o, T own) HWY_ATTR { return select(lower, o, own); };
        const auto ofBeta = [&](T o, T own) HWY_ATTR { return select(lower, own, o); };
        const T alphaSine = ofAlpha(o_.sine, i.sine), alphaCosine = ofAlpha(o_.cosine, i.cosine);
        const T betaSine = ofBeta(o_.sine, i.sine), betaCosine = ofBeta(o_.cosine, i.cosine);
        const T betaTheta = ofBeta(o_.theta, i.theta);
        const T bend = 4 / (pi * pi) * ofAlpha(o_.theta, i.theta) * betaTheta;
        const T tilt = 2 / pi * betaTheta;

        // (sin alpha - [cos D < 0] (2 beta/pi)^3) tan beta. The difference is that of the
        // distances of both from 1, because tan beta amplifies its rounding error at the horizon.
        const T e = 2 / pi * ofBeta(o_.complement, i.complement);
        const T cubeBelowOne = e * (3.0 - 3.0 * e + e * e);
        const T sineBelowOne = alphaCosine / (1.0 + alphaSine) * alphaCosine;
        const T rise = select(cosine >= T(0.0), alphaSine, cubeBelowOne - sineBelowOne) * betaSine;
        // tan((alpha + beta)/2) from the tangents of half the angles to the horizon.
        const T a = alphaCosine / (1.0 + alphaSine), b = betaCosine / (1.0 + betaSine);
        const T halfwaySlope = bounded((1.0 - a * b) / (a + b));
        term[0] = r_.direct + r_.sameSide * cosine * bounded(rise / betaCosine) +
                  r_.across * (bend * bend) * aside * halfwaySlope;
        term[1] = r_.interreflected * (1.0 - cosine * (tilt * tilt));
    }

private:
    OrenNayarShape r_;
    Polar<T> o_;
};

void evalSimplified(const OrenNayarShape& shape, const TermBatch& batch) {
    evalLanes<SimplifiedTerms>(shape, batch);
}

void evalFull(const OrenNayarShape& shape, const TermBatch& batch) {
    evalLanes<FullTerms>(shape, batch);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
