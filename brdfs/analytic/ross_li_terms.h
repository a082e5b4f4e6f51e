// Terms of ross_li.h. Included by ross_li.cpp once for each instruction set.

#include <brdfs/analytic/term_columns.h>
#include <brdfs/lanes/lanes_angles.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

/// The tangent vector of a direction, of crowns that are br times as wide, and its secant.
template <class R>
struct CrownSlope {
    R x, y, secant;

    template <class D>
    HWY_INLINE CrownSlope(const D& w, double br) {
        // Slopes are cut where their products would overflow.
        const R scale = R(br) / max(R(w.z), R(1e-60));
        x = R(w.x) * scale, y = R(w.y) * scale;
        secant = sqrt(1.0 + x * x + y * y);
    }
};

template <class T>
class RossLiTerms {
    using R = RealOf<T>;

public:
    static constexpr std::size_t count = 2;

    template <class Shape>
    HWY_INLINE RossLiTerms(const Shape& shape, const OutgoingOf<T>& wo)
        : wo_(wo), o_(wo, shape.br), hb_(shape.hb), br_(shape.br) {}

    HWY_INLINE void operator()(const Incoming<R>& wi, T* term) const {
        term[0] = T(volume(wi));
        term[1] = T(crowns(CrownSlope<R>(wi, br_)));
    }

private:
    HWY_INLINE R volume(const Incoming<R>& wi) const {
        const R ox = wo_.x, oy = wo_.y, oz = wo_.z;
        const R cosine = min(max(wi.x * ox + wi.y * oy + wi.z * oz, R(-1.0)), R(1.0));
        const R cx = wi.y * oz - wi.z * oy, cy = wi.z * ox - wi.x * oz, cz = wi.x * oy - wi.y * ox;
        const R sine = min(sqrt(cx * cx + cy * cy + cz * cz), R(1.0));
        const PolarAngle<R> angle(sine, abs(cosine));
        return bounded((angle.complement * abs(cosine) + sine) / (wi.z + oz)) - pi / 4;
    }

    HWY_INLINE R crowns(const CrownSlope<R>& i) const {
        const R dx = i.x - o_.x, dy = i.y - o_.y, across = i.x * o_.y - i.y * o_.x;
        const R secants = i.secant + o_.secant;
        const R cosine = min(hb_ * sqrt(dx * dx + dy * dy + across * across) / secants, R(1.0));
        const R sine = sqrt((1.0 - cosine) * (1.0 + cosine));
        const R t = PolarAngle<R>(sine, cosine).theta;
        const R overlap = (t - sine * cosine) * secants * (1 / pi);
        // sec_i sec_o + p_i p_o, without cancellation where the slopes p are opposite.
        const R product = i.secant * o_.secant, along = i.x * o_.x + i.y * o_.y;
        const R squares = 1.0 + i.x * i.x + i.y * i.y + o_.x * o_.x + o_.y * o_.y;
        const R lit = select(along < R(0.0), (squares + across * across) / (product - along),
                             product + along);
        return overlap - secants + 0.5 * (1.0 + lit);
    }

    OutgoingOf<T> wo_;
    CrownSlope<R> o_;
    double hb_, br_;
};

struct RossLiFormula {
    template <class T>
    using Terms = RossLiTerms<T>;

    template <class N>
    static RossLiShape shape(const Values<N>& p) {
        return {plain(p("hb")), plain(p("br"))};
    }
    template <class N>
    static Weights<N> weights(const Values<N>& p) {
        return {p("iso") / pi, {p("vol") / pi, p("geo") / pi}};
    }
};

void evalRossLi(const RossLiShape& shape, const TermBatch& batch) {
    evalLanes<RossLiTerms>(shape, batch);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
