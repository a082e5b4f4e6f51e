// Terms of rpv.h. Included by rpv.cpp once for each instruction set.

#include <brdfs/analytic/phase_angle.h>
#include <brdfs/analytic/term_columns.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

template <class T>
class RpvTerms {
    using R = RealOf<T>;
    using N = ParameterOf<T>;

public:
    static constexpr std::size_t count = 2;

    HWY_INLINE RpvTerms(const RpvShape<N>& shape, const OutgoingOf<T>& wo)
        : wo_(wo), power_(shape.k - 1.0), theta_(shape.theta) {
        const R z = max(R(wo.z), R(1e-100));
        ox_ = R(wo.x) / z, oy_ = R(wo.y) / z;
    }

    HWY_INLINE void operator()(const Incoming<R>& wi, T* term) const {
        const PhaseAngle<R> g(wo_, wi);
        const R cosine = g.halfCosine;
        const R sine = g.halfSine;
        // 1 + 2 Theta cos g + Theta^2, of squares: cos g = 2 cos(g/2)^2 - 1.
        const T plus = (1.0 + theta_) * (cosine * cosine), squares = plus * (1.0 + theta_);
        const T minus = (1.0 - theta_) * (sine * sine), others = minus * (1.0 - theta_);
        const T denominator = squares + others;
        const T phase = (1.0 - theta_) * (1.0 + theta_) / (denominator * sqrt(denominator));
        const R oz = wo_.z;
        const T bowl = bounded(exp(power_ * (log(wi.z) + log(oz) + log(wi.z + oz))));
        const R z = max(wi.z, R(1e-100));
        const R dx = wi.x / z - ox_, dy = wi.y / z - oy_;
        const R gap = sqrt(dx * dx + dy * dy);
        term[0] = bounded(bowl * phase);
        term[1] = term[0] / (1.0 + gap);
    }

private:
    OutgoingOf<T> wo_;
    T power_, theta_;
    R ox_, oy_;
};

struct RpvFormula {
    template <class T>
    using Terms = RpvTerms<T>;

    template <class N>
    static RpvShape<N> shape(const Values<N>& p) {
        return {p("k"), p("Theta")};
    }
    template <class N>
    static Weights<N> weights(const Values<N>& p) {
        const N rho = p("rho0"), spot = p.given("rhoc") ? p("rhoc") : rho;
        return {N(0.0), {rho / pi, rho * (1.0 - spot) / pi}};
    }
};

void evalRpv(const RpvShape<double>& shape, const TermBatch& batch) {
    evalLanes<RpvTerms>(shape, batch);
}
std::unique_ptr<ModelColumns> rpvColumns(const ColumnRequest& request) {
    return columnsOf<RpvFormula, 3>(request);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
